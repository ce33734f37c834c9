//! Glass with a rough boundary: GGX microfacets that reflect and refract.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. In
//! [`BsdfForm::Conserving`] there is a third lobe, of what they lose: see
//! [`super::glass_multiple`].

use super::boundary::{Boundary, Split};
use super::cover::{Cover, kept_at};
use super::form::BsdfForm;
use super::ggx;
use super::glass_multiple::Multiple;
use super::sample::{BsdfSample, is_above};
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};
use crate::sampling::ONE_MINUS_EPSILON;

/// See [`super::Bsdf::eval`].
#[inline]
pub fn eval_solid(glass: &Boundary, cover: Cover<'_>, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
    let (eta, cover) = (glass.eta(wo), cover.seen_from(wo));
    let (wo, wi) = if wo.z < 0.0 { (-wo, -wi) } else { (wo, wi) };
    if !(is_above(wo.z) && is_above(wi.z.abs())) {
        return (Vec3::ZERO, 0.0);
    }
    let h = if wi.z > 0.0 { wo + wi } else { wo + wi * eta };
    let h = h.normalize_or_zero();
    let h = if h.z < 0.0 { -h } else { h };
    let multiple = multiple_of_solid(glass, eta, wo);
    together(evaluate_solid(glass, cover, eta, wo, wi, h), multiple.as_ref(), wi)
}

/// What a solid scatters more than once.
#[inline]
fn multiple_of_solid(glass: &Boundary, eta: f32, wo: Vec3) -> Option<Multiple<'_>> {
    let conserving = glass.form == BsdfForm::Conserving;
    conserving.then(|| Multiple::of_solid(glass, eta, wo.z))
}

/// Values and densities of what is scattered once and of what is scattered more often.
#[inline]
fn together(once: (Vec3, f32), multiple: Option<&Multiple<'_>>, wi: Vec3) -> (Vec3, f32) {
    let Some(multiple) = multiple else { return once };
    let again = multiple.eval(wi.z);
    (once.0 + again.0, once.1 * (1.0 - multiple.probability) + again.1)
}

/// Whether `u_lobe` chooses the lobe of what is scattered more than once, and what is left of it.
#[inline]
fn choose(multiple: Option<&Multiple<'_>>, u_lobe: f32) -> (bool, f32) {
    let share = multiple.map_or(0.0, |multiple| multiple.probability);
    let rest = if u_lobe < share { u_lobe / share } else { (u_lobe - share) / (1.0 - share) };
    (u_lobe < share, rest.clamp(0.0, ONE_MINUS_EPSILON))
}

/// See [`super::Bsdf::sample`].
#[inline]
pub fn sample_solid(
    glass: &Boundary,
    cover: Cover<'_>,
    wo: Vec3,
    u_lobe: f32,
    u: Vec2,
) -> Option<BsdfSample> {
    let (eta, seen) = (glass.eta(wo), cover.seen_from(wo));
    let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
    let wo = wo * side;
    let multiple = multiple_of_solid(glass, eta, wo);
    let (again, u_lobe) = choose(multiple.as_ref(), u_lobe);
    if let Some(multiple) = multiple.as_ref().filter(|_| again) {
        let wi = multiple.sample(u_lobe, u);
        let (value, pdf) = eval_solid(glass, cover, wo * side, wi * side);
        return BsdfSample::from_value(wi * side, value, pdf, if wi.z > 0.0 { 1.0 } else { eta });
    }
    let h = ggx::sample_visible_normal(wo, glass.alpha, u);
    let along = wo.dot(h);
    let (split, cos_t) = split_facet(glass, seen, eta, wo, h);
    let reflects = u_lobe < split.reflection_probability;
    let wi = if reflects {
        h * (2.0 * along) - wo
    } else {
        (h * (along / eta - cos_t) - wo * (1.0 / eta)).normalize()
    };
    if (wi.z > 0.0) != reflects || !is_above(wi.z.abs()) {
        return None;
    }
    let once = evaluate_solid(glass, seen, eta, wo, wi, h);
    let (value, pdf) = together(once, multiple.as_ref(), wi);
    let eta = if reflects { 1.0 } else { eta };
    BsdfSample::from_value(wi * side, value, pdf, eta)
}

/// How a facet divides light, and the cosine of what it refracts to it.
#[inline]
fn split_facet(glass: &Boundary, cover: Cover<'_>, eta: f32, wo: Vec3, h: Vec3) -> (Split, f32) {
    let along = wo.dot(h);
    let (split, cos_t) = glass.split(along, eta, cover.film);
    match cover.kept {
        None => (split, cos_t),
        Some(kept) => {
            let leaving = leaving_cos(wo.z, h.z, along, eta, cos_t);
            (split.below(kept_at(kept, leaving), glass.tint), cos_t)
        }
    }
}

/// The cosine at the surface at which light leaves by a facet; negative where it does not. Its own
/// cosine is `cos`, `along` that to the facet's normal, whose cosine is `facet`.
#[inline]
pub(super) fn leaving_cos(cos: f32, facet: f32, along: f32, eta: f32, cos_t: f32) -> f32 {
    cos / eta - (along / eta - cos_t) * facet
}

/// For `wo` and the half vector `h` above the surface.
#[inline]
fn evaluate_solid(
    glass: &Boundary,
    cover: Cover<'_>,
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
    let (split, cos_t) = split_facet(glass, cover, eta, wo, h);
    let lobe = ggx::Lobe::new(h, wo.z, wi.z.abs(), glass.alpha);
    if wi.z > 0.0 {
        let mut reflectance = split.reflectance;
        if let Some(kept) = cover.kept {
            let [o, i] = [wo, wi].map(|w| leaving_cos(w.z, h.z, along_o, eta, cos_t));
            if o.min(i) > 0.0 {
                let unmasked = ggx::masking(o.min(i), glass.alpha * glass.alpha);
                let thrown_back = kept_at(kept, o.max(i)) * unmasked;
                reflectance += split.transmittance(glass.tint) * glass.tint * thrown_back;
            }
        }
        let value = reflectance * (lobe.reflected * wi.z);
        (value, split.reflection_probability * lobe.visible * 0.5)
    } else {
        let denominator = along_o + eta * along_i;
        let spread = 2.0 * along_o * along_i.abs() / (denominator * denominator);
        let scattered = 2.0 * spread * lobe.reflected * wi.z.abs();
        let value = split.transmittance(glass.tint) * scattered;
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
    let once = evaluate_thin(glass, film, wo, mirrored, (wo + mirrored).normalize(), wi.z > 0.0);
    together(once, Some(&Multiple::of_sheet(glass, wo.z)), wi)
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
    let multiple = Multiple::of_sheet(glass, wo.z);
    let (again, u_lobe) = choose(Some(&multiple), u_lobe);
    if again {
        let wi = multiple.sample(u_lobe, u);
        let (value, pdf) = eval_thin(glass, film, wo * side, wi * side);
        return BsdfSample::from_value(wi * side, value, pdf, 1.0);
    }
    let h = ggx::sample_visible_normal(wo, glass.alpha, u);
    let along = wo.dot(h);
    let mirrored = h * (2.0 * along) - wo;
    if !is_above(mirrored.z) {
        return None;
    }
    let reflects = u_lobe < glass.split_thin(along, film).reflection_probability;
    let once = evaluate_thin(glass, film, wo, mirrored, h, reflects);
    let wi = if reflects { mirrored } else { Vec3::new(mirrored.x, mirrored.y, -mirrored.z) };
    let (value, pdf) = together(once, Some(&multiple), wi);
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
    let scattered = lobe.reflected * mirrored.z;
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
