//! Path tracing with next-event estimation.
//!
//! At each vertex a light is sampled directly, and the path goes on by the surface's own
//! scattering. Where both find the same light, multiple importance sampling weighs them (Veach and
//! Guibas 1995). Depth counts the segments of the path from the camera: 1 sees emitters alone, 2
//! adds direct light.
//!
//! Shading normals may disagree with the geometry. Light never passes the geometric side that the
//! scattering did not mean it to. A reflection that would go below the triangle, or a transmission
//! that would stay above, begins on the side where it belongs, and meets the triangle again unless
//! it begins beyond its edge; or it is lost, for both strategies alike, as
//! [`crate::world::ShadingNormals`] tells.
//!
//! A path keeps account of the solids that it is inside of, see [`super::interior`]: of two that
//! touch or overlap, the border between them bends light by the ratio of both indices. Where the
//! first of them disperses, the path goes on with light of one wavelength, for which all that
//! follows is sampled and weighed.

use super::borders::interior_beyond;
use super::crossing::classify_crossing;
use super::dimensions::{choice_dimension, direction_dimension};
use super::faceted::{Faceted, scatter_on_facets};
use super::first_hit::{
    describe_first_hit, end_first_hit_in_medium, follow_first_hit, follow_to_environment,
};
use super::leaving::ray_on;
use super::light::{add_emission, add_environment, light_sample_context, sample_direct};
use super::medium::{Flight, arrive, fly, point_before, scatter_in_medium};
use super::nested_dielectrics::{absorb, bsdf_for_path, is_hidden, pass_hidden};
use super::russian_roulette::survives_russian_roulette;
use super::state::{Path, PathSample, Step};
use super::transit::{beyond_passable, passable_tint};
use crate::accel::ClosestHit;
use crate::material::{Bsdf, BsdfSample};
use crate::math::{Ray, Vec3};
use crate::world::{Surface, World};

/// Beyond this share of a segment, a scattering may be so near to the surface at its end that
/// rounding puts it on the other side.
const NEAR: f32 = 0.99;

/// A path that carries more is bright.
const MUCH: f32 = 0.1;

/// How light is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transport {
    /// The most segments of a path, at least 1.
    pub max_depth: u32,
    /// The first segment at whose end Russian roulette may end a path; `None`: it never does.
    pub roulette_depth: Option<u32>,
    /// Whether the environment is hidden from the camera (it lights nevertheless).
    pub transparent: bool,
}

impl Default for Transport {
    /// 20 segments, roulette from the fifth on, and all that the camera sees.
    fn default() -> Self {
        Self { max_depth: 20, roulette_depth: Some(5), transparent: false }
    }
}

/// Follows paths through a world.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<'w> {
    world: &'w World,
    transport: Transport,
}

impl<'w> PathTracer<'w> {
    /// An integrator of `world`.
    pub fn new(world: &'w World, transport: Transport) -> Self {
        Self { world, transport }
    }

