//! Surfaces that are clear in part.

use super::cover::Cover;
use super::dielectric::Dielectric;
use super::form::BsdfForm;
use super::metallic_roughness::MetallicRoughness;
use super::params::{SurfaceParams, saturate};
use super::sample::BsdfSample;
use super::translucent::Translucent;
use crate::math::{Vec2, Vec3};
use crate::sampling::ONE_MINUS_EPSILON;

/// Glass with probability `share`, else opaque: a transmission between 0 and 1, metal aside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mixed<O = MetallicRoughness> {
    opaque: O,
    glass: Dielectric,
    share: f32,
}

/// What may be mixed with glass.
pub trait Opaque {
    /// The opaque part of what `params` describe, with `metallic` in place of the parameter.
    fn part(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self;

    /// See [`super::Bsdf::eval`].
    fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32);

    /// See [`super::Bsdf::sample`].
    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample>;

    /// See [`super::Bsdf::albedo`].
    fn albedo(&self) -> Vec3;

    /// The share of light that goes on, by colour, and of that what goes through.
    fn scattered(&self) -> [Vec3; 2];
}

impl Opaque for MetallicRoughness {
    fn part(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self {
        Self::with_metallic(params, metallic, form)
    }

    #[inline(always)]
    fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval(wo, wi)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.sample(wo, u_lobe, u)
    }

    fn albedo(&self) -> Vec3 {
        self.albedo()
    }

    fn scattered(&self) -> [Vec3; 2] {
        [self.albedo(), Vec3::ZERO]
    }
}

impl Opaque for Translucent {
    fn part(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self {
        Self::beside_glass(params, metallic, form)
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval(wo, wi)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.sample(wo, u_lobe, u)
    }

    fn albedo(&self) -> Vec3 {
        self.albedo()
    }

    fn scattered(&self) -> [Vec3; 2] {
        [self.albedo(), self.transmission().albedo()]
    }
}

impl<O: Opaque> Mixed<O> {
    /// The surface that `params` describe; `share = transmission * (1 - metallic)`, between 0 and
    /// 1.
    pub(super) fn new(params: &SurfaceParams, share: f32, form: BsdfForm) -> Self {
        // All of the metal is in the part that is not clear.
        let metallic = saturate(saturate(params.metallic) / (1.0 - share));
        Self {
            opaque: O::part(params, metallic, form),
            glass: Dielectric::new(params, form),
            share,
        }
    }

    /// See [`super::Bsdf::eval`].
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_under(Cover::default(), wo, wi)
    }

    /// The same with something on the outside of the glass.
    #[inline]
    pub(super) fn eval_under(&self, cover: Cover<'_>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        mix(self.share, self.opaque.eval(wo, wi), self.glass.eval_under(cover, wo, wi))
    }

    /// See [`super::Bsdf::sample`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.sample_under(Cover::default(), wo, u_lobe, u)
    }

    /// The same with something on the outside of the glass.
    #[inline]
    pub(super) fn sample_under(
        &self,
        cover: Cover<'_>,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        sample_mixed(
            self.share,
            u_lobe,
            |u_lobe| self.opaque.sample(wo, u_lobe, u),
            |u_lobe| self.glass.sample_under(cover, wo, u_lobe, u),
            |wi| self.eval_under(cover, wo, wi),
        )
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.opaque.albedo() * (1.0 - self.share) + self.glass.albedo() * self.share
    }

    /// The same of a sheet, as far as light does not go on in one direction.
    pub(super) fn scattered_by_sheet(&self) -> [Vec3; 2] {
        mix_scattered(self.share, self.opaque.scattered(), &self.glass)
    }

    /// What is glass, and the share of it.
    pub(super) fn clear_part(&self) -> (&Dielectric, f32) {
        (&self.glass, self.share)
    }
}

/// What is scattered, as far as it does not go on in one direction, by what is opaque but for a
/// `share` of a sheet of glass.
pub(super) fn mix_scattered(share: f32, opaque: [Vec3; 2], sheet: &Dielectric) -> [Vec3; 2] {
    if sheet.is_delta() {
        return opaque;
    }
    let sheet = sheet.scattered_by_sheet();
    std::array::from_fn(|k| opaque[k] * (1.0 - share) + sheet[k] * share)
}

/// Values and densities of what is opaque but for a `share` of glass.
#[inline(always)]
pub(super) fn mix(share: f32, opaque: (Vec3, f32), glass: (Vec3, f32)) -> (Vec3, f32) {
    let rest = 1.0 - share;
    (opaque.0 * rest + glass.0 * share, opaque.1 * rest + glass.1 * share)
}

/// Samples one of both by `u_lobe`, with the value and the density of both together.
#[inline(always)]
pub(super) fn sample_mixed(
    share: f32,
    u_lobe: f32,
    opaque: impl FnOnce(f32) -> Option<BsdfSample>,
    glass: impl FnOnce(f32) -> Option<BsdfSample>,
    eval: impl FnOnce(Vec3) -> (Vec3, f32),
) -> Option<BsdfSample> {
    let mut sample = if u_lobe < share {
        glass((u_lobe / share).min(ONE_MINUS_EPSILON))?
    } else {
        opaque(((u_lobe - share) / (1.0 - share)).min(ONE_MINUS_EPSILON))?
    };
    if sample.delta {
        // The share weighs the lobe and its probability alike.
        sample.pdf *= share;
        return Some(sample);
    }
    let (value, pdf) = eval(sample.wi);
    (sample.weight, sample.pdf) = (value / pdf, pdf);
    (pdf > 0.0).then_some(sample)
}
