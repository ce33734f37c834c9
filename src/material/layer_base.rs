//! What lies below layers.

use super::anisotropic::Anisotropic;
use super::base::BaseBsdf;
use super::cover::Cover;
use super::dielectric::Dielectric;
use super::filmed::Filmed;
use super::form::BsdfForm;
use super::layer_columns::Curve;
use super::mixed::{Mixed, Opaque};
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

    /// See [`super::Bsdf::eval`]; with what layers above keep.
    pub fn eval(&self, kept: Option<&Curve>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let cover = Cover { film: None, kept };
        match self {
            Self::Plain(BaseBsdf::Dielectric(glass)) => glass.eval_under(cover, wo, wi),
            Self::Plain(BaseBsdf::Mixed(mixed)) => mixed.eval_under(cover, wo, wi),
            Self::Plain(bsdf) => bsdf.eval(wo, wi),
            Self::HalfClear(mixed) => mixed.eval_under(cover, wo, wi),
            Self::Brushed(brushed) => brushed.eval(wo, wi),
            Self::Filmed(filmed) => filmed.eval(kept, wo, wi),
        }
    }

    /// See [`super::Bsdf::sample`]; with what layers above keep.
    pub fn sample(
        &self,
        kept: Option<&Curve>,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        let cover = Cover { film: None, kept };
        match self {
            Self::Plain(BaseBsdf::Dielectric(glass)) => glass.sample_under(cover, wo, u_lobe, u),
            Self::Plain(BaseBsdf::Mixed(mixed)) => mixed.sample_under(cover, wo, u_lobe, u),
            Self::Plain(bsdf) => bsdf.sample(wo, u_lobe, u),
            Self::HalfClear(mixed) => mixed.sample_under(cover, wo, u_lobe, u),
            Self::Brushed(brushed) => brushed.sample(wo, u_lobe, u),
            Self::Filmed(filmed) => filmed.sample(kept, wo, u_lobe, u),
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

    /// The share of the light on what has no inside that goes on, by colour, and of that what goes
    /// through.
    pub fn scattered(&self) -> [Vec3; 2] {
        match self {
            Self::Plain(BaseBsdf::Translucent(surface)) => Opaque::scattered(surface),
            Self::Plain(BaseBsdf::Dielectric(sheet)) => sheet.scattered_by_sheet(),
            Self::Plain(BaseBsdf::Mixed(mixed)) => mixed.scattered_by_sheet(),
            Self::HalfClear(mixed) => mixed.scattered_by_sheet(),
            Self::Filmed(filmed) => filmed.scattered_by_sheet(),
            Self::Plain(_) | Self::Brushed(_) => [self.albedo(), Vec3::ZERO],
        }
    }

    /// The index of refraction beyond a solid's surface over that on the viewer's side.
    pub fn eta(&self, wo: Vec3) -> f32 {
        let ior = self.clear_part().map_or(1.0, |(glass, _)| glass.index());
        if wo.z < 0.0 { 1.0 / ior } else { ior }
    }

    /// Whether some light goes through scattered.
    pub fn scatters_through(&self) -> bool {
        matches!(self, Self::Plain(BaseBsdf::Translucent(_)) | Self::HalfClear(_))
    }

    /// What is glass, and the share of it.
    pub fn clear_part(&self) -> Option<(&Dielectric, f32)> {
        match self {
            Self::Plain(BaseBsdf::Dielectric(glass)) => Some((glass, 1.0)),
            Self::Plain(BaseBsdf::Mixed(mixed)) => Some(mixed.clear_part()),
            Self::HalfClear(mixed) => Some(mixed.clear_part()),
            Self::Filmed(filmed) if filmed.transmits() => Some(filmed.clear_part()),
            Self::Plain(_) | Self::Brushed(_) | Self::Filmed(_) => None,
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
