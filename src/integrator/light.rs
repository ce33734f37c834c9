//! The light that reaches a vertex: met by the path itself, or by a shadow ray. Each way is weighed
//! by the density with which the other would have found the same light.

use super::borders::interior_beyond;
use super::crossing::classify_crossing;
use super::dimensions::light_dimension;
use super::interior::Interior;
use super::leaving::segment_to;
use super::mis::power_heuristic;
use super::state::{Direct, Path, PathSample, ShadowRay};
use super::transit::{Shine, Transit};
use crate::light::LightSampleContext;
use crate::material::Bsdf;
use crate::math::{Ray, Vec3};
use crate::world::{LightSample, Surface, World};

/// Adds the light of the environment to a path whose ray leaves the scene.
pub fn add_environment(world: &World, path: &Path, ray: &Ray, sample: &mut PathSample) {
    if world.scene.environment.is_some() {
        let (radiance, pdf) = world.environment(ray.direction());
        let weight = power_heuristic(path.pdf, pdf);
        // In a scene with media, the flight has taken its share already.
        let reaching = if world.has_media() {
            Vec3::ONE
        } else {
            world.transmittance(path.interior.solid(), f32::INFINITY)
        };
        sample.radiance += path.throughput * reaching * radiance * weight;
    }
}

/// Adds the light that a surface emits towards the path, which has met it at `distance`.
#[inline(always)]
pub fn add_emission(
    world: &World,
    path: &Path,
    surface: &Surface,
    (ray, distance): (&Ray, f32),
    sample: &mut PathSample,
) {
    if let Some(radiance) = world.emitted_radiance(surface) {
        let light_pdf = || world.emitter_pdf(surface, &path.context, ray.direction(), distance);
        let weight =
            if path.pdf == f32::INFINITY { 1.0 } else { power_heuristic(path.pdf, light_pdf()) };
        sample.radiance += path.throughput * radiance * weight;
    }
}

/// Whether light that sets out in an interior must look for borders that might let it pass.
#[inline(always)]
pub fn looks_for_borders(world: &World, interior: Interior) -> bool {
    world.has_media() && (world.has_passable_borders() || !passes_freely(world, interior))
}

/// Whether light gets through that interior as it is, meeting no border that might let it pass.
fn passes_freely(world: &World, interior: Interior) -> bool {
    interior.is_air() && world.medium(interior.solid()).is_none()
}

/// Samples a light, chosen by `u_light`, and what of it would reach the camera by way of this
/// vertex, the end of segment number `depth`.
#[inline(always)]
pub fn sample_direct(
    world: &World,
    depth: u32,
    path: &mut Path,
    (surface, bsdf): (&Surface, &Bsdf),
    wo: Vec3,
    u_light: f32,
) -> Option<Direct> {
    let u = path.stream.at(light_dimension(depth)).next_2d();
    let light = world.sample_light(surface, &path.context, u_light, u)?;
    let wi = surface.frame.to_local(light.direction);
    let robust = world.has_robust_normals();
    let crossing = classify_crossing(surface, light.direction, wo, wi, robust)?;
    let (scattered, pdf) = bsdf.eval(wo, wi);
    if scattered == Vec3::ZERO {
        return None;
    }
    let ray = segment_to(world, surface, &light, crossing)?;
    let interior = interior_beyond(world, path.interior, surface, crossing);
    if looks_for_borders(world, interior) {
        let (light, scattered) = (LightSample { ray, ..light }, path.throughput * scattered);
        let transit = Transit::new(&Shine { light, scattered, pdf }, interior, path.densities);
        return transit.map(Direct::Transit);
    }
    let weight = if light.delta { 1.0 } else { power_heuristic(light.pdf, pdf) };
    let radiance = path.throughput * scattered * light.radiance * (weight / light.pdf);
    shadow_ray(world, interior, ray, radiance)
}

/// The light of that radiance by way of a free segment in an interior.
#[inline(always)]
pub fn shadow_ray(
    world: &World,
    interior: Interior,
    ray: Ray,
    mut radiance: Vec3,
) -> Option<Direct> {
    if !interior.is_air() {
        radiance *= world.transmittance(interior.solid(), length(&ray));
    }
    (radiance != Vec3::ZERO).then_some(Direct::Ray(ShadowRay { ray, radiance }))
}

/// Where and from which side a surface takes light: from both where it transmits.
#[inline(always)]
pub fn light_sample_context(world: &World, surface: &Surface, bsdf: &Bsdf) -> LightSampleContext {
    let above = if world.has_robust_normals() { surface.frame.normal } else { surface.normal };
    let normal = match (bsdf.transmits(), surface.front) {
        (true, _) => Vec3::ZERO,
        (false, true) => above,
        (false, false) => -above,
    };
    LightSampleContext { position: surface.position, normal }
}

/// Metres from a ray's origin to its end.
fn length(ray: &Ray) -> f32 {
    if ray.t_max() < f32::INFINITY { ray.direction().length() * ray.t_max() } else { f32::INFINITY }
}
