//! Surfaces under a thin film: metal, plastic, glass, or some of each (KHR_materials_iridescence).

use super::anisotropic::Anisotropic;
use super::cover::Cover;
use super::dielectric::Dielectric;
use super::form::BsdfForm;
use super::layer_columns::Curve;
use super::mixed::{mix, mix_scattered, sample_mixed};
use super::params::{SurfaceParams, saturate};
use super::sample::BsdfSample;
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};

/// A film over what is opaque but for a `share` of glass.
///
/// In [`BsdfForm::Conserving`] what lies below a dielectric's film gets what the brightest colour
/// leaves of Schlick's reflection as bright as the film's: never more light than there is, and a
/// little less where the film is colourful.
#[derive(Clone, Copy, Debug)]
pub struct Filmed {
    opaque: Anisotropic,
    glass: Dielectric,
    share: f32,
    film: ThinFilm,
}

impl Filmed {
    /// The surface that `params` describe under a film, brushed with a strength along a direction.
    pub fn new(
        params: &SurfaceParams,
        stretch: (f32, Vec2),
        film: ThinFilm,
        form: BsdfForm,
    ) -> Self {
        let metallic = saturate(params.metallic);
        let share = saturate(params.transmission) * (1.0 - metallic);
        // All of the metal is in the part that is not clear.
        let metallic = saturate(metallic / (1.0 - share));
        let opaque = Anisotropic::with_film(params, metallic, stretch, film, form);
        Self { opaque, glass: Dielectric::new(params, form), share, film }
    }

    /// See [`super::Bsdf::eval`]; with what layers above keep.
    pub fn eval(&self, kept: Option<&Curve>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let opaque = self.opaque.eval(wo, wi);
        if self.share == 0.0 {
            return opaque;
        }
        mix(self.share, opaque, self.glass.eval_under(self.cover(kept), wo, wi))
    }

    fn cover<'a>(&'a self, kept: Option<&'a Curve>) -> Cover<'a> {
        Cover { film: Some(&self.film), kept }
    }

    /// See [`super::Bsdf::sample`]; with what layers above keep.
    pub fn sample(
        &self,
        kept: Option<&Curve>,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        sample_mixed(
            self.share,
            u_lobe,
            |u_lobe| self.opaque.sample(wo, u_lobe, u),
            |u_lobe| self.glass.sample_under(self.cover(kept), wo, u_lobe, u),
            |wi| self.eval(kept, wo, wi),
        )
    }

    /// See [`super::Bsdf::transmits`].
    pub fn transmits(&self) -> bool {
        self.share > 0.0
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.opaque.albedo() * (1.0 - self.share) + self.glass.albedo() * self.share
    }

    /// The share of light on a sheet that goes on, by colour, as far as not in one direction, and
    /// of that what goes through.
    pub fn scattered_by_sheet(&self) -> [Vec3; 2] {
        let opaque = [self.opaque.albedo(), Vec3::ZERO];
        mix_scattered(self.share, opaque, &self.glass)
    }

    /// What is glass, and the share of it.
    pub fn clear_part(&self) -> (&Dielectric, f32) {
        (&self.glass, self.share)
    }
}
