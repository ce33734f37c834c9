//! The boundary of glass: what it reflects and what it lets through.

use super::form::BsdfForm;
use super::fresnel;
use super::glass_energy::GlassAlbedo;
use super::lanes;
use super::metallic_roughness::coat_f0;
use super::params::{SurfaceParams, saturate};
use super::sample::mean;
use super::thin_film::ThinFilm;
use crate::math::Vec3;
use crate::simd::lanes::Scalar;

/// Up to this roughness a boundary is taken as smooth.
const SMOOTH: f32 = 0.02;

/// Stands for the infinite index that KHR_materials_ior writes as 0.
pub(super) const INFINITE_IOR: f32 = 1e4;

/// The boundary of a dielectric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boundary {
    /// Colour of the light that passes.
    pub tint: Vec3,
    /// Index of the inside over that of the outside.
    pub ior: f32,
    /// GGX's alpha, where it is rough.
    pub alpha: f32,
    pub form: BsdfForm,
    /// Which of the four models it follows.
    pub kind: Kind,
    /// Whether reflectances are those of the index.
    pub plain: bool,
    /// One face's reflectance at normal incidence and, of all colours, at grazing angles.
    f0: Vec3,
    f90: f32,
}

/// A solid or a thin sheet, smooth or rough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A solid that mirrors and refracts.
    Smooth,
    /// A solid with microfacets.
    Rough,
    /// A sheet that mirrors and lets light pass straight.
    ThinSmooth,
    /// A sheet with microfacets.
    ThinRough,
}

/// How a boundary divides light into reflected and transmitted light, for one direction of view.
pub struct Split {
    /// By colour.
    pub reflectance: Vec3,
    /// The probability with which the reflection is sampled.
    pub reflection_probability: f32,
}

impl Split {
    #[inline]
    fn new(reflectance: f32, tint: Vec3) -> Self {
        Self::colored(Vec3::splat(reflectance), reflectance, tint)
    }

    #[inline]
    fn colored(colors: Vec3, reflectance: f32, tint: Vec3) -> Self {
        let reflection_probability =
            lanes::reflection_probability(Scalar, reflectance, tint.into());
        Self { reflectance: colors, reflection_probability }
    }

    /// The same where a share of what passes is thrown back: then it is tinted again.
    pub fn below(self, kept: f32, tint: Vec3) -> Self {
        let passes = self.transmittance(tint);
        let back = mean(self.reflectance + passes * tint * kept);
        let all = back + mean(passes) * (1.0 - kept);
        let reflection_probability = if all > 0.0 { back / all } else { 0.0 };
        Self { reflection_probability, ..self }
    }

    /// Tinted share of the light that passes.
    #[inline]
    pub fn transmittance(&self, tint: Vec3) -> Vec3 {
        tint * (Vec3::ONE - self.reflectance)
    }
}

impl Boundary {
    /// The clear part of what `params` describe.
    pub fn new(params: &SurfaceParams, form: BsdfForm) -> Self {
        let usable = params.ior.is_finite() && params.ior > 1e-3;
        let ior = if usable { params.ior.min(INFINITE_IOR) } else { INFINITE_IOR };
        let roughness = saturate(params.roughness);
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
            f90: saturate(params.specular),
        }
    }

    /// Index on the far side over that on the side of `wo`.
    #[inline]
    pub fn eta(&self, wo: Vec3) -> f32 {
        if wo.z < 0.0 { 1.0 / self.ior } else { self.ior }
    }

    /// Divides light that meets the boundary of a solid, or a facet of it, at that cosine. Returns
    /// the cosine of the refracted ray too.
    #[inline]
    pub fn split(&self, cos: f32, eta: f32, film: Option<&ThinFilm>) -> (Split, f32) {
        let (exact, cos_t) = fresnel::dielectric(cos, eta);
        if exact >= 1.0 || (self.plain && film.is_none()) {
            return (Split::new(exact, self.tint), cos_t);
        }
        // What is reflected within is what is reflected back along the same way.
        let outside = if eta == self.ior { cos } else { cos_t };
        let colors = self.face(film, outside, exact);
        (Split::colored(colors, mean(colors), self.tint), cos_t)
    }

    /// Divides light that meets a thin sheet.
    #[inline]
    pub fn split_thin(&self, cos: f32, film: Option<&ThinFilm>) -> Split {
        let (exact, _) = fresnel::dielectric(cos, self.ior);
        if self.plain && film.is_none() {
            return Split::new(fresnel::thin_sheet(exact), self.tint);
        }
        let colors = self.face(film, cos, exact).map(fresnel::thin_sheet);
        Split::colored(colors, mean(colors), self.tint)
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
        let least = self.f0_of_index();
        saturate((exact - least) / (1.0 - least))
    }

    /// The reflectance of the index at normal incidence.
    fn f0_of_index(&self) -> f32 {
        let root = (self.ior - 1.0) / (self.ior + 1.0);
        root * root
    }

    /// What one bounce on a rough boundary loses, by colour.
    pub fn loss(&self, albedo: GlassAlbedo) -> Vec3 {
        let left = |albedo: f32| (1.0 - albedo).clamp(0.0, 1.0);
        if self.plain {
            return Vec3::splat(left(albedo.exact));
        }
        let [constant, slope] = self.linear_in_exact();
        let of = |constant, slope| left(albedo.of(constant, slope));
        Vec3::new(of(constant.x, slope.x), of(constant.y, slope.y), of(constant.z, slope.z))
    }

    /// The reflectance by colour as a constant, and a factor of that of the index.
    fn linear_in_exact(&self) -> [Vec3; 2] {
        let least = self.f0_of_index();
        let slope = if self.ior >= INFINITE_IOR {
            Vec3::ZERO
        } else {
            (Vec3::splat(self.f90) - self.f0) / (1.0 - least)
        };
        [self.f0 - slope * least, slope]
    }

    /// The same where it is not that of the index.
    pub fn told(&self) -> Option<[Vec3; 2]> {
        (!self.plain).then(|| self.linear_in_exact())
    }

    /// The same boundary with the reflectances of its index.
    pub fn as_plain(&self) -> Self {
        Self { plain: true, ..*self }
    }

    /// About the share of light from everywhere that passes the boundary of a solid, by colour;
    /// `eta` is the index beyond it over that before it. From the denser side it is less by the
    /// square of the index, exactly.
    pub fn average_transmittance(&self, eta: f32) -> Vec3 {
        let passes = Vec3::ONE - self.average_reflectance();
        if eta < 1.0 { passes * (eta * eta) } else { passes }
    }

    /// The same of a thin sheet.
    pub fn average_transmittance_of_sheet(&self) -> Vec3 {
        Vec3::ONE - self.average_reflectance().map(fresnel::thin_sheet)
    }

    /// About the average reflectance of one face on its less dense side, by colour: the fit of
    /// Kulla and Conty (2017) to that of the index, and what the colours make of it.
    fn average_reflectance(&self) -> Vec3 {
        let dense = self.ior.max(1.0 / self.ior);
        let plain = saturate((dense - 1.0) / (4.085_67 + 1.000_71 * dense));
        if self.plain {
            return Vec3::splat(plain);
        }
        let least = self.f0_of_index();
        let grazing = if self.ior >= INFINITE_IOR {
            1.0 / 21.0
        } else {
            saturate((plain - least) / (1.0 - least))
        };
        self.f0 + (Vec3::splat(self.f90) - self.f0) * grazing
    }
}
