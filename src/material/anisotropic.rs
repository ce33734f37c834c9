//! Brushed surfaces: glTF's opaque material with a stretched specular lobe
//! (KHR_materials_anisotropy), under a thin film or not.

use std::f32::consts::FRAC_1_PI;

use super::anisotropic_energy::Row;
use super::anisotropic_ggx::Lobe;
use super::form::BsdfForm;
use super::fresnel;
use super::ggx::MIN_ALPHA;
use super::metallic_roughness::{self, MetallicRoughness};
use super::params::{SurfaceParams, saturate};
use super::sample::{BsdfSample, is_above};
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Metal or coated base whose microfacets tilt more along one tangent than across it.
///
/// Along the tangent alpha is `mix(alpha, 1, strength²)`, across it alpha, as the specification
/// has it. In [`BsdfForm::Conserving`] energy is compensated as in [`MetallicRoughness`], with the
/// greatest albedo of any azimuth: a white surface reflects all light to 2%, and less at extreme
/// strengths.
#[derive(Clone, Copy, Debug)]
pub struct Anisotropic {
    surface: MetallicRoughness,
    lobe: Lobe,
    row: Row,
    /// Cosine and sine of the angle of the tangent.
    direction: Vec2,
    film: Option<FilmedReflectance>,
}

/// The reflectance of a film and of what is below it.
#[derive(Clone, Copy, Debug)]
struct FilmedReflectance {
    film: ThinFilm,
    /// Reflectances at normal incidence.
    coat: Vec3,
    metal: Vec3,
    metallic: f32,
}

impl Anisotropic {
    /// The opaque surface that `params` describe, brushed along the unit `direction`.
    pub fn new(params: &SurfaceParams, strength: f32, direction: Vec2, form: BsdfForm) -> Self {
        Self::with_metallic(params, saturate(params.metallic), strength, direction, form)
    }

    fn with_metallic(
        params: &SurfaceParams,
        metallic: f32,
        strength: f32,
        direction: Vec2,
        form: BsdfForm,
    ) -> Self {
        let roughness = saturate(params.roughness);
        let across = (roughness * roughness).max(MIN_ALPHA);
        let along = across + (1.0 - across) * strength * strength;
        let row = Row::of(along, across);
        let surface =
            MetallicRoughness::with_average(params, metallic, form, across, || row.average());
        Self { surface, lobe: Lobe { along, across }, row, direction, film: None }
    }

    /// The same under a film, with `metallic` in place of the parameter.
    pub fn with_film(
        params: &SurfaceParams,
        metallic: f32,
        (strength, direction): (f32, Vec2),
        film: ThinFilm,
        form: BsdfForm,
    ) -> Self {
        let mut made = Self::with_metallic(params, metallic, strength, direction, form);
        let coat = metallic_roughness::coat_f0(params);
        let filmed = FilmedReflectance { film, coat, metal: params.base_color, metallic };
        let (bound, average) = filmed.fit_schlick();
        let from_above = filmed.reflectance(1.0);
        let albedo = made.row.average();
        made.surface =
            made.surface.with_reflectance(from_above, bound, (metallic, average), albedo);
        made.film = Some(filmed);
        made
    }

    /// The specular lobe's colour, for the cosine at the half vector.
    fn reflectance(&self, along: f32, weight: f32) -> Vec3 {
        match &self.film {
            None => self.surface.fresnel(weight),
            Some(filmed) => filmed.reflectance(along),
        }
    }

    /// From the local frame to that of the brush strokes, whose X runs along them.
    fn to_brush_frame(self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.direction;
        Vec3::new(cos * w.x + sin * w.y, cos * w.y - sin * w.x, w.z)
    }

    /// From the frame of the brush strokes to the local one.
    fn to_local_frame(self, w: Vec3) -> Vec3 {
        let Vec2 { x: cos, y: sin } = self.direction;
        Vec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
    }

    /// See [`super::Bsdf::eval`].
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        // A lobe that is symmetric about both tangents looks the same from behind.
        let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
        if !(is_above(wo.z) && is_above(wi.z)) {
            return (Vec3::ZERO, 0.0);
        }
        let (wo, wi) = (self.to_brush_frame(wo), self.to_brush_frame(wi));
        let h = (wo + wi).normalize();
        let along = wo.dot(h);
        let weight = fresnel::schlick_weight(along);
        let (visible, reflected) = self.lobe.eval(h, wo, wi);
        let view = self.row.at(wo.z);
        let smooth = self.surface.smooth(weight, view, || self.row.at(wi.z));
        let value = (smooth * FRAC_1_PI + self.reflectance(along, weight) * reflected) * wi.z;
        let choice = self.surface.specular_probability(view);
        (value, choice * visible * 0.5 + (1.0 - choice) * wi.z * FRAC_1_PI)
    }

    /// See [`super::Bsdf::sample`].
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let above = wo * side;
        if !is_above(above.z) {
            return None;
        }
        let wi = if u_lobe < self.surface.specular_probability(self.row.at(above.z)) {
            let wo = self.to_brush_frame(above);
            let h = self.lobe.sample_visible_normal(wo, u);
            self.to_local_frame(h * (2.0 * wo.dot(h)) - wo)
        } else {
            warp::cosine_hemisphere(u)
        };
        if !is_above(wi.z) {
            return None;
        }
        let (value, pdf) = self.eval(above, wi);
        BsdfSample::from_value(wi * side, value, pdf, 1.0)
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        self.surface.albedo()
    }
}

impl FilmedReflectance {
    /// The reflectances under the film of the dielectric and of the metal.
    fn reflectances(&self, cos: f32) -> (Vec3, Vec3) {
        let weight = fresnel::schlick_weight(cos);
        let of = |f0: Vec3| self.film.reflectance(cos, f0, f0 + (Vec3::ONE - f0) * weight);
        let coat = if self.metallic < 1.0 { of(self.coat) } else { Vec3::ZERO };
        let metal = if self.metallic > 0.0 { of(self.metal) } else { Vec3::ZERO };
        (coat, metal)
    }

    fn reflectance(&self, cos: f32) -> Vec3 {
        let (coat, metal) = self.reflectances(cos);
        coat * (1.0 - self.metallic) + metal * self.metallic
    }

    /// The least `f0` with which Schlick's term is as bright as the dielectric's share at all
    /// angles, and the metal's average over the hemisphere; both from a few angles.
    fn fit_schlick(&self) -> (f32, Vec3) {
        const STEPS: usize = 8;
        let (mut bound, mut average) = (0.0_f32, Vec3::ZERO);
        for step in 0..STEPS {
            // Evenly by the square of the cosine, as light from everywhere falls.
            let cos = ((step as f32 + 0.5) / STEPS as f32).sqrt();
            let (coat, metal) = self.reflectances(cos);
            let weight = fresnel::schlick_weight(cos);
            bound = bound.max((coat.max_element() - weight) / (1.0 - weight));
            average += metal / STEPS as f32;
        }
        (bound.min(1.0), average)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rough along X: light from above spreads further that way.
    #[test]
    fn the_highlight_is_stretched_along_the_direction() {
        let params = SurfaceParams { metallic: 1.0, roughness: 0.3, ..SurfaceParams::default() };
        let direction = Vec2::new(0.6, 0.8);
        let brushed = Anisotropic::new(&params, 0.7, direction, BsdfForm::Conserving);
        let towards = |way: Vec2| {
            let wi = (way * 0.5).extend(libm::sqrtf(0.75));
            brushed.eval(Vec3::Z, wi).0.x
        };
        assert!(towards(direction) > 4.0 * towards(Vec2::new(-0.8, 0.6)));
    }
}
