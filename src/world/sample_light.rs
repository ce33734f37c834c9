//! Sampling direct light: which light, and where on it.

use super::emitters::Emitter;
use super::lights::ChosenLight;
use super::surface::{offset_origin, triangle_point};
use super::{Surface, World};
use crate::light::{LightSampleContext, Punctual, area_to_solid_angle, sample_triangle};
use crate::math::{Ray, TriangleId, Vec2, Vec3};

/// What bounds the error of a segment's end, over the segment's length along each axis: 2^-22.
/// It is kept as its origin and the rounded way to its end, half a unit in the last place off, and
/// parted anew at each border that it passes. At a coordinate of zero, points themselves have no
/// error that would keep it off a light.
pub(super) const SEGMENT_ERROR: f32 = 2.0 * f32::EPSILON;

/// A light chosen for a point, and a direction to it.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Radiance that arrives if nothing is in between; irradiance where `delta`.
    pub radiance: Vec3,
    /// Density over solid angle, or the light's probability where `delta`; times one another.
    pub pdf: f32,
    /// Whether no other strategy could find the light, which has no extent.
    pub delta: bool,
    /// The segment that must be free.
    pub ray: Ray,
    /// The segment's end; `None`: infinitely far.
    pub end: Option<Vec3>,
}

impl World {
    /// Chooses a light and a direction to it, from a `surface` that is asked about as `context`
    /// tells: by `u_light` which light, by `u` where on it. `None` where nothing arrives from
    /// there.
    #[inline(always)]
    pub fn sample_light(
        &self,
        surface: &Surface,
        context: &LightSampleContext,
        u_light: f32,
        u: Vec2,
    ) -> Option<LightSample> {
        let (light, pmf, u) = self.lights.choose(context, u_light, u)?;
        match light {
            ChosenLight::Emitter(emitter) => self.sample_emitter(surface, emitter, pmf, u),
            ChosenLight::Punctual(light) => {
                sample_punctual(surface, &self.scene.light_at(light, surface.time)?, pmf)
            }
            ChosenLight::Environment => {
                let sample = self.scene.environment.as_ref()?.sample(u)?;
                Some(LightSample {
                    direction: sample.direction,
                    radiance: sample.radiance,
                    pdf: pmf * sample.pdf,
                    delta: false,
                    ray: surface.ray_towards(sample.direction),
                    end: None,
                })
            }
        }
    }

    /// What the environment sends along a ray that left the scene in a unit `direction`, and the
    /// density with which [`World::sample_light`] chooses that direction; zero without one.
    pub fn environment(&self, direction: Vec3) -> (Vec3, f32) {
        let Some(environment) = &self.scene.environment else { return (Vec3::ZERO, 0.0) };
        let (radiance, pdf) = environment.radiance_and_pdf(direction);
        (radiance, pdf * self.lights.environment_pmf())
    }

    /// What a `surface` sends back along a ray that hit it; `None` where it does not emit.
    #[inline]
    pub fn emitted_radiance(&self, surface: &Surface) -> Option<Vec3> {
        let material = self.material(surface.material);
        if material.unlit {
            // Found by following paths alone: it is no light, but looks its colour from everywhere.
            return Some(self.emission(surface.material, &surface.attributes));
        }
        if !material.is_emissive() || !(surface.front || material.double_sided) {
            return None;
        }
        Some(self.emission(surface.material, &surface.attributes))
    }

    /// The density over solid angle with which [`World::sample_light`] chooses for `context`, where
    /// a ray of unit `direction` began, the point of a `surface` that the ray hit at `distance`.
    pub fn emitter_pdf(
        &self,
        surface: &Surface,
        context: &LightSampleContext,
        direction: Vec3,
        distance: f32,
    ) -> f32 {
        if self.material(surface.material).unlit {
            return 0.0;
        }
        let pmf = self.lights.triangle_pmf(context, surface.instance, surface.triangle);
        let cosine = surface.normal.dot(direction);
        pmf * area_to_solid_angle(surface.area, distance * distance, cosine)
    }

    #[inline(always)]
    fn sample_emitter(
        &self,
        surface: &Surface,
        Emitter { instance, index, .. }: Emitter,
        pmf: f32,
        u: Vec2,
    ) -> Option<LightSample> {
        let id = TriangleId { instance, index };
        let triangle = self.triangles.of_at(id, surface.time);
        let sample = sample_triangle(&triangle, u);
        let towards = sample.point - surface.position;
        let distance2 = towards.length_squared();
        let direction = towards.try_normalize()?;
        let cosine = -sample.normal.dot(direction);
        let pdf = pmf * area_to_solid_angle(sample.area, distance2, cosine);
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None; // edge-on, or without area
        }
        let (material, at) =
            self.texture_point((instance, index as usize), sample.uv, surface.time);
        if cosine < 0.0 && !self.material(material).double_sided {
            return None;
        }
        let radiance = self.emission(material, &at) * self.coverage(material, &at);
        if radiance == Vec3::ZERO {
            return None;
        }
        // From beyond this surface to short of the light's, both by their errors.
        let (point, error) = triangle_point(&triangle, sample.uv.x, sample.uv.y, self.slack);
        let error = error + towards.abs() * SEGMENT_ERROR;
        let end = offset_origin(point, error, sample.normal, -direction);
        let ray = segment(surface, direction, end);
        Some(LightSample { direction, radiance, pdf, delta: false, ray, end: Some(end) })
    }
}

fn sample_punctual(surface: &Surface, light: &Punctual, pmf: f32) -> Option<LightSample> {
    let lit = light.illuminate(surface.position)?;
    let ray = match lit.origin {
        Some(end) => segment(surface, lit.direction, end),
        None => surface.ray_towards(lit.direction),
    };
    let (direction, radiance) = (lit.direction, lit.irradiance);
    Some(LightSample { direction, radiance, pdf: pmf, delta: true, ray, end: lit.origin })
}

/// From just beyond a surface to `end`.
#[inline(always)]
fn segment(surface: &Surface, direction: Vec3, end: Vec3) -> Ray {
    let origin = offset_origin(surface.position, surface.position_error, surface.normal, direction);
    Ray::new(origin, end - origin, 0.0, 1.0)
}
