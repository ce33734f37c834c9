//! The BSDF of a surface with nothing on it.

use super::dielectric::Dielectric;
use super::form::BsdfForm;
use super::lambert::Lambert;
use super::metallic_roughness::MetallicRoughness;
use super::mixed::Mixed;
use super::params::{SurfaceParams, saturate};
use super::sample::BsdfSample;
use super::translucent::Translucent;
use crate::math::{Vec2, Vec3};

/// A BSDF without layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseBsdf {
    /// Ideal diffuse reflection.
    Lambert(Lambert),
    /// glTF's opaque material.
    MetallicRoughness(MetallicRoughness),
    /// The same, with a diffuse base that lets light through.
    Translucent(Translucent),
    /// Glass: solid or thin, smooth or rough.
    Dielectric(Dielectric),
    /// Opaque in part and glass in part: a transmission between 0 and 1.
    Mixed(Mixed),
}

impl BaseBsdf {
    /// The BSDF that `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        let metallic = saturate(params.metallic);
        let share = saturate(params.transmission) * (1.0 - metallic);
        // Less than this no picture shows, and probabilities would underflow.
        let share = if share < 1e-6 { 0.0 } else { share };
        if share >= 1.0 {
            Self::Dielectric(Dielectric::new(params, form))
        } else if share > 0.0 {
            Self::Mixed(Mixed::new(params, share, form))
        } else if Translucent::is_seen(params) {
            Self::Translucent(Translucent::new(params, metallic, form))
        } else if metallic == 0.0 && params.specular <= 0.0 {
            Self::Lambert(Lambert { reflectance: params.base_color })
        } else {
            Self::MetallicRoughness(MetallicRoughness::new(params, form))
        }
    }

    /// See [`super::Bsdf::eval`].
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self {
            Self::Lambert(lambert) => lambert.eval(wo, wi),
            Self::MetallicRoughness(surface) => surface.eval(wo, wi),
            Self::Translucent(surface) => surface.eval(wo, wi),
            Self::Dielectric(glass) => glass.eval(wo, wi),
            Self::Mixed(mixed) => mixed.eval(wo, wi),
        }
    }

    /// See [`super::Bsdf::sample`].
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Lambert(lambert) => lambert.sample(wo, u),
            Self::MetallicRoughness(surface) => surface.sample(wo, u_lobe, u),
            Self::Translucent(surface) => surface.sample(wo, u_lobe, u),
            Self::Dielectric(glass) => glass.sample(wo, u_lobe, u),
            Self::Mixed(mixed) => mixed.sample(wo, u_lobe, u),
        }
    }

    /// See [`super::Bsdf::is_delta`].
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Dielectric(glass) if glass.is_delta())
    }

    /// See [`super::Bsdf::transmits`].
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Lambert(_) | Self::MetallicRoughness(_) => false,
            Self::Translucent(_) | Self::Dielectric(_) | Self::Mixed(_) => true,
        }
    }

    /// See [`super::Bsdf::is_mirror_like`].
    pub fn is_mirror_like(&self) -> bool {
        match self {
            Self::Lambert(_) | Self::Translucent(_) | Self::Mixed(_) => false,
            Self::MetallicRoughness(surface) => surface.is_mirror_like(),
            Self::Dielectric(glass) => glass.is_mirror_like(),
        }
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        match self {
            Self::Lambert(lambert) => lambert.reflectance,
            Self::MetallicRoughness(surface) => surface.albedo(),
            Self::Translucent(surface) => surface.albedo(),
            Self::Dielectric(glass) => glass.albedo(),
            Self::Mixed(mixed) => mixed.albedo(),
        }
    }
}
