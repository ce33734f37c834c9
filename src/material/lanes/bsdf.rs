//! What a BSDF in lanes can do.

use super::super::form::BsdfForm;
use crate::simd::lanes::{Float, Lanes, Mask, Rows, Vec3f};

/// The most rows of four numbers that describe a BSDF to [`BsdfLanes::load`].
pub const BSDF_ROWS: usize = 4;

/// What describes a BSDF to [`BsdfLanes::load`].
pub type BsdfRows = [[f32; 4]; BSDF_ROWS];

/// A BSDF in each lane, all of one kind.
pub trait BsdfLanes<L: Lanes>: Copy {
    /// How many of the rows count.
    const ROWS: usize;

    /// From the rows of each lane's BSDF, for a viewer in the local direction `wo`.
    fn load(lanes: L, rows: &[Rows; BSDF_ROWS], form: BsdfForm, wo: Vec3f<L>) -> Self;

    /// See [`crate::material::Bsdf::eval`].
    fn eval(&self, lanes: L, wo: Vec3f<L>, wi: Vec3f<L>) -> (Vec3f<L>, L::Float);

    /// See [`crate::material::Bsdf::sample`].
    fn sample(&self, lanes: L, wo: Vec3f<L>, u_lobe: L::Float, u: [L::Float; 2]) -> BsdfSamples<L>;

    /// See [`crate::material::Bsdf::albedo`].
    fn albedo(&self, lanes: L) -> Vec3f<L>;
}

/// A sampled direction a lane, none of a delta lobe; see [`crate::material::BsdfSample`].
#[derive(Clone, Copy)]
pub struct BsdfSamples<L: Lanes> {
    /// Towards the light; unit, local.
    pub wi: Vec3f<L>,
    /// `f * |cos wi| / pdf`.
    pub weight: Vec3f<L>,
    /// Density per solid angle.
    pub pdf: L::Float,
    /// Where there is a sample.
    pub valid: L::Mask,
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
