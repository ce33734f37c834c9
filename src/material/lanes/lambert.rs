//! Ideal diffuse reflection in lanes.

use std::f32::consts::FRAC_1_PI;

use super::super::form::BsdfForm;
use super::super::lambert::Lambert;
use super::bsdf::{BSDF_ROWS, BsdfLanes, BsdfRows, BsdfSamples, is_above, or_zero};
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Rows, Vec3f};

/// [`Lambert`] in lanes.
#[derive(Clone, Copy)]
pub struct LambertLanes<L: Lanes> {
    reflectance: Vec3f<L>,
}

impl Lambert {
    /// For [`LambertLanes`].
    pub(crate) fn rows(&self) -> BsdfRows {
        let mut rows = BsdfRows::default();
        rows[0][..3].copy_from_slice(&self.reflectance.to_array());
        rows
    }
}

impl<L: Lanes> BsdfLanes<L> for LambertLanes<L> {
    const ROWS: usize = 1;

    #[inline(always)]
    fn load(lanes: L, rows: &[Rows; BSDF_ROWS], _: BsdfForm, _: Vec3f<L>) -> Self {
        Self { reflectance: Vec3f::of_columns(lanes.columns(&rows[0])) }
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
            valid: is_above(lanes, wo.z.abs()),
        }
    }

    #[inline(always)]
    fn albedo(&self, _: L) -> Vec3f<L> {
        self.reflectance
    }
}
