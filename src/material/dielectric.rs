//! Glass: clear boundaries of solids, and thin sheets.

use super::boundary::{Boundary, Kind};
use super::cover::{Cover, kept_at};
use super::form::BsdfForm;
use super::ggx::MIRROR_ALPHA;
use super::lanes::{BsdfRows, SmoothBoundary};
use super::params::SurfaceParams;
use super::rough_dielectric;
use super::sample::{BsdfSample, is_above};
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};
use crate::simd::lanes::Scalar;

/// A boundary that reflects and transmits by the exact Fresnel equations; light that passes is
/// tinted once.
///
/// KHR_materials_transmission, with KHR_materials_volume a solid. A thin sheet does not bend light;
/// its reflectance is that of both faces with all reflections between them. In
/// [`BsdfForm::AppendixB`] it is smooth whatever its roughness.
///
/// KHR_materials_specular gives it other reflectances at normal incidence and at grazing angles:
/// the exact ones are scaled to go from one to the other, and what is not reflected passes. Total
/// reflection stays what it is: there is no way through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    boundary: Boundary,
}

impl Dielectric {
    /// The clear part of what `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        Self { boundary: Boundary::new(params, form) }
    }

    /// Whether both of its lobes are delta lobes.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self.boundary.kind, Kind::Smooth | Kind::ThinSmooth)
    }

    /// See [`super::Bsdf::is_mirror_like`].
    pub fn is_mirror_like(&self) -> bool {
        self.is_delta() || self.boundary.alpha <= MIRROR_ALPHA
    }

    /// See [`super::Bsdf::eval`].
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_under(Cover::default(), wo, wi)
    }

    /// The same with something on its outside.
    #[inline]
    pub(super) fn eval_under(&self, cover: Cover<'_>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self.boundary.kind {
            Kind::Smooth | Kind::ThinSmooth => (Vec3::ZERO, 0.0),
            Kind::Rough => rough_dielectric::eval_solid(&self.boundary, cover, wo, wi),
            Kind::ThinRough => rough_dielectric::eval_thin(&self.boundary, cover.film, wo, wi),
        }
    }

    /// See [`super::Bsdf::sample`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.sample_under(Cover::default(), wo, u_lobe, u)
    }

    /// The same with something on its outside.
    #[inline]
    pub(super) fn sample_under(
        &self,
        cover: Cover<'_>,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if !is_above(wo.z.abs()) {
            return None;
        }
        match self.boundary.kind {
            Kind::Smooth => sample_smooth(&self.boundary, cover, wo, u_lobe),
            Kind::ThinSmooth => sample_thin(&self.boundary, cover.film, wo, u_lobe),
            Kind::Rough => rough_dielectric::sample_solid(&self.boundary, cover, wo, u_lobe, u),
            Kind::ThinRough => {
                rough_dielectric::sample_thin(&self.boundary, cover.film, wo, u_lobe, u)
            }
        }
    }

    /// For [`super::lanes::SmoothGlassLanes`]; `None`: that is not what it is.
    pub(crate) fn rows(&self) -> Option<BsdfRows> {
        let Boundary { tint, ior, plain, .. } = self.boundary;
        let thin = f32::from(self.boundary.kind == Kind::ThinSmooth);
        let mut rows = BsdfRows::default();
        rows[0] = [tint.x, tint.y, tint.z, ior];
        rows[1] = [thin, 0.0, 0.0, 0.0];
        (self.is_delta() && plain).then_some(rows)
    }

    /// The index of refraction of the inside over that of the outside; 1 of a sheet.
    pub(super) fn index(&self) -> f32 {
        let thin = matches!(self.boundary.kind, Kind::ThinSmooth | Kind::ThinRough);
        if thin { 1.0 } else { self.boundary.ior }
    }

    /// Its boundary.
    pub(super) fn boundary(&self) -> &Boundary {
        &self.boundary
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.boundary.tint
    }

    /// The share of light from everywhere that a sheet reflects or lets through, by colour, and of
    /// that what it lets through.
    pub(super) fn scattered_by_sheet(&self) -> [Vec3; 2] {
        let passes = self.boundary.average_transmittance_of_sheet();
        let through = passes * self.boundary.tint;
        [Vec3::ONE - passes + through, through]
    }
}

/// The boundary of a solid.
fn sample_smooth(glass: &Boundary, cover: Cover<'_>, wo: Vec3, u_lobe: f32) -> Option<BsdfSample> {
    let eta = glass.eta(wo);
    let (mut split, cos_t) = glass.split(wo.z.abs(), eta, cover.film);
    let mut thrown_back = Vec3::ZERO;
    if let Some(kept) = cover.seen_from(wo).kept {
        let kept = kept_at(kept, cos_t);
        thrown_back = split.transmittance(glass.tint) * glass.tint * kept;
        split = split.below(kept, glass.tint);
    }
    let sample = SmoothBoundary {
        tint: glass.tint.into(),
        reflectance: split.reflectance.into(),
        reflection_probability: split.reflection_probability,
        eta,
        cos_t,
        thin: false,
    }
    .sample(Scalar, wo.into(), u_lobe)
    .first(true);
    sample.map(|sample| {
        let reflected = sample.wi.z * wo.z > 0.0;
        let again = if reflected { thrown_back / sample.pdf } else { Vec3::ZERO };
        BsdfSample { weight: sample.weight + again, ..sample }
    })
}

