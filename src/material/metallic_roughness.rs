//! glTF's opaque material: metals, and dielectrics over a diffuse base.

use super::energy::{Albedo, Albedos, Row};
use super::form::BsdfForm;
use super::ggx::{MIN_ALPHA, MIRROR_ALPHA};
use super::lanes::{BsdfLanes, BsdfRows, MIN_SPECULAR_PROBABILITY, MetallicRoughnessLanes};
use super::params::{SurfaceParams, saturate};
use super::sample::{BsdfSample, mean};
use crate::math::{Vec2, Vec3};
use crate::simd::lanes::Scalar;

/// A metal and a coated diffuse base, mixed by `metallic`: a specular lobe, and one that follows
/// the cosine.
///
/// Both Fresnel terms are Schlick's and share the half vector, so metal and coat are one lobe of
/// mixed `f0` and `f90`. In [`BsdfForm::AppendixB`] the diffuse part is `base / π * (1 - F)`, as
/// glTF 2.0 has it in Appendix B. In [`BsdfForm::Conserving`] it is
/// `base / π * (1 - S(o)) (1 - S(i)) / (1 - S_avg)`, S the coat's albedo (Kelemen and
/// Szirmay-Kalos, 2001), and the metal's multiple scattering is
/// `F / π * (1 - E(o)) (1 - E(i)) / (1 - E_avg)`, E the white lobe's albedo (Kulla and Conty,
/// "Revisiting Physically Based Shading at Imageworks", 2017). Both are reciprocal and add up to
/// one where everything is white. The coat's own multiple scattering is part of what S leaves to
/// the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetallicRoughness {
    /// Colour of the diffuse base, times one minus metallic.
    pub(super) diffuse: Vec3,
    /// Of metal and coat together.
    pub(super) f0: Vec3,
    pub(super) f90: f32,
    /// Of the coat alone; its brightest channel.
    pub(super) coat_f0: f32,
    pub(super) coat_f90: f32,
    pub(super) alpha: f32,
    pub(super) row: Row,
    /// `1 / (1 - S_avg)`.
    pub(super) coat_scale: f32,
    /// Metallic times the colour of light that bounced more than once.
    pub(super) multiple: Vec3,
    /// `1 / (1 - E_avg)`.
    pub(super) multiple_scale: f32,
    pub(super) form: BsdfForm,
}

