//! Glass: clear boundaries of solids, and thin sheets.

use super::energy::GlassAlbedo;
use super::metallic_roughness::coat_f0;
use super::thin_film::ThinFilm;
use super::{BsdfForm, BsdfSample, SurfaceParams, fresnel, is_above, mean, rough_dielectric, unit};
use crate::math::{Vec2, Vec3};

/// Up to this roughness a boundary is taken as smooth.
const SMOOTH: f32 = 0.02;

/// Stands for the infinite index that KHR_materials_ior writes as 0.
const INFINITE_IOR: f32 = 1e4;

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
    pub(super) tint: Vec3,
    /// Of the inside over the outside.
    pub(super) ior: f32,
    pub(super) alpha: f32,
    pub(super) form: BsdfForm,
    kind: Kind,
    /// Whether reflectances are those of the index.
    plain: bool,
    /// One face's reflectance at normal incidence and, of all colours, at grazing angles.
    f0: Vec3,
    f90: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Smooth,
    Rough,
    ThinSmooth,
    ThinRough,
}

/// The two things that a boundary does to light, for one direction of view.
pub(super) struct Split {
    pub reflectance: Vec3,
    /// Probability of drawing the reflection.
    pub choice: f32,
}

impl Split {
    #[inline]
    fn new(reflectance: f32, tint: Vec3) -> Self {
        Self::by(Vec3::splat(reflectance), reflectance, tint)
    }

    #[inline]
    fn by(colors: Vec3, reflectance: f32, tint: Vec3) -> Self {
        let transmitted = (1.0 - reflectance) * tint.max_element().max(0.0);
        // Black glass seen where it does not reflect: draw the nothing that is transmitted.
        let all = reflectance + transmitted;
        Self { reflectance: colors, choice: if all > 0.0 { reflectance / all } else { 0.0 } }
    }

    /// Tinted share of the light that passes.
    #[inline]
    pub fn transmittance(&self, tint: Vec3) -> Vec3 {
        tint * (Vec3::ONE - self.reflectance)
    }
}

