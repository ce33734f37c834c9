//! The BSDF of a point: a base, alone or under layers.

use super::base::BaseBsdf;
use super::form::BsdfForm;
use super::layer_base::is_half_clear;
use super::layered::Layered;
use super::layers::Layers;
use super::params::SurfaceParams;
use super::sample::BsdfSample;
use crate::math::{Vec2, Vec3};

/// A BSDF at a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// A surface with nothing on it.
    Base(BaseBsdf),
    /// The same, but stretched, under a film, under cloth or under lacquer.
    Layered(Layered),
}

impl Bsdf {
    /// The BSDF that `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        if is_half_clear(params) {
            return Self::layered(params, &Layers::NONE, form);
        }
        Self::Base(BaseBsdf::new(params, form))
    }

    /// The BSDF of a surface with something on it.
    pub fn layered(params: &SurfaceParams, layers: &Layers, form: BsdfForm) -> Self {
        match Layered::new(params, layers, form) {
            Some(layered) => Self::Layered(layered),
            None => Self::Base(BaseBsdf::new(params, form)),
        }
    }

    /// `f(wo, wi) * |cos wi|` and the density per solid angle with which [`Bsdf::sample`] draws
    /// `wi`. Delta lobes count for nothing.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self {
            Self::Base(base) => base.eval(wo, wi),
            Self::Layered(layered) => layered.eval(wo, wi),
        }
    }

    /// Samples a direction towards the light: `u_lobe` chooses the lobe, `u` the direction.
    /// `None` where the light is absorbed, or scatters below the surface.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Base(base) => base.sample(wo, u_lobe, u),
            Self::Layered(layered) => layered.sample(wo, u_lobe, u),
        }
    }

    /// Whether all lobes are delta lobes, so that sampling lights is in vain.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Base(base) if base.is_delta())
    }

    /// Whether light may pass from one side to the other.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Base(base) => base.transmits(),
            Self::Layered(layered) => layered.transmits(),
        }
    }

    /// Whether one looks at what it mirrors or at what lies behind it, and not at itself: it
    /// scatters nothing diffusely, and its lobes are delta lobes or nearly so.
    pub fn is_mirror_like(&self) -> bool {
        matches!(self, Self::Base(base) if base.is_mirror_like())
    }

    /// About the share of light that it returns, by colour; for the albedo AOV.
    pub fn albedo(&self) -> Vec3 {
        match self {
            Self::Base(base) => base.albedo(),
            Self::Layered(layered) => layered.albedo(),
        }
    }
}
