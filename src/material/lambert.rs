//! Ideal diffuse reflection.

use super::form::BsdfForm;
use super::lanes::{BsdfLanes, BsdfRows, LambertLanes};
use super::sample::BsdfSample;
use crate::math::{Vec2, Vec3};
use crate::simd::lanes::Scalar;

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
        let (value, pdf) = self.facing(wo).eval(Scalar, wo.into(), wi.into());
        (value.into(), pdf)
    }

    /// See [`super::Bsdf::sample`].
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Option<BsdfSample> {
        self.facing(wo).sample(Scalar, wo.into(), 0.0, u.to_array()).first(false)
    }

    /// For [`LambertLanes`].
    pub(crate) fn rows(&self) -> BsdfRows {
        let mut rows = BsdfRows::default();
        rows[0][..3].copy_from_slice(&self.reflectance.to_array());
        rows
    }

    /// The one form of its formulas, for one lane.
    #[inline(always)]
    fn facing(&self, wo: Vec3) -> LambertLanes<Scalar> {
        LambertLanes::new(Scalar, self.rows(), BsdfForm::default(), wo.into())
    }
}