/// A sheet.
fn sample_thin(
    glass: &Boundary,
    film: Option<&ThinFilm>,
    wo: Vec3,
    u_lobe: f32,
) -> Option<BsdfSample> {
    let split = glass.split_thin(wo.z.abs(), film);
    SmoothBoundary {
        tint: glass.tint.into(),
        reflectance: split.reflectance.into(),
        reflection_probability: split.reflection_probability,
        eta: 1.0,
        cos_t: 0.0,
        thin: true,
    }
    .sample(Scalar, wo.into(), u_lobe)
    .first(true)
}

#[cfg(test)]
mod tests {
    use super::super::fresnel;
    use super::*;

    fn glass(thin: bool) -> Dielectric {
        let params = SurfaceParams {
            base_color: Vec3::new(0.5, 0.25, 1.0),
            roughness: 0.0,
            thin,
            ..SurfaceParams::default()
        };
        Dielectric::new(&params, BsdfForm::Conserving)
    }

    #[test]
    fn light_enters_and_leaves_along_the_same_way() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let inside = glass(false).sample(wo, 0.9, Vec2::ZERO).unwrap();
        assert!(inside.delta && inside.eta == 1.5);
        assert!((inside.wi - Vec3::new(-0.4, 0.0, -libm::sqrtf(0.84))).length() < 1e-6);
        let outside = glass(false).sample(inside.wi, 0.9, Vec2::ZERO).unwrap();
        assert!((outside.wi - wo).length() < 1e-6);
        assert!((outside.eta * inside.eta - 1.0).abs() < 1e-6);
        // Radiance is scaled by 1 / eta² on the way in, and back again; the tint counts twice.
        let (reflectance, _) = fresnel::dielectric(0.8, 1.5);
        let both = inside.weight * inside.pdf * outside.weight * outside.pdf;
        let once = glass(false).boundary.tint * (1.0 - reflectance);
        assert!((both - once * once).length() < 1e-5);
        assert!((inside.weight.z * inside.pdf * 2.25 - (1.0 - reflectance)).abs() < 1e-5);
    }

    #[test]
    fn a_sheet_does_not_bend_light() {
        for wo in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.6, 0.0, -0.8)] {
            let through = glass(true).sample(wo, 0.99, Vec2::ZERO).unwrap();
            assert_eq!(through.wi, -wo);
            assert_eq!(through.eta, 1.0);
            let back = glass(true).sample(wo, 0.0, Vec2::ZERO).unwrap();
            assert_eq!(back.wi, Vec3::new(-wo.x, -wo.y, wo.z));
            // White where the tint is: all light goes one way or the other.
            let total = through.weight.z * through.pdf + back.weight.z * back.pdf;
            assert!((total - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn specular_tints_and_dims_what_both_faces_reflect() {
        let of = |specular, color, thin| {
            let params = SurfaceParams {
                specular,
                specular_color: color,
                roughness: 0.0,
                thin,
                ..SurfaceParams::default()
            };
            Dielectric::new(&params, BsdfForm::Conserving)
        };
        let color = Vec3::new(1.0, 0.5, 0.0);
        let reflected =
            |glass: &Dielectric, cos, eta| glass.boundary.split(cos, eta, None).0.reflectance;
        let (glass, plain) = (of(1.0, color, false), of(1.0, Vec3::ONE, false));
        assert!((reflected(&glass, 1.0, 1.5) - color * 0.04).length() < 1e-6);
        assert!((reflected(&glass, 1.0, 1.0 / 1.5) - color * 0.04).length() < 1e-6);
        for cos in [1.0, 0.7, 0.3, 0.05] {
            let [red, green, _] = reflected(&glass, cos, 1.5).to_array();
            let exact = fresnel::dielectric(cos, 1.5).0;
            assert!((red - exact).abs() < 1e-6 && green < red, "white stays as it was: {cos}");
            assert_eq!(reflected(&plain, cos, 1.5), Vec3::splat(exact));
            assert_eq!(reflected(&of(0.0, color, false), cos, 1.5), Vec3::ZERO);
            let half = reflected(&of(0.5, Vec3::ONE, false), cos, 1.5);
            assert!((half - 0.5 * exact).length() < 1e-6);
        }
        assert_eq!(reflected(&of(0.0, color, false), 0.3, 1.0 / 1.5), Vec3::ONE, "no way through");
        let sheet = of(1.0, color, true).boundary.split_thin(1.0, None).reflectance;
        let expected = (color * 0.04).map(fresnel::thin_sheet);
        assert!((sheet - expected).length() < 1e-6);
        // As materials that tell reflectances instead of an index are written.
        let told = SurfaceParams { ior: 0.0, ..SurfaceParams::default() };
        let told = SurfaceParams { specular_color: Vec3::splat(0.2), thin: true, ..told };
        let told = Dielectric::new(&told, BsdfForm::Conserving).boundary.split_thin(1.0, None);
        assert!((told.reflectance - fresnel::thin_sheet(0.2)).length() < 1e-3);
    }

    #[test]
    fn an_infinite_index_is_a_mirror() {
        let params = SurfaceParams { ior: 0.0, roughness: 0.0, ..SurfaceParams::default() };
        let mirror = Dielectric::new(&params, BsdfForm::Conserving);
        let sample = mirror.sample(Vec3::new(0.6, 0.0, 0.8), 0.99, Vec2::ZERO).unwrap();
        assert_eq!(sample.wi, Vec3::new(-0.6, 0.0, 0.8));
    }
}
