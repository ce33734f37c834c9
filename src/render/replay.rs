//! One path alone, described step by step: to find out why a sample is what it is.

use std::fmt::Write;

use super::settings::Settings;
use super::stream::ray_key;
use super::trace::{Slice, find_blocked, find_hits, start_inside};
use crate::accel::{Accel, ClosestHit, Tracer};
use crate::camera::moving::MovingCamera;
use crate::integrator::{FirstHit, Path, PathSample, PathTracer, Transit, Transits};
use crate::math::{Ray, Vec3};
use crate::world::World;

/// Follows the path of one sample of the pixel at column `x`, row `y` of the frame, exactly as
/// [`super::render`] would, and describes it: a line for each segment, what it hit, what that emits
/// and the shadow ray, and last what the sample adds to albedo, normal and radiance.
pub fn replay(
    world: &World,
    camera: impl Into<MovingCamera>,
    accel: &dyn Accel,
    settings: &Settings,
    (x, y, sample): (u32, u32, u64),
) -> String {
    let integrator = PathTracer::new(world, settings.transport);
    let mut tracer = accel.tracer();
    let camera = camera.into().rays(settings.aspect());
    let (mut ray, mut path) = settings.start(&camera, (x, y), sample, 0, world.moves());
    start_inside(world, &mut *tracer, &camera, std::slice::from_mut(&mut path));
    if world.has_levels() {
        path.set_cone(camera.pixel_cone(settings.resolution.1));
    }
    let times = [path.time];
    let mut result = PathSample::default();
    let mut text = format!("pixel {x},{y} sample {sample} seed {}\n", settings.seed);
    if world.moves() {
        push_line(&mut text, &format!("time {:?} of the shutter", path.time));
    }
    let (mut depth, mut hit) = (1, Vec::new());
    loop {
        let keys = [ray_key(path.key, 2 * depth)];
        let slice = Slice { rays: &[ray], keys: &keys, times: &times };
        find_hits(world, &mut *tracer, &slice, None, &mut hit);
        let (along, throughput) = (format_ray(&ray), path.throughput());
        push_line(&mut text, &format!("segment {depth}: {along}, throughput {throughput:?}"));
        if world.has_levels() {
            path.widen(hit[0].t);
        }
        describe_hit(&mut text, world, (&ray, &hit[0]), &path);

        let before = result.radiance;
        let step = integrator.advance(depth, &mut path, &ray, &hit[0], &mut result);
        if result.radiance != before {
            let found = result.radiance - before;
            push_line(&mut text, &format!("  light found: {found:?}"));
        }
        if let Some(shadow) = step.shadow {
            let keys = [ray_key(path.key, 2 * depth + 1)];
            let mut blocked = Vec::new();
            let slice = Slice { rays: &[shadow.ray], keys: &keys, times: &times };
            find_blocked(world, &mut *tracer, &slice, &mut blocked);
            let state = if blocked[0].0 { "blocked" } else { "free" };
            let what = format!("  shadow ray {}, {state}", format_ray(&shadow.ray));
            push_line(&mut text, &format!("{what}: {:?}", shadow.radiance));
            if !blocked[0].0 {
                result.radiance += shadow.radiance;
            }
        }
        if let Some(transit) = step.transit {
            let key = ray_key(path.key, 2 * depth + 1);
            result.radiance +=
                follow_light(&mut text, (world, &mut *tracer), (&path, key), transit);
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

/// Takes light of a path through borders, describes its way, and returns what arrives.
fn follow_light(
    text: &mut String,
    (world, tracer): (&World, &mut dyn Tracer),
    (path, key): (&Path, u64),
    transit: Transit,
) -> Vec3 {
    let (mut transits, mut hit) = (Transits::default(), Vec::new());
    let mut arrived = Vec3::ZERO;
    transits.push(path, key, transit);
    while let [ray] = *transits.rays {
        let slice = Slice { rays: &[ray], keys: &transits.keys, times: &transits.times };
        find_hits(world, tracer, &slice, None, &mut hit);
        push_line(text, &format!("  light along {}", format_ray(&ray)));
        transits.cross(world, &hit, |_, radiance| arrived += radiance);
    }
    push_line(text, &format!("  arrives: {arrived:?}"));
    arrived
}

fn describe_hit(text: &mut String, world: &World, (ray, hit): (&Ray, &ClosestHit), path: &Path) {
    if !hit.is_hit() {
        push_line(text, "  hit nothing");
        return;
    }
    let surface = world.surface(ray, hit, (path.time, path.width()));
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
