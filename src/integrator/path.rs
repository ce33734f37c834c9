//! Path tracing with next-event estimation.
//!
//! At each vertex a light is chosen and asked directly, and the path goes on by the surface's own
//! scattering; where both find the same light, multiple importance sampling weighs them (Veach and
//! Guibas 1995). Depth counts the segments of the path from the camera: 1 sees emitters alone, 2
//! adds direct light.
//!
//! Shading normals may disagree with the geometry. Light never passes the geometric side that the
//! scattering did not mean it to: a reflection that would go below the triangle, or a transmission
//! that would stay above, is lost, for both strategies alike.
//!
//! A path keeps account of the solids that it is inside of, see [`Interior`]: of two that touch or
//! overlap, the border between them bends light by the ratio of both indices. Where the first of
//! them disperses, the path goes on with light of one wavelength, for which all that follows is
//! sampled and weighed.

use super::interior::Interior;
use super::passes::{Passes, passes};
use super::weight::{power_heuristic, survival};
use crate::accel::ClosestHit;
use crate::light::LightSampleContext;
use crate::material::{Bsdf, BsdfSample, Wavelength};
use crate::math::{Ray, Vec3};
use crate::sampling::Sampler;
use crate::world::{Surface, World};

/// How light is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transport {
    /// The most segments of a path, at least 1.
    pub max_depth: u32,
    /// The segment after which Russian roulette may end a path first; `None`: it never does.
    pub roulette_depth: Option<u32>,
    /// Whether the environment is hidden from the camera (it lights nevertheless).
    pub transparent: bool,
}

/// A path under way; its current ray is kept beside it, in a slice for the tracer.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    throughput: Vec3,
    /// Square of the product of relative indices of refraction that it has passed.
    eta_squared: f32,
    /// Where the current ray began.
    context: LightSampleContext,
    /// Density over solid angle with which the current ray's direction was chosen; infinite where
    /// no light could have been chosen instead.
    pdf: f32,
    /// The solids that it travels in.
    interior: Interior,
    /// Of the light that it follows, once colours have parted.
    wavelength: Option<Wavelength>,
    sampler: Sampler,
    /// Where its result goes.
    pub slot: u32,
    /// A hash of pixel, sample and seed.
    pub key: u64,
}

/// What a path has brought back.
#[derive(Clone, Copy, Debug, Default)]
pub struct PathSample {
    /// Radiance at the camera.
    pub radiance: Vec3,
    /// What the camera ray hit first.
    pub first: Option<FirstHit>,
}

/// What the camera sees, apart from its light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// The share of light that the surface scatters.
    pub albedo: Vec3,
    /// Unit shading normal, world space, towards the camera's side.
    pub normal: Vec3,
    /// World space.
    pub position: Vec3,
    /// Metres from the camera ray's origin.
    pub distance: f32,
}

/// A segment which, if it is free, lets light through to the path.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// The segment.
    pub ray: Ray,
    /// What is added to the path's radiance if nothing is in the way.
    pub radiance: Vec3,
}

/// What follows from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// The light to ask.
    pub shadow: Option<ShadowRay>,
    /// The ray to go on with; `None`: the path ends.
    pub next: Option<Ray>,
}

impl Step {
    const END: Self = Self { shadow: None, next: None };
}

/// Dimensions of the sampler: four for the camera, then two sets of four for each vertex.
const CAMERA_DIMENSIONS: u32 = 4;
const VERTEX_DIMENSIONS: u32 = 8;

/// The first dimension of the vertex at the end of segment `depth`.
fn first_dimension(depth: u32) -> u32 {
    CAMERA_DIMENSIONS + VERTEX_DIMENSIONS * (depth - 1)
}

/// Follows paths through a world.
#[derive(Clone, Copy, Debug)]
pub struct PathTracer<'w> {
    world: &'w World,
    transport: Transport,
}

impl Path {
    /// A path that starts at the camera. `sampler` is that of its sample, whose first four
    /// dimensions are the camera's.
    pub fn new(sampler: Sampler, key: u64, slot: u32) -> Self {
        Self {
            throughput: Vec3::ONE,
            eta_squared: 1.0,
            context: LightSampleContext { position: Vec3::ZERO, normal: Vec3::ZERO },
            pdf: f32::INFINITY,
            interior: Interior::AIR,
            wavelength: None,
            sampler,
            slot,
            key,
        }
    }

