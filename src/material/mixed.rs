//! Surfaces that are clear in part.

use super::{BsdfForm, BsdfSample, Dielectric, MetallicRoughness, SurfaceParams, unit};
use crate::math::{Vec2, Vec3};
use crate::sampling::ONE_MINUS_EPSILON;

/// Glass with probability `share`, else opaque: a transmission between 0 and 1, metal aside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed {
    opaque: MetallicRoughness,
    glass: Dielectric,
    share: f32,
}

impl Mixed {
    /// What `params` describe; `share = transmission * (1 - metallic)`, between 0 and 1.
    pub(super) fn new(params: &SurfaceParams, share: f32, form: BsdfForm) -> Self {
        // All of the metal is in the part that is not clear.
        let metallic = unit(unit(params.metallic) / (1.0 - share));
        Self {
            opaque: MetallicRoughness::with_metallic(params, metallic, form),
            glass: Dielectric::new(params, form),
            share,
        }
    }

    /// See [`super::Bsdf::eval`].
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (opaque, opaque_pdf) = self.opaque.eval(wo, wi);
        let (glass, glass_pdf) = self.glass.eval(wo, wi);
        let (share, rest) = (self.share, 1.0 - self.share);
        (opaque * rest + glass * share, opaque_pdf * rest + glass_pdf * share)
    }

    /// See [`super::Bsdf::sample`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let mut sample = if u_lobe < self.share {
            self.glass.sample(wo, (u_lobe / self.share).min(ONE_MINUS_EPSILON), u)?
        } else {
            let rest = (u_lobe - self.share) / (1.0 - self.share);
            self.opaque.sample(wo, rest.min(ONE_MINUS_EPSILON), u)?
        };
        if sample.delta {
            // The share weighs the lobe and its probability alike.
            sample.pdf *= self.share;
            return Some(sample);
        }
        let (value, pdf) = self.eval(wo, sample.wi);
        (sample.weight, sample.pdf) = (value / pdf, pdf);
        (pdf > 0.0).then_some(sample)
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.opaque.albedo() * (1.0 - self.share) + self.glass.albedo() * self.share
    }
}
