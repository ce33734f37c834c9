//! What a BSDF in lanes can do.

use super::super::form::BsdfForm;
use super::super::sample::BsdfSample;
use crate::simd::lanes::{Float, Lanes, Mask, Rows, Scalar, Vec3f};

/// The most rows of four numbers that describe a BSDF to [`BsdfLanes::new`].
pub const BSDF_ROWS: usize = 4;

/// What describes a BSDF to [`BsdfLanes::new`].
pub type BsdfRows = [[f32; 4]; BSDF_ROWS];

/// A BSDF in each lane, all of one kind.
pub trait BsdfLanes<L: Lanes>: Copy {
    /// How many of the rows count.
    const ROWS: usize;
    /// Whether light may pass from one side to the other.
    const TRANSMITS: bool;
    /// Whether all lobes are delta lobes, so that sampling lights is in vain.
    const IS_DELTA: bool;

    /// From what describes each lane's BSDF, for a viewer in the local direction `wo`.
    fn new(lanes: L, columns: [[L::Float; 4]; BSDF_ROWS], form: BsdfForm, wo: Vec3f<L>) -> Self;

    /// The same from the rows of each lane.
    #[inline(always)]
    fn load(lanes: L, rows: &[Rows; BSDF_ROWS], form: BsdfForm, wo: Vec3f<L>) -> Self {
        let mut columns = [[lanes.float(0.0); 4]; BSDF_ROWS];
        for row in 0..Self::ROWS {
            columns[row] = lanes.columns(&rows[row]);
        }
        Self::new(lanes, columns, form, wo)
    }

    /// See [`crate::material::Bsdf::eval`].
    fn eval(&self, lanes: L, wo: Vec3f<L>, wi: Vec3f<L>) -> (Vec3f<L>, L::Float);

    /// See [`crate::material::Bsdf::sample`].
    fn sample(&self, lanes: L, wo: Vec3f<L>, u_lobe: L::Float, u: [L::Float; 2]) -> BsdfSamples<L>;

    /// See [`crate::material::Bsdf::albedo`].
    fn albedo(&self, lanes: L) -> Vec3f<L>;

    /// See [`crate::material::Bsdf::is_mirror_like`].
    fn is_mirror_like(&self, lanes: L) -> L::Mask;
}

/// A sampled direction a lane, of a delta lobe where [`BsdfLanes::IS_DELTA`]; see
/// [`crate::material::BsdfSample`].
#[derive(Clone, Copy)]
pub struct BsdfSamples<L: Lanes> {
    /// Towards the light; unit, local.
    pub wi: Vec3f<L>,
    /// `f * |cos wi| / pdf`.
    pub weight: Vec3f<L>,
    /// Density per solid angle.
    pub pdf: L::Float,
    /// Index of refraction on the side of `wi` over that on the side of `wo`.
    pub eta: L::Float,
    /// Where there is a sample.
    pub valid: L::Mask,
}

impl BsdfSamples<Scalar> {
    /// The sample of the only lane, of a delta lobe or not.
    #[inline(always)]
    pub fn first(self, delta: bool) -> Option<BsdfSample> {
        let Self { wi, weight, pdf, eta, valid } = self;
        let sample = BsdfSample { wi: wi.into(), weight: weight.into(), pdf, delta, eta };
        valid.then_some(sample)
    }
}

/// See [`super::super::sample::is_above`].
#[inline(always)]
pub(super) fn is_above<L: Lanes>(lanes: L, cos: L::Float) -> L::Mask {
    cos.gt(lanes.float(1e-7))
}

/// A value and its density where the mask is true, else zero.
#[inline(always)]
pub(super) fn or_zero<L: Lanes>(
    lanes: L,
    mask: L::Mask,
    (value, pdf): (Vec3f<L>, L::Float),
) -> (Vec3f<L>, L::Float) {
    let zero = lanes.float(0.0);
    (Vec3f::select(mask, value, Vec3f::splat(zero)), mask.select(pdf, zero))
}