    /// What part of the light at the current ray's end reaches the camera, over the probability
    /// of having come here.
    pub fn throughput(&self) -> Vec3 {
        self.throughput
    }
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
        if !hit.is_hit() {
            if !(depth == 1 && self.transport.transparent) {
                self.escape(path, ray, sample);
            }
            return Step::END;
        }
        let surface = world.surface(ray, hit);
        self.absorb(path, &surface, hit.t);
        if let Some(radiance) = world.emitted_radiance(&surface) {
            let asked = || world.emitter_pdf(&surface, &path.context, ray.direction(), hit.t);
            let weight =
                if path.pdf == f32::INFINITY { 1.0 } else { power_heuristic(path.pdf, asked()) };
            sample.radiance += path.throughput * radiance * weight;
        }
        if depth > 1 && depth >= self.transport.max_depth {
            return Step::END;
        }
        if depth > 1 && self.is_hidden(path, &surface) {
            return self.pass_by(path, &surface, ray, sample);
        }
        let bsdf = self.bsdf(depth, path, &surface, hit);
        let wo = surface.frame.to_local(-ray.direction());
        if depth == 1 {
            let side = if surface.front { 1.0 } else { -1.0 };
            sample.first = Some(FirstHit {
                albedo: bsdf.albedo(),
                normal: surface.frame.normal * side,
                position: surface.position,
                distance: hit.t,
            });
            if self.transport.max_depth == 1 {
                return Step::END;
            }
        }
        path.sampler.seek(first_dimension(depth));
        let u_direction = path.sampler.next_2d();
        let u_lobe = path.sampler.next_1d();
        let u_roulette = path.sampler.next_1d();

        path.context = context(&surface, &bsdf);
        let shadow = if bsdf.is_delta() || world.lights.is_dark() {
            None
        } else {
            self.sample_direct(path, &surface, &bsdf, wo)
        };