    /// The world that it looks at.
    pub fn world(&self) -> &'w World {
        self.world
    }

    /// Takes a path across the end of its segment number `depth`, counted from 1: `ray` has met
    /// `hit`. Emission that it meets is added to `sample`.
    #[inline(always)]
    pub fn advance(
        &self,
        depth: u32,
        path: &mut Path,
        ray: &Ray,
        hit: &ClosestHit,
        sample: &mut PathSample,
    ) -> Step {
        let world = self.world;
        if world.has_media() {
            return self.advance_in_media(depth, path, ray, hit, sample);
        }
        // A ray that leaves the scene ends the path at the environment.
        if !hit.is_hit() {
            if self.shows_environment(depth) {
                add_environment(world, path, ray, sample);
                follow_to_environment(world, path, ray.direction(), sample);
            }
            return Step::END;
        }

        // Account for the medium along the segment, then for emission at its end.
        let surface = world.surface(ray, hit, (path.time, path.width()));
        absorb(world, path, &surface, hit.t);
        add_emission(world, path, &surface, (ray, hit.t), sample);
        if depth > 1 && !self.goes_beyond(depth) {
            return Step::END;
        }

        // Find out how the surface scatters light. The border of a hidden solid does nothing.
        if depth > 1 && is_hidden(world, path, &surface) {
            pass_hidden(world, path, &surface);
            let next = usable(surface.ray_towards(ray.direction()), sample);
            return Step { next, ..Step::END };
        }
        self.scatter_at_surface(depth, path, ray, (&surface, hit, hit.t), sample)
    }

    /// Lets a path scatter where its segment number `depth` meets a surface, `distance` metres from
    /// its last vertex.
    #[inline(always)]
    fn scatter_at_surface(
        &self,
        depth: u32,
        path: &mut Path,
        ray: &Ray,
        (surface, hit, distance): (&Surface, &ClosestHit, f32),
        sample: &mut PathSample,
    ) -> Step {
        let world = self.world;
        let bsdf = bsdf_for_path(world, depth, path, surface, hit);
        if path.vertices(depth) == 1 {
            describe_first_hit(surface, &bsdf, distance, sample);
            if self.transport.max_depth == 1 {
                return Step::END;
            }
        } else {
            follow_first_hit(path, surface, &bsdf, sample);
        }
        let wo = surface.frame.to_local(-ray.direction());
        path.context = light_sample_context(world, surface, &bsdf);
        if let Some(facets) = world.facets(surface) {
            let at = Faceted { surface, bsdf: &bsdf, facets: &facets, viewer: -ray.direction() };
            let roulette = self.plays_roulette(path.vertices(depth));
            let (direct, next) = scatter_on_facets(world, depth, path, at, roulette, sample);
            return Step::new(direct, next.and_then(|next| usable(next, sample)));
        }
        let mut sampler = path.stream.at(choice_dimension(depth));
        let [u_lobe, u_roulette, u_light] = [(); 3].map(|()| sampler.next_1d());

        // Sample direct light.
        let in_vain = bsdf.is_delta() || world.lights.is_dark();
        let direct = if in_vain {
            None
        } else {
            sample_direct(world, depth, path, (surface, &bsdf), wo, u_light)
        };

        // Sample the BSDF for the next direction, and perhaps end the path there.
        let u_direction = path.stream.at(direction_dimension(depth)).next_2d();
        let next = bsdf.sample(wo, u_lobe, u_direction).and_then(|scattered| {
            let next = scatter(world, path, surface, wo, &scattered, sample)?;
            let goes_on = !self.plays_roulette(path.vertices(depth))
                || survives_russian_roulette(&mut path.throughput, path.eta_squared, u_roulette);
            if !goes_on || path.throughput == Vec3::ZERO {
                return None;
            }
            usable(next, sample)
        });
        Step::new(direct, next)
    }

    /// [`PathTracer::advance`] in a scene with media.
    #[inline(never)]
    fn advance_in_media(
        &self,
        depth: u32,
        path: &mut Path,
        ray: &Ray,
        hit: &ClosestHit,
        sample: &mut PathSample,
    ) -> Step {
        let world = self.world;
        if depth == 1 {
            path.context.position = ray.origin();
        }
        // Most paths in dense media scatter long before the surface, which then is not asked for.
        let when_and_width = (path.time, path.width());
        let look = || hit.is_hit().then(|| world.surface(ray, hit, when_and_width));
        let surface = if path.interior.is_air() { look() } else { None };
        let to = if hit.is_hit() { hit.t } else { f32::INFINITY };
        match fly(world, depth, path, surface.as_ref(), to) {
            Flight::Arrives => {}
            Flight::Ends => return Step::END,
            Flight::Scatters(at, medium) => {
                let near = at > NEAR * to || sample.first.is_none();
                let surface = if near { surface.or_else(look) } else { None };
                let surface = surface.as_ref();
                let position = point_before(ray, at, surface);
                path.end_at(at, to);
                let first = sample.first.is_none();
                let seen = if first { self.seen_behind(path, surface, hit) } else { None };
                let here = (position, path.distance_to(position, at), -ray.direction());
                end_first_hit_in_medium(path, &medium, here, seen, sample);
                if !self.goes_beyond(path.vertices(depth)) || path.throughput == Vec3::ZERO {
                    return Step::END;
                }
                let roulette = self.plays_roulette(path.vertices(depth));
                let scattering = (ray, position, &medium);
                return scatter_in_medium(world, depth, path, scattering, roulette, sample);
            }
        }
        let Some(surface) = &surface.or_else(look) else {
            if self.shows_environment(depth) {
                add_environment(world, path, ray, sample);
                follow_to_environment(world, path, ray.direction(), sample);
            }
            return Step::END;
        };
        arrive(world, path, Some(surface));

        // Borders that were passed are no vertices: lights beyond were asked for from before.
        let distance = path.distance_to(surface.position, hit.t);
        add_emission(world, path, surface, (ray, distance), sample);
        if let Some(tint) = passable_tint(world, path.interior, surface) {
            path.throughput *= tint;
            path.interior = beyond_passable(world, path.interior, surface);
            path.pass_border();
            let goes_on = path.throughput != Vec3::ZERO;
            let on = surface.ray_towards(ray.direction());
            let next = goes_on.then(|| usable(on, sample)).flatten();
            return Step { next, ..Step::END };
        }
        let vertices = path.vertices(depth);
        if vertices > 1 && !self.goes_beyond(vertices) {
            return Step::END;
        }
        self.scatter_at_surface(depth, path, ray, (surface, hit, distance), sample)
    }

    /// The surface that a camera ray would meet but for a scattering on the way, its BSDF and how
    /// far away it is; `None`, if it would meet a mere border.
    fn seen_behind<'s>(
        &self,
        path: &Path,
        surface: Option<&'s Surface>,
        hit: &ClosestHit,
    ) -> Option<(&'s Surface, Bsdf, f32)> {
        let surface = surface.filter(|it| !self.world.is_solid(it.material))?;
        let distance = (surface.position - path.context.position).length();
        Some((surface, self.world.bsdf(surface, hit), distance))
    }

    /// Whether rays that leave the scene at the end of segment `depth` show the environment.
    pub fn shows_environment(&self, depth: u32) -> bool {
        !(depth == 1 && self.transport.transparent)
    }

    /// Whether paths go on beyond the end of segment number `depth`.
    pub fn goes_beyond(&self, depth: u32) -> bool {
        depth < self.transport.max_depth
    }

    /// Whether a path that ends with its segment number `depth`, at `hit`, does so for its length,
    /// while much of the light that is still to be found, if there is any, would reach the camera.
    pub fn cuts(&self, depth: u32, path: &Path, hit: &ClosestHit) -> bool {
        let is_long = !self.goes_beyond(path.vertices(depth));
        is_long && hit.is_hit() && path.throughput.max_element() > MUCH
    }

    pub(super) fn plays_roulette(&self, depth: u32) -> bool {
        self.transport.roulette_depth.is_some_and(|from| depth >= from)
    }
}

