//! One path alone, described step by step: to find out why a sample is what it is.

use std::fmt::Write;

use super::settings::Settings;
use super::stream::ray_key;
use super::trace::{find_hits, interior_around};
use crate::accel::{Accel, AnyHit, Batch, ClosestHit, HitFilter, Tracer};
use crate::camera::Camera;
use crate::integrator::{FirstHit, PathSample, PathTracer, Transit, Transits};
use crate::math::{Ray, Vec3};
use crate::world::{AlphaFilter, World};

/// Follows the path of one sample of the pixel at column `x`, row `y` of the frame, exactly as
/// [`super::render`] would, and describes it: a line for each segment, what it hit, what that emits
/// and the shadow ray, and last what the sample adds to albedo, normal and radiance.
pub fn replay(
    world: &World,
    camera: &Camera,
    accel: &dyn Accel,
    settings: &Settings,
    (x, y, sample): (u32, u32, u64),
) -> String {
    let integrator = PathTracer::new(world, settings.transport);
    let mut tracer = accel.tracer();
    let rays = camera.rays(settings.aspect());
    let (mut ray, mut path) = settings.start(&rays, x, y, sample, 0);
    if world.has_media() {
        path.start_in(interior_around(world, &mut *tracer, rays.centre()));
    }
    if world.has_levels() {
        path.set_cone(camera.pixel_cone(settings.resolution.1));
    }
    let mut result = PathSample::default();
    let mut text = format!("pixel {x},{y} sample {sample} seed {}\n", settings.seed);
    let (mut depth, mut hit) = (1, Vec::new());
    loop {
        let keys = [ray_key(path.key, 2 * depth)];
        find_hits(world, &mut *tracer, (&[ray], &keys), None, &mut hit);
        let throughput = path.throughput();
        push_line(
            &mut text,
            &format!("segment {depth}: {}, throughput {throughput:?}", format_ray(&ray)),
        );
        if world.has_levels() {
            path.widen(hit[0].t);
        }
        describe_hit(&mut text, world, &ray, &hit[0], path.width());

        let before = result.radiance;
        let step = integrator.advance(depth, &mut path, &ray, &hit[0], &mut result);
        if result.radiance != before {
            let found = result.radiance - before;
            push_line(&mut text, &format!("  light found: {found:?}"));
        }
        if let Some(shadow) = step.shadow {
            let keys = [ray_key(path.key, 2 * depth + 1)];
            let filter = AlphaFilter::new(world, &keys);
            let filter = world.is_see_through().then_some(&filter as &dyn HitFilter);
            let mut blocked = [AnyHit(false)];
            tracer.any_hits(&Batch::new(&[shadow.ray]).with_filter(filter), &mut blocked);
            let state = if blocked[0].0 { "blocked" } else { "free" };
            let what = format!("  shadow ray {}, {state}", format_ray(&shadow.ray));
            push_line(&mut text, &format!("{what}: {:?}", shadow.radiance));
            if !blocked[0].0 {
                result.radiance += shadow.radiance;
            }
        }
        if let Some(transit) = step.transit {
            let key = ray_key(path.key, 2 * depth + 1);
            result.radiance += follow_light(&mut text, world, &mut *tracer, key, transit);
        }
        let Some(next) = step.next else { break };
        (ray, depth) = (next, depth + 1);
    }
    if let Some(first) = &result.first {
        let FirstHit { albedo, normal, .. } = first;
        push_line(&mut text, &format!("albedo {albedo:?}, normal {normal:?}"));
    }
    push_line(&mut text, &format!("radiance {:?}", result.radiance));
    text
}

/// Takes light through borders, describes its way, and returns what arrives.
fn follow_light(
    text: &mut String,
    world: &World,
    tracer: &mut dyn Tracer,
    key: u64,
    transit: Transit,
) -> Vec3 {
    let (mut transits, mut hit) = (Transits::default(), Vec::new());
    let mut arrived = Vec3::ZERO;
    transits.push(0, key, transit);
    while let [ray] = *transits.rays {
        find_hits(world, tracer, (&[ray], &transits.keys), None, &mut hit);
        push_line(text, &format!("  light along {}", format_ray(&ray)));
        transits.cross(world, &hit, |_, radiance| arrived += radiance);
    }
    push_line(text, &format!("  arrives: {arrived:?}"));
    arrived
}

fn describe_hit(text: &mut String, world: &World, ray: &Ray, hit: &ClosestHit, width: f32) {
    if !hit.is_hit() {
        push_line(text, "  hit nothing");
        return;
    }
    let surface = world.surface(ray, hit, width);
    let material = world.material(surface.material);
    let side = if surface.front { "front" } else { "back" };
    let head =
        format!("  hit triangle {} at t = {:?}", world.triangles.number_of(hit.triangle), hit.t);
    let place = format!("{side} of {:?} at {:?}", material.name, surface.position);
    let normals = format!("normal {:?}, shading {:?}", surface.normal, surface.frame.normal);
    push_line(text, &format!("{head}: {place}, {normals}"));
    push_line(text, &format!("  {:?}", world.bsdf(&surface, hit)));
}

fn format_ray(ray: &Ray) -> String {
    format!("from {:?} towards {:?}", ray.origin(), ray.direction())
}

fn push_line(text: &mut String, line: &str) {
    writeln!(text, "{line}").expect("a string takes all");
}