        let next = match bsdf.sample(wo, u_lobe, u_direction) {
            Some(scattered) => {
                self.scatter(path, &surface, wo, &scattered, (depth, u_roulette), sample)
            }
            None => None,
        };
        Step { shadow, next }
    }

    /// The ray that goes on from a surface as its material scatters it; `None` where the path ends.
    #[inline(always)]
    fn scatter(
        &self,
        path: &mut Path,
        surface: &Surface,
        wo: Vec3,
        scattered: &BsdfSample,
        (depth, u_roulette): (u32, f32),
        sample: &mut PathSample,
    ) -> Option<Ray> {
        let direction = surface.frame.to_world(scattered.wi);
        let passes = passes(surface, direction, wo, scattered.wi)?;
        path.throughput *= scattered.weight;
        path.eta_squared *= scattered.eta * scattered.eta;
        path.pdf = if scattered.delta { f32::INFINITY } else { scattered.pdf };
        path.interior = self.interior_beyond(path.interior, surface, passes);
        if !path.throughput.is_finite() {
            sample.radiance = Vec3::NAN; // to be counted and left out, not hidden
            return None;
        }
        if self.transport.roulette_depth.is_some_and(|from| depth >= from) {
            let survival = survival(path.throughput, path.eta_squared);
            if u_roulette >= survival {
                return None;
            }
            path.throughput /= survival;
        }
        if path.throughput == Vec3::ZERO {
            return None;
        }
        let next = surface.ray_towards(direction);
        if next == Ray::MISS {
            sample.radiance = Vec3::NAN; // no direction that can be followed
            return None;
        }
        Some(next)
    }

    /// The path leaves the scene.
    fn escape(&self, path: &Path, ray: &Ray, sample: &mut PathSample) {
        if self.world.scene.environment.is_some() {
            let (radiance, pdf) = self.world.environment(ray.direction());
            let weight = power_heuristic(path.pdf, pdf);
            let reaching = self.world.transmittance(path.interior.medium(), f32::INFINITY);
            sample.radiance += path.throughput * reaching * radiance * weight;
        }
    }

    /// Takes away what the inside of a solid absorbs along a segment. A path that meets the back
    /// of a solid which it never entered has started inside.
    #[inline]
    fn absorb(&self, path: &mut Path, surface: &Surface, distance: f32) {
        let world = self.world;
        let leaves = !surface.front && world.is_solid(surface.material);
        if path.interior.is_air() {
            if !leaves {
                return;
            }
            path.interior = path.interior.behind(surface.material, world);
        }
        path.throughput *= world.transmittance(path.interior.medium(), distance);
        if leaves {
            path.interior = path.interior.behind(surface.material, world);
        }
    }

    /// Whether a surface does nothing where the path meets it: the border of a solid within another
    /// one of higher priority.
    #[inline]
    fn is_hidden(&self, path: &Path, surface: &Surface) -> bool {
        let world = self.world;
        !path.interior.is_air()
            && world.is_solid(surface.material)
            && path.interior.hides(surface.material, surface.front, world)
    }

    /// Goes straight on through a surface that does nothing.
    #[inline(never)]
    fn pass_by(
        &self,
        path: &mut Path,
        surface: &Surface,
        ray: &Ray,
        sample: &mut PathSample,
    ) -> Step {
        let passes = if surface.front { Passes::Into } else { Passes::OutOf };
        path.interior = self.interior_beyond(path.interior, surface, passes);
        // No light that was asked has been seen through it.
        path.pdf = f32::INFINITY;
        let next = surface.ray_towards(ray.direction());
        if next == Ray::MISS {
            sample.radiance = Vec3::NAN; // no direction that can be followed
            return Step::END;
        }
        Step { shadow: None, next: Some(next) }
    }

    /// What a surface scatters of the light that the path follows; between the solids that meet
    /// there.
    #[inline(always)]
    fn bsdf(&self, depth: u32, path: &mut Path, surface: &Surface, hit: &ClosestHit) -> Bsdf {
        let (world, inside) = (self.world, surface.material);
        if !world.is_solid(inside) || (path.interior.is_air() && !world.disperses(inside)) {
            return world.bsdf(surface, hit);
        }
        self.bsdf_of_border(depth, path, surface, hit)
    }

    #[inline(never)]
    fn bsdf_of_border(
        &self,
        depth: u32,
        path: &mut Path,
        surface: &Surface,
        hit: &ClosestHit,
    ) -> Bsdf {
        let (world, inside) = (self.world, surface.material);
        let outside = path.interior.without(inside).medium();
        let disperses = world.disperses(inside) || world.disperses(outside);
        if path.wavelength.is_none() && disperses {
            path.sampler.seek(first_dimension(depth) + VERTEX_DIMENSIONS - 1);
            let (wavelength, weights) = Wavelength::sample(path.sampler.next_1d());
            path.wavelength = Some(wavelength);
            path.throughput *= weights;
        }
        let ior = |id| world.ior(id, path.wavelength);
        world.bsdf_of_index(surface, hit, ior(inside) / ior(outside))
    }

    /// The solids that lie beyond a surface on the side of a direction.
    #[inline]
    fn interior_beyond(&self, interior: Interior, surface: &Surface, passes: Passes) -> Interior {
        let (world, id) = (self.world, surface.material);
        if !world.is_solid(id) {
            return interior;
        }
        match passes {
            Passes::Reflected => interior,
            Passes::Into => interior.without(id).with(id, |id| world.priority(id)),
            Passes::OutOf => interior.without(id),
        }
    }

    /// Chooses a light, and what of it would reach the camera this way.
    #[inline(always)]
    fn sample_direct(
        &self,
        path: &mut Path,
        surface: &Surface,
        bsdf: &Bsdf,
        wo: Vec3,
    ) -> Option<ShadowRay> {
        let u = path.sampler.next_2d();
        let u_light = path.sampler.next_1d();
        let light = self.world.sample_light(surface, &path.context, u_light, u)?;
        let wi = surface.frame.to_local(light.direction);
        let passes = passes(surface, light.direction, wo, wi)?;
        let (scattered, pdf) = bsdf.eval(wo, wi);
        if scattered == Vec3::ZERO {
            return None;
        }
        let weight = if light.delta { 1.0 } else { power_heuristic(light.pdf, pdf) };
        let mut radiance = path.throughput * scattered * light.radiance * (weight / light.pdf);
        let interior = self.interior_beyond(path.interior, surface, passes);
        if !interior.is_air() {
            radiance *= self.world.transmittance(interior.medium(), length(&light.ray));
        }
        (radiance != Vec3::ZERO).then_some(ShadowRay { ray: light.ray, radiance })
    }
}

/// From which side light is asked for: both where it may pass.
#[inline(always)]
fn context(surface: &Surface, bsdf: &Bsdf) -> LightSampleContext {
    let normal = match (bsdf.transmits(), surface.front) {
        (true, _) => Vec3::ZERO,
        (false, true) => surface.normal,
        (false, false) => -surface.normal,
    };
    LightSampleContext { position: surface.position, normal }
}

/// Metres from a ray's origin to its end.
fn length(ray: &Ray) -> f32 {
    if ray.t_max() < f32::INFINITY { ray.direction().length() * ray.t_max() } else { f32::INFINITY }
}
