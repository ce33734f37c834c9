//! Glass with a rough boundary: GGX microfacets that reflect and refract.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. In
//! [`BsdfForm::Conserving`] both lobes are divided by their common albedo for the direction of view
//! (after Turquin, "Practical multiple scattering compensation for microfacet models", 2019): no
//! light is lost, at the price of reciprocity.

use super::boundary::Boundary;
use super::energy::{self, Albedos, Row};
use super::form::BsdfForm;
use super::ggx;
use super::sample::{BsdfSample, is_above};
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};

/// See [`super::Bsdf::eval`].
#[inline]
pub fn eval_solid(glass: &Boundary, film: Option<&ThinFilm>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let eta = glass.eta(wo);
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    if !(is_above(wo.z) && is_above(wi.z.abs())) {
        return (Vec3::ZERO, 0.0);
    }
    let h = if wi.z > 0.0 { wo + wi } else { wo + wi * eta };
    let Some(h) = h.try_normalize() else { return (Vec3::ZERO, 0.0) };
    let h = if h.z < 0.0 { -h } else { h };
    evaluate_solid(glass, film, eta, wo, wi, h)
}

/// See [`super::Bsdf::sample`].
#[inline]
pub fn sample_solid(
    glass: &Boundary,
    film: Option<&ThinFilm>,
    wo: Vec3,
    u_lobe: f32,
    u: Vec2,
) -> Option<BsdfSample> {
    let eta = glass.eta(wo);
    let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
    let wo = wo * side;
    let h = ggx::sample_visible_normal(wo, glass.alpha, u);
    let along = wo.dot(h);
    let (split, cos_t) = glass.split(along, eta, film);
    let reflects = u_lobe < split.reflection_probability;
    let wi = if reflects {
        h * (2.0 * along) - wo
    } else {
        (h * (along / eta - cos_t) - wo * (1.0 / eta)).normalize()
    };
    if (wi.z > 0.0) != reflects || !is_above(wi.z.abs()) {
        return None;
    }
    let (value, pdf) = evaluate_solid(glass, film, eta, wo, wi, h);
    let eta = if reflects { 1.0 } else { eta };
    BsdfSample::from_value(wi * side, value, pdf, eta)
}

/// For `wo` and the half vector `h` above the surface.
#[inline]
fn evaluate_solid(
    glass: &Boundary,
    film: Option<&ThinFilm>,
    eta: f32,
    wo: Vec3,
    wi: Vec3,
    h: Vec3,
) -> (Vec3, f32) {
    let (along_o, along_i) = (wo.dot(h), wi.dot(h));
    // Facets seen from behind.
    if !(along_o > 0.0 && along_i * wi.z > 0.0) {
        return (Vec3::ZERO, 0.0);
    }
    let (split, _) = glass.split(along_o, eta, film);
    let lobe = ggx::Lobe::new(h, wo.z, wi.z.abs(), glass.alpha);
    let gain = match glass.form {
        BsdfForm::AppendixB => Vec3::ONE,
        BsdfForm::Conserving => glass.compensation(energy::rough_glass(glass.alpha, wo.z, eta)),
    };
    if wi.z > 0.0 {
        let value = split.reflectance * gain * (lobe.reflected * wi.z);
        (value, split.reflection_probability * lobe.visible * 0.5)
    } else {
        let denominator = along_o + eta * along_i;
        let spread = 2.0 * along_o * along_i.abs() / (denominator * denominator);
        let scattered = 2.0 * spread * lobe.reflected * wi.z.abs();
        let value = split.transmittance(glass.tint) * gain * scattered;
        // Radiance is denser behind the boundary: the value lacks the factor eta² of the density.
        (value, (1.0 - split.reflection_probability) * spread * lobe.visible * eta * eta)
    }
}

/// See [`super::Bsdf::eval`]. What passes is the mirror image of what is reflected.
#[inline]
pub fn eval_thin(glass: &Boundary, film: Option<&ThinFilm>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    if !(is_above(wo.z) && is_above(wi.z.abs())) {
        return (Vec3::ZERO, 0.0);
    }
    let mirrored = Vec3::new(wi.x, wi.y, wi.z.abs());
    evaluate_thin(glass, film, wo, mirrored, (wo + mirrored).normalize(), wi.z > 0.0)
}

/// See [`super::Bsdf::sample`].
#[inline]
pub fn sample_thin(
    glass: &Boundary,
    film: Option<&ThinFilm>,
    wo: Vec3,
    u_lobe: f32,
    u: Vec2,
) -> Option<BsdfSample> {
    let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
    let wo = wo * side;
    let h = ggx::sample_visible_normal(wo, glass.alpha, u);
    let along = wo.dot(h);
    let mirrored = h * (2.0 * along) - wo;
    if !is_above(mirrored.z) {
        return None;
    }
    let reflects = u_lobe < glass.split_thin(along, film).reflection_probability;
    let (value, pdf) = evaluate_thin(glass, film, wo, mirrored, h, reflects);
    let wi = if reflects { mirrored } else { Vec3::new(mirrored.x, mirrored.y, -mirrored.z) };
    BsdfSample::from_value(wi * side, value, pdf, 1.0)
}

#[inline]
fn evaluate_thin(
    glass: &Boundary,
    film: Option<&ThinFilm>,
    wo: Vec3,
    mirrored: Vec3,
    h: Vec3,
    reflects: bool,
) -> (Vec3, f32) {
    let split = glass.split_thin(wo.dot(h), film);
    let lobe = ggx::Lobe::new(h, wo.z, mirrored.z, glass.alpha);
    let albedo = Albedos::get().at(Row::of(glass.alpha), wo.z);
    let scattered = lobe.reflected * mirrored.z / (1.0 - albedo.loss());
    let density = lobe.visible * 0.5;
    if reflects {
        (split.reflectance * scattered, split.reflection_probability * density)
    } else {
        (
            split.transmittance(glass.tint) * scattered,
            (1.0 - split.reflection_probability) * density,
        )
    }
}
