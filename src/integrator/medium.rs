//! A vertex of a path in a medium that scatters.
//!
//! Along a segment in such a medium the path draws how far it flies (see [`crate::medium`]). If it
//! gets to the segment's end, all goes on as without a medium, its throughput weighed; else it
//! scatters on the way: there, a light is sampled directly, and the path goes on by the phase
//! function, weighed against each other as at surfaces. A scattering is a vertex: it counts in the
//! path's depth.

use super::dimensions::{choice_dimension, direction_dimension, flight_dimension, light_dimension};
use super::interior::Interior;
use super::russian_roulette::survives_scattering;
use super::state::{Path, PathSample, Step};
use super::transit::{Shine, Transit};
use crate::accel::ClosestHit;
use crate::light::LightSampleContext;
use crate::math::{Ray, Vec3};
use crate::medium::{FreeFlight, Medium};
use crate::world::{Surface, World};

/// How a segment ends in a scene with media.
pub enum Flight {
    /// The path gets to its end.
    Arrives,
    /// It scatters in a medium, so many metres on.
    Scatters(f32, Medium),
    /// It is not to be followed.
    Ends,
}

/// Takes a path along its segment number `depth`, which is `distance` metres long: as far as the
/// medium around lets it. `surface` is where it ends; it need not be known, but for a path in air.
pub fn fly(
    world: &World,
    depth: u32,
    path: &mut Path,
    surface: Option<&Surface>,
    distance: f32,
) -> Flight {
    if path.interior.is_air() {
        arrive(world, path, surface);
    }
    let id = path.interior.solid();
    let Some(medium) = world.medium(id).filter(|medium| medium.scatters()) else {
        path.throughput *= world.transmittance_in(id, distance);
        return Flight::Arrives;
    };
    let u = path.stream.at(flight_dimension(depth)).next_2d();
    let flight = FreeFlight { medium, densities: path.densities };
    let Some(leg) = flight.sample(distance, u) else { return Flight::Ends };
    path.throughput *= leg.weight;
    path.densities = leg.densities;
    if let Some(at) = leg.scatters_at {
        return Flight::Scatters(at, *medium);
    }
    if path.pdf < f32::INFINITY {
        path.pdf *= leg.passes;
    }
    Flight::Arrives
}

/// Who meets the back of a border is inside of its solid, also if it never came in.
pub fn arrive(world: &World, path: &mut Path, surface: Option<&Surface>) {
    if let Some(surface) = surface.filter(|it| !it.front && world.is_solid(it.material)) {
        path.interior = path.interior.behind(surface.material, world);
    }
}

/// Takes a path across a scattering at the end of its segment number `depth`, at a point of `ray`
/// in `medium`; `roulette`: whether it may end there by chance.
pub fn scatter_in_medium(
    world: &World,
    depth: u32,
    path: &mut Path,
    (ray, position, medium): (&Ray, Vec3, &Medium),
    roulette: bool,
    sample: &mut PathSample,
) -> Step {
    let (flight, phase) = (ray.direction(), medium.phase());
    let here = Surface::point_in_space(position, flight, path.time);
    path.context = LightSampleContext { position, normal: Vec3::ZERO };
    let mut sampler = path.stream.at(choice_dimension(depth));
    let [_, u_roulette, u_light] = [(); 3].map(|()| sampler.next_1d());

    // Sample direct light.
    let u = path.stream.at(light_dimension(depth)).next_2d();
    let light = world.sample_light(&here, &path.context, u_light, u);
    let transit = light.and_then(|light| {
        let pdf = phase.eval(flight.dot(light.direction));
        let shine = Shine { light, scattered: path.throughput * pdf, pdf };
        Transit::new(&shine, path.interior, path.densities)
    });

    // Sample the phase function, and perhaps end the path there.
    let u = path.stream.at(direction_dimension(depth)).next_2d();
    let (direction, pdf) = phase.sample(flight, u);
    path.pdf = pdf;
    let goes_on =
        !roulette || survives_scattering(&mut path.throughput, path.eta_squared, u_roulette);
    let next = Ray::new(position, direction, 0.0, f32::INFINITY);
    if goes_on && (next == Ray::MISS || !path.throughput.is_finite()) {
        sample.radiance = Vec3::NAN; // to be counted and left out, not hidden
        return Step { shadow: None, transit, next: None };
    }
    Step { shadow: None, transit, next: goes_on.then_some(next) }
}

/// The point `at` metres on along `ray`, on this side of the surface that the ray meets, whatever
/// rounding says.
pub fn point_before(ray: &Ray, at: f32, surface: Option<&Surface>) -> Vec3 {
    let point = ray.origin() + ray.direction() * at;
    let Some(surface) = surface else { return point };
    let side = if surface.front { surface.normal } else { -surface.normal };
    let margin = surface.normal.abs().dot(surface.position_error);
    if (point - surface.position).dot(side) > margin {
        return point;
    }
    surface.ray_towards(-ray.direction()).origin()
}

/// The solids around a point at a `time` of the shutter: those whose borders a ray from there meets
/// from within. `trace` finds what a ray hits first.
pub fn interior_at(
    world: &World,
    (point, time): (Vec3, f32),
    mut trace: impl FnMut(&Ray) -> ClosestHit,
) -> Interior {
    /// The most borders that are counted.
    const MOST: usize = 1000;
    // Along no axis, and through no edge of what is built along them.
    let direction = Vec3::new(0.437_184_3, 0.786_513_7, 0.436_227_1).normalize();
    let mut ray = Ray::new(point, direction, 0.0, f32::INFINITY);
    let (mut entered, mut inside) = (Vec::new(), Interior::AIR);
    for _ in 0..MOST {
        let hit = trace(&ray);
        if !hit.is_hit() {
            break;
        }
        let surface = world.surface(&ray, &hit, (time, 0.0));
        let id = surface.material;
        if world.is_solid(id) {
            if surface.front {
                entered.push(id);
            } else if let Some(place) = entered.iter().rposition(|&other| other == id) {
                entered.remove(place);
            } else if !inside.contains(id) {
                inside = inside.with(id, |id| world.priority(id));
            }
        }
        ray = surface.ray_towards(direction);
    }
    inside
}
