//! How surfaces scatter light: a closed set of BSDFs over resolved parameters.
//!
//! Directions are unit vectors of a local frame whose Z is the shading normal. `wo` points towards
//! the viewer, `wi` towards the light. `wo.z < 0` is a hit from behind: opaque surfaces scatter
//! alike on both sides; for a dielectric it means inside.
//!
//! Everything that transports radiance across a boundary scales it by the square of the relative
//! index of refraction (Veach, PhD thesis 1997, 5.2), so these are BSDFs for paths from the camera.

mod anisotropic;
mod anisotropic_energy;
mod clearcoat;
#[cfg(test)]
mod delta_tests;
mod dielectric;
mod dispersion;
mod energy;
mod filmed;
mod fresnel;
mod ggx;
mod lambert;
#[cfg(test)]
mod layer_tests;
mod layered;
mod layers;
mod metallic_roughness;
mod mixed;
mod rough_dielectric;
mod sheen;
#[cfg(test)]
mod tests;
mod thin_film;

use crate::math::{Vec2, Vec3};
use crate::names::choices;

pub use dielectric::Dielectric;
pub use dispersion::Wavelength;
pub use lambert::Lambert;
pub use layered::Layered;
pub use layers::Layers;
pub use metallic_roughness::MetallicRoughness;
pub use mixed::Mixed;

/// Whether a direction of that cosine scatters: not within 1e-7 of the tangent plane, where half
/// vectors lose all of their bits (the light so lost is some 1e-14 of a diffuse surface's), and
/// not if it is NaN.
#[inline]
fn is_above(cos: f32) -> bool {
    cos > 1e-7
}

/// What glTF's metallic-roughness material and its extensions come down to at a point, named as
/// the specification names them. All texture look-ups are done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// Linear colour: of what is below a dielectric, or of a metal's reflection.
    pub base_color: Vec3,
    /// 0 dielectric to 1 metal; taken to that range.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1; taken to that range.
    pub roughness: f32,
    /// Index of refraction of the inside over that of the outside; 0 stands for infinity
    /// (KHR_materials_ior).
    pub ior: f32,
    /// Strength of the dielectric's reflection, 0 to 1; taken to that range.
    pub specular: f32,
    /// Tint of the dielectric's reflection at normal incidence.
    pub specular_color: Vec3,
    /// Share of the dielectric that is clear instead of opaque, 0 to 1; taken to that range.
    pub transmission: f32,
    /// Whether the surface is an infinitely thin sheet and not the boundary of a solid.
    pub thin: bool,
}

impl Default for SurfaceParams {
    /// A white, opaque, fully rough dielectric of index 1.5.
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            thin: false,
        }
    }
}

/// How faithful to glTF's letter, or to the conservation of energy, a BSDF is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BsdfForm {
    /// glTF 2.0, Appendix B, with separable Smith shadowing. Gains energy at grazing angles and
    /// loses it on rough metal and rough glass.
    AppendixB,
    /// The same with multiple scattering made up for, and the opaque part below a dielectric
    /// scaled by what the coat lets through: white surfaces reflect all light.
    #[default]
    Conserving,
}

choices!(BsdfForm, "BSDF form", [AppendixB => "appendix-b", Conserving => "conserving"]);

/// A direction drawn by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Towards the light; unit, local.
    pub wi: Vec3,
    /// `f * |cos wi| / pdf`.
    pub weight: Vec3,
    /// Density per solid angle, over all lobes; for a delta lobe the probability of choosing it.
    pub pdf: f32,
    /// Whether the direction was the only one that it could be, so that no light can be sampled
    /// towards it.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 but for light that
    /// enters or leaves a solid. Russian roulette takes the radiance's scaling out with it.
    pub eta: f32,
}

/// A BSDF at a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    /// Ideal diffuse reflection.
    Lambert(Lambert),
    /// glTF's opaque material.
    MetallicRoughness(MetallicRoughness),
    /// Glass: solid or thin, smooth or rough.
    Dielectric(Dielectric),
    /// Some of both: a transmission between 0 and 1.
    Mixed(Mixed),
    /// Any of those, but stretched, under a film, under cloth or under lacquer.
    Layered(Layered),
}

impl Bsdf {
    /// The BSDF that `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        let metallic = unit(params.metallic);
        let share = unit(params.transmission) * (1.0 - metallic);
        // Less than this no picture shows, and probabilities would underflow.
        let share = if share < 1e-6 { 0.0 } else { share };
        if share >= 1.0 {
            Self::Dielectric(Dielectric::new(params, form))
        } else if share > 0.0 {
            Self::Mixed(Mixed::new(params, share, form))
        } else if metallic == 0.0 && params.specular <= 0.0 {
            Self::Lambert(Lambert { reflectance: params.base_color })
        } else {
            Self::MetallicRoughness(MetallicRoughness::new(params, form))
        }
    }

    /// The BSDF of a surface with something on it.
    pub fn layered(params: &SurfaceParams, layers: &Layers, form: BsdfForm) -> Self {
        match Layered::new(params, layers, form) {
            Some(layered) => Self::Layered(layered),
            None => Self::new(params, form),
        }
    }

    /// `f(wo, wi) * |cos wi|` and the density per solid angle with which [`Bsdf::sample`] draws
    /// `wi`. Delta lobes count for nothing.
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self {
            Self::Lambert(lambert) => lambert.eval(wo, wi),
            Self::MetallicRoughness(surface) => surface.eval(wo, wi),
            Self::Dielectric(glass) => glass.eval(wo, wi),
            Self::Mixed(mixed) => mixed.eval(wo, wi),
            Self::Layered(layered) => layered.eval(wo, wi),
        }
    }

    /// Draws a direction towards the light: `u_lobe` chooses what happens, `u` where it goes.
    /// `None` where the light is absorbed, or scatters below the surface.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        match self {
            Self::Lambert(lambert) => lambert.sample(wo, u),
            Self::MetallicRoughness(surface) => surface.sample(wo, u_lobe, u),
            Self::Dielectric(glass) => glass.sample(wo, u_lobe, u),
            Self::Mixed(mixed) => mixed.sample(wo, u_lobe, u),
            Self::Layered(layered) => layered.sample(wo, u_lobe, u),
        }
    }

    /// Whether all that it does is delta lobes, so that sampling lights is in vain.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Dielectric(glass) if glass.is_delta())
    }

    /// Whether light may pass from one side to the other.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Self::Lambert(_) | Self::MetallicRoughness(_) => false,
            Self::Dielectric(_) | Self::Mixed(_) => true,
            Self::Layered(layered) => layered.transmits(),
        }
    }

    /// About the share of light that it returns, by colour; for the albedo layer.
    pub fn albedo(&self) -> Vec3 {
        match self {
            Self::Lambert(lambert) => lambert.reflectance,
            Self::MetallicRoughness(surface) => surface.albedo(),
            Self::Dielectric(glass) => glass.albedo(),
            Self::Mixed(mixed) => mixed.albedo(),
            Self::Layered(layered) => layered.albedo(),
        }
    }
}

/// `x` taken to `[0, 1]`, NaN to 0.
fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// The mean of the channels: what lobes are chosen by.
#[inline]
fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}