/// Takes a path on in the direction that its BSDF has scattered it to, and returns the ray that it
/// goes on with. `None` where the path ends.
#[inline(always)]
fn scatter(
    world: &World,
    path: &mut Path,
    surface: &Surface,
    wo: Vec3,
    scattered: &BsdfSample,
    sample: &mut PathSample,
) -> Option<Ray> {
    let direction = surface.frame.to_world(scattered.wi);
    let crossing =
        classify_crossing(surface, direction, wo, scattered.wi, world.has_robust_normals())?;
    path.throughput *= scattered.weight;
    path.eta_squared *= scattered.eta * scattered.eta;
    path.pdf = if scattered.delta { f32::INFINITY } else { scattered.pdf };
    path.interior = interior_beyond(world, path.interior, surface, crossing);
    if !path.throughput.is_finite() {
        sample.radiance = Vec3::NAN; // to be counted and left out, not hidden
        return None;
    }
    Some(ray_on(world, surface, direction, crossing))
}

/// The ray that leaves a surface; `None` where it can't be followed.
#[inline(always)]
fn usable(next: Ray, sample: &mut PathSample) -> Option<Ray> {
    if next == Ray::MISS {
        sample.radiance = Vec3::NAN; // to be counted and left out, not hidden
        return None;
    }
    Some(next)
}
