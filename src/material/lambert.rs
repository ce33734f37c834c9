//! Ideal diffuse reflection.

use std::f32::consts::FRAC_1_PI;

use super::sample::{BsdfSample, is_above};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Reflects light evenly into the hemisphere that it came from, on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lambert {
    /// Share of the light that is reflected, by colour.
    pub reflectance: Vec3,
}

impl Lambert {
    /// See [`super::Bsdf::eval`].
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let cos = if wo.z < 0.0 { -wi.z } else { wi.z };
        if !(is_above(wo.z.abs()) && is_above(cos)) {
            return (Vec3::ZERO, 0.0);
        }
        let pdf = cos * FRAC_1_PI;
        (self.reflectance * pdf, pdf)
    }

    /// See [`super::Bsdf::sample`].
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        if !is_above(wo.z.abs()) {
            return None;
        }
        let mut wi = warp::cosine_hemisphere(u);
        let pdf = warp::cosine_hemisphere_pdf(wi.z);
        wi.z = wi.z.copysign(wo.z);
        Some(BsdfSample { wi, weight: self.reflectance, pdf, delta: false, eta: 1.0 })
    }
}
