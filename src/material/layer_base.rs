//! What lies below layers.

use super::anisotropic::Anisotropic;
use super::base::BaseBsdf;
use super::filmed::Filmed;
use super::form::BsdfForm;
use super::mixed::Mixed;
use super::params::{SurfaceParams, saturate};
use super::sample::BsdfSample;
use super::translucent::Translucent;
use crate::math::{Vec2, Vec3};

/// The share of glass.
pub(super) fn clear_share(params: &SurfaceParams) -> f32 {
    saturate(params.transmission) * (1.0 - saturate(params.metallic))
}

/// Whether light goes through both straight and scattered: too much for a [`BaseBsdf`].
pub(super) fn is_half_clear(params: &SurfaceParams) -> bool {
    (1e-6..1.0).contains(&clear_share(params)) && Translucent::is_seen(params)
}

/// What lies below all layers.
#[derive(Clone, Copy, Debug)]
pub(super) enum Base {
    Plain(BaseBsdf),
    /// Glass in part, else a surface that lets light through scattered.
    HalfClear(Mixed<Translucent>),
    Brushed(Anisotropic),
    Filmed(Filmed),
}

impl Base {
    /// What is neither brushed nor under a film.
    pub fn plain(params: &SurfaceParams, form: BsdfForm) -> Self {
        if is_half_clear(params) {
            Self::HalfClear(Mixed::new(params, clear_share(params), form))
        } else {
            Self::Plain(BaseBsdf::new(params, form))
        }
    }

    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self {
            Self::Plain(bsdf) => bsdf.eval(wo, wi),
            Self::HalfClear(mixed) => mixed.eval(wo, wi),
            Self::Brushed(brushed) => brushed.eval(wo, wi),
            Self::Filmed(filmed) => filmed.eval(wo, wi),
        }
    }

    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Plain(bsdf) => bsdf.sample(wo, u_lobe, u),
            Self::HalfClear(mixed) => mixed.sample(wo, u_lobe, u),
            Self::Brushed(brushed) => brushed.sample(wo, u_lobe, u),
            Self::Filmed(filmed) => filmed.sample(wo, u_lobe, u),
        }
    }

    pub fn transmits(&self) -> bool {
        match self {
            Self::Plain(bsdf) => bsdf.transmits(),
            Self::HalfClear(_) => true,
            Self::Brushed(_) => false,
            Self::Filmed(filmed) => filmed.transmits(),
        }
    }

    /// Of its albedo, what goes through scattered and at the index of refraction that it came with.
    pub fn scattered_through(&self) -> Vec3 {
        match self {
            Self::Plain(BaseBsdf::Translucent(surface)) => surface.albedo_through(),
            _ => Vec3::ZERO,
        }
    }

    pub fn albedo(&self) -> Vec3 {
        match self {
            Self::Plain(bsdf) => bsdf.albedo(),
            Self::HalfClear(mixed) => mixed.albedo(),
            Self::Brushed(brushed) => brushed.albedo(),
            Self::Filmed(filmed) => filmed.albedo(),
        }
    }
}
