//! Clear glass in lanes: smooth boundaries of solids, and smooth sheets.

use super::super::form::BsdfForm;
use super::super::fresnel;
use super::boundary::{SmoothBoundary, reflection_probability};
use super::bsdf::{BSDF_ROWS, BsdfLanes, BsdfSamples};
use crate::simd::lanes::{Float, Lanes, Mask, Vec3f};

/// The smooth kinds of [`crate::material::Dielectric`] in lanes, where reflectances are those of
/// the index of refraction.
#[derive(Clone, Copy)]
pub struct SmoothGlassLanes<L: Lanes> {
    tint: Vec3f<L>,
    /// Inside over outside.
    ior: L::Float,
    /// Where it is a sheet.
    thin: L::Mask,
}

impl<L: Lanes> BsdfLanes<L> for SmoothGlassLanes<L> {
    const ROWS: usize = 2;
    const TRANSMITS: bool = true;
    const IS_DELTA: bool = true;

    #[inline(always)]
    fn new(lanes: L, columns: [[L::Float; 4]; BSDF_ROWS], _: BsdfForm, _: Vec3f<L>) -> Self {
        let [[r, g, b, ior], [thin, ..], ..] = columns;
        Self { tint: Vec3f::new(r, g, b), ior, thin: thin.gt(lanes.float(0.0)) }
    }

    #[inline(always)]
    fn eval(&self, lanes: L, _: Vec3f<L>, _: Vec3f<L>) -> (Vec3f<L>, L::Float) {
        (Vec3f::splat(lanes.float(0.0)), lanes.float(0.0))
    }

    #[inline(always)]
    fn sample(&self, lanes: L, wo: Vec3f<L>, u_lobe: L::Float, _: [L::Float; 2]) -> BsdfSamples<L> {
        let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
        let leaves = wo.z.lt(zero) & !self.thin;
        let eta = leaves.select(one / self.ior, self.ior);
        let (face, cos_t) = fresnel::dielectric_in_lanes(lanes, wo.z.abs(), eta);
        let reflectance = self.thin.select(fresnel::thin_sheet_in_lanes::<L>(face), face);
        let boundary = SmoothBoundary {
            tint: self.tint,
            reflectance: Vec3f::splat(reflectance),
            reflection_probability: reflection_probability(lanes, reflectance, self.tint),
            eta: self.thin.select(one, eta),
            cos_t,
            thin: self.thin,
        };
        boundary.sample(lanes, wo, u_lobe)
    }

    #[inline(always)]
    fn albedo(&self, _: L) -> Vec3f<L> {
        self.tint
    }

    #[inline(always)]
    fn is_mirror_like(&self, lanes: L) -> L::Mask {
        lanes.first(L::WIDTH)
    }
}