impl Dielectric {
    /// The clear part of what `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        let usable = params.ior.is_finite() && params.ior > 1e-3;
        let ior = if usable { params.ior.min(INFINITE_IOR) } else { INFINITE_IOR };
        let roughness = unit(params.roughness);
        // Rough or not, what does not bend light lets it pass straight.
        let rough = roughness > SMOOTH && (ior - 1.0).abs() > 1e-3;
        let kind = match (params.thin, rough) {
            (false, false) => Kind::Smooth,
            (false, true) => Kind::Rough,
            (true, true) if form == BsdfForm::Conserving => Kind::ThinRough,
            (true, _) => Kind::ThinSmooth,
        };
        Self {
            tint: params.base_color,
            ior,
            alpha: roughness * roughness,
            form,
            kind,
            plain: params.specular >= 1.0 && params.specular_color == Vec3::ONE,
            f0: coat_f0(&SurfaceParams { ior, ..*params }),
            f90: unit(params.specular),
        }
    }

    /// Whether it only reflects and refracts as mirrors and lenses do.
    #[inline]
    pub fn is_delta(&self) -> bool {
        matches!(self.kind, Kind::Smooth | Kind::ThinSmooth)
    }

    /// See [`super::Bsdf::eval`].
    #[inline]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.eval_under(None, wo, wi)
    }

    /// The same, under a film on the outside.
    #[inline]
    pub fn eval_under(&self, film: Option<&ThinFilm>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        match self.kind {
            Kind::Smooth | Kind::ThinSmooth => (Vec3::ZERO, 0.0),
            Kind::Rough => rough_dielectric::eval_solid(self, film, wo, wi),
            Kind::ThinRough => rough_dielectric::eval_thin(self, film, wo, wi),
        }
    }

    /// See [`super::Bsdf::sample`].
    #[inline]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.sample_under(None, wo, u_lobe, u)
    }

    /// The same, under a film on the outside.
    #[inline]
    pub fn sample_under(
        &self,
        film: Option<&ThinFilm>,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
    ) -> Option<BsdfSample> {
        if !is_above(wo.z.abs()) {
            return None;
        }
        match self.kind {
            Kind::Smooth => Some(self.sample_smooth(film, wo, u_lobe)),
            Kind::ThinSmooth => Some(self.sample_thin(film, wo, u_lobe)),
            Kind::Rough => rough_dielectric::sample_solid(self, film, wo, u_lobe, u),
            Kind::ThinRough => rough_dielectric::sample_thin(self, film, wo, u_lobe, u),
        }
    }

    /// Index on the far side over that on the side of `wo`.
    #[inline]
    pub(super) fn eta(&self, wo: Vec3) -> f32 {
        if wo.z < 0.0 { 1.0 / self.ior } else { self.ior }
    }

    /// What the boundary of a solid does to light that meets it, or a facet of it, at that cosine;
    /// and the cosine of the refracted ray.
    #[inline]
    pub(super) fn split(&self, cos: f32, eta: f32, film: Option<&ThinFilm>) -> (Split, f32) {
        let (exact, cos_t) = fresnel::dielectric(cos, eta);
        if exact >= 1.0 || (self.plain && film.is_none()) {
            return (Split::new(exact, self.tint), cos_t);
        }
        // What is reflected within is what is reflected back along the same way.
        let outside = if eta == self.ior { cos } else { cos_t };
        let colors = self.face(film, outside, exact);
        (Split::by(colors, mean(colors), self.tint), cos_t)
    }

    /// The same of a thin sheet.
    #[inline]
    pub(super) fn split_thin(&self, cos: f32, film: Option<&ThinFilm>) -> Split {
        let (exact, _) = fresnel::dielectric(cos, self.ior);
        if self.plain && film.is_none() {
            return Split::new(fresnel::thin_sheet(exact), self.tint);
        }
        let colors = self.face(film, cos, exact).map(fresnel::thin_sheet);
        Split::by(colors, mean(colors), self.tint)
    }

    /// The reflectance of one face of light that meets it from outside at `cos`, given that of its
    /// index.
    fn face(&self, film: Option<&ThinFilm>, cos: f32, exact: f32) -> Vec3 {
        let bare = if self.plain {
            Vec3::splat(exact)
        } else {
            self.f0 + (Vec3::splat(self.f90) - self.f0) * self.grazing(cos, exact)
        };
        film.map_or(bare, |film| film.reflectance(cos, self.f0, bare))
    }

    /// How far the reflectance is on the way from normal incidence to grazing angles, 0 to 1.
    fn grazing(&self, cos: f32, exact: f32) -> f32 {
        if self.ior >= INFINITE_IOR {
            return fresnel::schlick_weight(cos);
        }
        let least = self.of_index();
        unit((exact - least) / (1.0 - least))
    }

    /// The reflectance of the index at normal incidence.
    fn of_index(&self) -> f32 {
        let root = (self.ior - 1.0) / (self.ior + 1.0);
        root * root
    }

    /// What makes up for the light that one bounce on a rough boundary loses.
    pub(super) fn gain(&self, albedo: GlassAlbedo) -> Vec3 {
        if self.plain {
            return Vec3::splat(1.0 / albedo.exact);
        }
        let least = self.of_index();
        let slope = if self.ior >= INFINITE_IOR {
            Vec3::ZERO
        } else {
            (Vec3::splat(self.f90) - self.f0) / (1.0 - least)
        };
        let constant = self.f0 - slope * least;
        let of = |constant, slope| 1.0 / albedo.of(constant, slope).clamp(0.1, 1.0);
        Vec3::new(of(constant.x, slope.x), of(constant.y, slope.y), of(constant.z, slope.z))
    }

    fn sample_smooth(&self, film: Option<&ThinFilm>, wo: Vec3, u_lobe: f32) -> BsdfSample {
        let eta = self.eta(wo);
        let (split, cos_t) = self.split(wo.z.abs(), eta, film);
        if u_lobe < split.choice {
            return mirror(wo, &split);
        }
        let inverse = 1.0 / eta;
        let pdf = 1.0 - split.choice;
        BsdfSample {
            wi: Vec3::new(-wo.x * inverse, -wo.y * inverse, -cos_t.copysign(wo.z)),
            weight: split.transmittance(self.tint) * (inverse * inverse / pdf),
            pdf,
            delta: true,
            eta,
        }
    }

    fn sample_thin(&self, film: Option<&ThinFilm>, wo: Vec3, u_lobe: f32) -> BsdfSample {
        let split = self.split_thin(wo.z.abs(), film);
        if u_lobe < split.choice {
            return mirror(wo, &split);
        }
        let pdf = 1.0 - split.choice;
        let weight = split.transmittance(self.tint) / pdf;
        BsdfSample { wi: -wo, weight, pdf, delta: true, eta: 1.0 }
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.tint
    }
}

fn mirror(wo: Vec3, split: &Split) -> BsdfSample {
    BsdfSample {
        wi: Vec3::new(-wo.x, -wo.y, wo.z),
        weight: split.reflectance / split.choice,
        pdf: split.choice,
        delta: true,
        eta: 1.0,
    }
}

#[cfg(test)]
mod tests {
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
        let once = glass(false).tint * (1.0 - reflectance);
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
        let reflected = |glass: &Dielectric, cos, eta| glass.split(cos, eta, None).0.reflectance;
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
        let sheet = of(1.0, color, true).split_thin(1.0, None).reflectance;
        let expected = (color * 0.04).map(fresnel::thin_sheet);
        assert!((sheet - expected).length() < 1e-6);
        // As materials that tell reflectances instead of an index are written.
        let told = SurfaceParams { ior: 0.0, ..SurfaceParams::default() };
        let told = SurfaceParams { specular_color: Vec3::splat(0.2), thin: true, ..told };
        let told = Dielectric::new(&told, BsdfForm::Conserving).split_thin(1.0, None);
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
