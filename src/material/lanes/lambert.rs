//! Ideal diffuse reflection in lanes.

use std::f32::consts::FRAC_1_PI;

use super::super::form::BsdfForm;
use super::bsdf::{BSDF_ROWS, BsdfLanes, BsdfSamples, is_above, or_zero};
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Vec3f};

/// [`crate::material::Lambert`] in lanes.
#[derive(Clone, Copy)]
pub struct LambertLanes<L: Lanes> {
    reflectance: Vec3f<L>,
}

impl<L: Lanes> BsdfLanes<L> for LambertLanes<L> {
    const ROWS: usize = 1;
    const TRANSMITS: bool = false;
    const IS_DELTA: bool = false;

    #[inline(always)]
    fn new(_: L, columns: [[L::Float; 4]; BSDF_ROWS], _: BsdfForm, _: Vec3f<L>) -> Self {
        Self { reflectance: Vec3f::of_columns(columns[0]) }
    }

    #[inline(always)]
    fn eval(&self, lanes: L, wo: Vec3f<L>, wi: Vec3f<L>) -> (Vec3f<L>, L::Float) {
        let cos = wi.z.flip(wo.z.to_bits());
        let pdf = cos * FRAC_1_PI;
        let above = is_above(lanes, wo.z.abs()) & is_above(lanes, cos);
        or_zero(lanes, above, (self.reflectance.scale(pdf), pdf))
    }

    #[inline(always)]
    fn sample(&self, lanes: L, wo: Vec3f<L>, _: L::Float, u: [L::Float; 2]) -> BsdfSamples<L> {
        let Vec3f { x, y, z } = warp::cosine_hemisphere_in_lanes(lanes, u);
        BsdfSamples {
            wi: Vec3f { x, y, z: z.flip(wo.z.to_bits()) },
            weight: self.reflectance,
            pdf: z * FRAC_1_PI,
            eta: lanes.float(1.0),
            valid: is_above(lanes, wo.z.abs()),
        }
    }

    #[inline(always)]
    fn albedo(&self, _: L) -> Vec3f<L> {
        self.reflectance
    }

    #[inline(always)]
    fn is_mirror_like(&self, lanes: L) -> L::Mask {
        lanes.mask(0)
    }
}