impl MetallicRoughness {
    /// The opaque part of what `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        Self::with_metallic(params, saturate(params.metallic), form)
    }

    pub(super) fn with_metallic(params: &SurfaceParams, metallic: f32, form: BsdfForm) -> Self {
        let roughness = saturate(params.roughness);
        let alpha = (roughness * roughness).max(MIN_ALPHA);
        let row = Row::of(alpha);
        Self::with_average(params, metallic, form, alpha, || Albedos::get().average(row))
    }

    /// The same with a lobe of a given average albedo.
    #[inline]
    pub(super) fn with_average(
        params: &SurfaceParams,
        metallic: f32,
        form: BsdfForm,
        alpha: f32,
        average: impl FnOnce() -> Albedo,
    ) -> Self {
        let specular = saturate(params.specular);
        let (base, dielectric) = (params.base_color, 1.0 - metallic);

        let coat = coat_f0(params);
        let (coat_f0, coat_f90) = (coat.max_element(), specular);

        let (mut coat_scale, mut multiple, mut multiple_scale) = (1.0, Vec3::ZERO, 0.0);
        if form == BsdfForm::Conserving {
            let average = average();
            let below = 1.0 - average.of(coat_f0, coat_f90);
            coat_scale = if below > 1e-4 { 1.0 / below } else { 0.0 };
            let loss = average.loss();
            if metallic > 0.0 && loss > 1e-4 {
                // Fresnel's average over the hemisphere; what bounces on is dimmed again and again.
                let fresnel = base + (Vec3::ONE - base) * (1.0 / 21.0);
                multiple = multiple_scattering(fresnel, loss) * metallic;
                multiple_scale = 1.0 / loss;
            }
        }
        Self {
            diffuse: base * dielectric,
            f0: coat * dielectric + base * metallic,
            f90: coat_f90 * dielectric + metallic,
            coat_f0,
            coat_f90,
            alpha,
            row: Row::of(alpha),
            coat_scale,
            multiple,
            multiple_scale,
            form,
        }
    }

    /// The same with another specular lobe, whose reflectances nowhere exceed Schlick's of
    /// `coat_f0` and one: `f0` is its reflectance from above, `average` the metal's over the
    /// hemisphere, and `albedo` the white lobe's.
    pub(super) fn with_reflectance(
        self,
        f0: Vec3,
        coat_f0: f32,
        (metallic, average): (f32, Vec3),
        albedo: Albedo,
    ) -> Self {
        let (mut coat_scale, mut multiple) = (1.0, Vec3::ZERO);
        if self.form == BsdfForm::Conserving {
            let below = 1.0 - albedo.of(coat_f0, 1.0);
            coat_scale = if below > 1e-4 { 1.0 / below } else { 0.0 };
            if self.multiple_scale > 0.0 {
                multiple = multiple_scattering(average, albedo.loss()) * metallic;
            }
        }
        Self { f0, f90: 1.0, coat_f0, coat_f90: 1.0, coat_scale, multiple, ..self }
    }

    /// See [`super::Bsdf::is_mirror_like`].
    pub fn is_mirror_like(&self) -> bool {
        self.diffuse == Vec3::ZERO && self.alpha <= MIRROR_ALPHA
    }

    /// See [`super::Bsdf::eval`].
    #[inline(always)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let bsdf = self.facing(wo);
        let (value, pdf) = bsdf.eval(Scalar, wo.into(), wi.into());
        (value.into(), pdf)
    }

    /// See [`super::Bsdf::sample`].
    #[inline(always)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let bsdf = self.facing(wo);
        bsdf.sample(Scalar, wo.into(), u_lobe, u.to_array()).first(false)
    }

    /// For [`MetallicRoughnessLanes`].
    pub(crate) fn rows(&self) -> BsdfRows {
        let row = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
        [
            row(self.diffuse, self.f90),
            row(self.f0, self.alpha),
            row(self.multiple, self.multiple_scale),
            [self.row.place(), self.coat_f0, self.coat_f90, self.coat_scale],
        ]
    }

    /// The one form of its formulas, for one lane.
    #[inline(always)]
    fn facing(&self, wo: Vec3) -> MetallicRoughnessLanes<Scalar> {
        MetallicRoughnessLanes::new(Scalar, self.rows(), self.form, wo.into())
    }

    /// The probability of the specular lobe where its albedo is this.
    #[inline(always)]
    pub(super) fn specular_probability(&self, albedo: Albedo) -> f32 {
        let specular = mean(self.f0) * albedo.f0 + self.f90 * albedo.f90;
        let below = mean(self.diffuse) * (1.0 - albedo.of(self.coat_f0, self.coat_f90));
        let other = below + mean(self.multiple) * albedo.loss();
        if other <= 0.0 {
            1.0
        } else if specular <= 0.0 {
            0.0
        } else {
            (specular / (specular + other)).max(MIN_SPECULAR_PROBABILITY)
        }
    }

    /// The specular lobe's colour, of Schlick's weight at the half vector.
    #[inline(always)]
    pub(super) fn fresnel(&self, weight: f32) -> Vec3 {
        self.f0 + (self.f90 - self.f0) * weight
    }

    /// The lobe that follows the cosine, times π, for Schlick's weight at the half vector and the
    /// specular lobe's albedos towards the viewer and towards the light.
    #[inline(always)]
    pub(super) fn smooth(
        &self,
        weight: f32,
        view: Albedo,
        towards: impl FnOnce() -> Albedo,
    ) -> Vec3 {
        match self.form {
            BsdfForm::AppendixB => {
                let coat = self.coat_f0 + (self.coat_f90 - self.coat_f0) * weight;
                self.diffuse * (1.0 - coat)
            }
            BsdfForm::Conserving => {
                let towards = towards();
                let through = |albedo: Albedo| 1.0 - albedo.of(self.coat_f0, self.coat_f90);
                let below = through(view) * through(towards) * self.coat_scale;
                let again = view.loss() * towards.loss() * self.multiple_scale;
                self.diffuse * below + self.multiple * again
            }
        }
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.diffuse * (1.0 - self.coat_f0) + self.f0
    }
}

/// The reflectance of a dielectric's surface at normal incidence, by colour.
pub(super) fn coat_f0(params: &SurfaceParams) -> Vec3 {
    let root = (params.ior - 1.0) / (params.ior + 1.0);
    (params.specular_color * (root * root)).min(Vec3::ONE) * saturate(params.specular)
}

/// The colour of light that a metal has reflected more than once, from its average reflectance and
/// the share of light that the white lobe loses.
#[inline]
fn multiple_scattering(fresnel: Vec3, loss: f32) -> Vec3 {
    let series = (Vec3::ONE - fresnel * loss).max(Vec3::splat(1e-4));
    fresnel * fresnel * (1.0 - loss) / series
}
