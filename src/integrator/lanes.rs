//! A vertex of many paths at once.
//!
//! The steps of [`PathTracer::advance`] in the same order, for paths in air that have met surfaces
//! of one class: such neither emit nor let light pass, and scatter by one BSDF. Arithmetic is done
//! for all lanes at once and has the bits of `advance`; a test holds it to that. Paths that turn
//! out to need more are left to `advance`.

use super::dimensions::{choice_dimension, direction_dimension, light_dimension};
use super::path::PathTracer;
use super::shadow_rays::ShadowRays;
use super::state::{FirstHit, Path, PathSample, ShadowRay};
use crate::accel::ClosestHit;
use crate::geom::are_usable;
use crate::light::LightSampleContext;
use crate::material::lanes::{BsdfLanes, BsdfSamples};
use crate::math::{InstanceId, Ray, Vec3};
use crate::sampling::SamplerLanes;
use crate::simd::lanes::{Float, Lanes, Mask, Rows, Vec3f};
use crate::world::lanes::{LightRows, SurfaceLanes, SurfaceRows};

/// Paths at the ends of their current segments, in columns.
pub struct Vertices<'a> {
    /// The current rays; those that paths go on with take their places.
    pub rays: &'a mut [Ray],
    /// What they have met.
    pub hits: &'a [ClosestHit],
    /// The instances that were hit, and the numbers of the triangles in their meshes.
    pub triangles: &'a [(InstanceId, usize)],
    /// The states.
    pub paths: &'a mut [Path],
    /// Whether each path goes on.
    pub alive: &'a mut [bool],
    /// Results by slot.
    pub samples: &'a mut [PathSample],
    /// Whether a camera ray has met what mirrors or is clear: then first hits are followed.
    pub follows: &'a mut bool,
    /// The rays to lights.
    pub shadow_rays: &'a mut ShadowRays,
}

/// What a block of paths is computed from.
#[derive(Default)]
struct VertexRows {
    direction: Rows,
    /// And the square of the indices of refraction that were passed.
    throughput: Rows,
    /// The parts of the sampler, as bits.
    sampler: Rows,
    surface: SurfaceRows,
}

/// Where blocks of paths put rows; one for many blocks, since it takes time to clear.
#[derive(Default)]
struct Scratch {
    light: LightRows,
    out: [Rows; 5],
}

/// What a block of paths has come to.
struct VertexLanes<L: Lanes> {
    /// The lanes that hold a path.
    live: L::Mask,
    depth: u32,
    throughput: Vec3f<L>,
    eta_squared: L::Float,
    surface: SurfaceLanes<L>,
    /// Towards the viewer; local.
    wo: Vec3f<L>,
}

/// Takes paths across the vertices at the ends of their segments number `depth`, as
/// [`PathTracer::advance`] does: those listed in `order`, which are of one class. Those that are
/// left to be advanced one by one are added to `rest`.
#[inline(always)]
pub fn shade_in_lanes<L: Lanes, B: BsdfLanes<L>>(
    integrator: &PathTracer<'_>,
    lanes: L,
    depth: u32,
    order: &[u32],
    vertices: &mut Vertices<'_>,
    rest: &mut Vec<u32>,
) {
    let (mut rows, mut scratch) = (VertexRows::default(), Scratch::default());
    for block in order.chunks(L::WIDTH) {
        rows.fetch(integrator, lanes, B::ROWS, block, vertices);
        let lost =
            shade_block::<L, B>(integrator, lanes, depth, block, (&rows, &mut scratch), vertices);
        for_each_lane(lost, |lane| rest.push(block[lane]));
    }
}

/// Adds the light of the environment to paths in air that leave the scene: those listed in `order`.
/// See `light::add_environment`.
#[inline(always)]
pub fn add_environment_in_lanes<L: Lanes>(
    integrator: &PathTracer<'_>,
    lanes: L,
    order: &[u32],
    vertices: &mut Vertices<'_>,
) {
    let world = integrator.world();
    let Some(environment) = &world.scene.environment else { return };
    let [mut directions, mut throughputs, mut radiances] = [Rows::default(); 3];
    for block in order.chunks(L::WIDTH) {
        for lane in 0..L::WIDTH {
            let i = block[lane.min(block.len() - 1)] as usize;
            directions[lane] = row(vertices.rays[i].direction(), vertices.paths[i].pdf);
            throughputs[lane] = row(vertices.paths[i].throughput, 0.0);
        }
        let [x, y, z, path_pdf] = lanes.columns(&directions);
        let throughput = Vec3f::<L>::of_columns(lanes.columns(&throughputs));
        let direction = Vec3f::new(x, y, z);
        let (radiance, pdf) = world.environment_in_lanes(lanes, environment, direction);
        let one = lanes.float(1.0);
        let ratio = pdf / path_pdf;
        let weight = one / (ratio * ratio + 1.0);
        if *vertices.follows {
            lanes.rows(radiance.columns(one), &mut radiances);
            for (&i, &radiance) in block.iter().zip(&radiances) {
                let path = &vertices.paths[i as usize];
                let first = vertices.samples[path.slot as usize].first.as_mut();
                if let Some(first) = first.filter(|first| first.goes_on) {
                    first.follow_to_environment(path.throughput, vec3(radiance));
                }
            }
        }
        let alone = path_pdf.eq(lanes.float(f32::INFINITY));
        let radiance = (throughput * radiance).scale(alone.select(one, weight));
        lanes.rows(radiance.columns(one), &mut radiances);
        for (&i, &radiance) in block.iter().zip(&radiances) {
            let slot = vertices.paths[i as usize].slot as usize;
            vertices.samples[slot].radiance += vec3(radiance);
        }
    }
}

impl VertexRows {
    /// Fetches all that a block's paths need; unused lanes repeat the last path.
    #[inline(always)]
    fn fetch<L: Lanes>(
        &mut self,
        integrator: &PathTracer<'_>,
        _: L,
        bsdf_rows: usize,
        block: &[u32],
        vertices: &Vertices<'_>,
    ) {
        let world = integrator.world();
        for lane in 0..L::WIDTH {
            let i = block[lane.min(block.len() - 1)] as usize;
            let (path, hit) = (&vertices.paths[i], &vertices.hits[i]);
            let direction = vertices.rays[i].direction();
            self.direction[lane] = row(direction, 0.0);
            self.throughput[lane] = row(path.throughput, path.eta_squared);
            let [key, index] = path.sampler.parts();
            self.sampler[lane] = [f32::from_bits(key), f32::from_bits(index), 0.0, 0.0];
            self.surface.fetch(lane, world, vertices.triangles[i], hit, bsdf_rows);
        }
    }
}

/// The steps of a vertex; a bit for each lane that was left as it was.
#[inline(always)]
fn shade_block<L: Lanes, B: BsdfLanes<L>>(
    integrator: &PathTracer<'_>,
    lanes: L,
    depth: u32,
    block: &[u32],
    (rows, scratch): (&VertexRows, &mut Scratch),
    vertices: &mut Vertices<'_>,
) -> u32 {
    let world = integrator.world();
    // The surfaces, and how they scatter light.
    let direction = Vec3f::of_columns(lanes.columns(&rows.direction));
    let surface = SurfaceLanes::new(lanes, &rows.surface, direction, world.slack());
    let wo = surface.frame.to_local(-direction);
    let bsdf = B::load(lanes, &rows.surface.bsdf, world.form(), wo);
    let [r, g, b, eta_squared] = lanes.columns(&rows.throughput);
    let throughput = Vec3f::new(r, g, b);
    let [key, index, ..] = lanes.columns(&rows.sampler);
    let sampler = SamplerLanes::<L>::new(key.to_bits(), index.to_bits());
    let [u_lobe, u_roulette, u_light, _] = sampler.set(lanes, choice_dimension(depth));
    let live = lanes.first(block.len());
    let mut vertex = VertexLanes { live, depth, throughput, eta_squared, surface, wo };

    // Sample direct light.
    let lost = if world.lights.is_dark() {
        (live & !surface.valid).to_bits()
    } else {
        let u = sampler.pair(lanes, light_dimension(depth));
        vertex.sample_direct(integrator, lanes, &bsdf, (u_light, u), block, (scratch, vertices))
    };
    vertex.live = live & !lanes.mask(lost);
    if depth == 1 || *vertices.follows {
        vertex.describe_first_hits(lanes, &bsdf, block, vertices);
    }

    // Sample the BSDF for the next direction, and perhaps end the path there.
    let u = sampler.pair(lanes, direction_dimension(depth));
    let scattered = bsdf.sample(lanes, wo, u_lobe, u);
    vertex.scatter(integrator, lanes, &scattered, u_roulette, block, (scratch, vertices));
    lost
}

impl<L: Lanes> VertexLanes<L> {
    /// See [`super::light::sample_direct`]. A bit for each lane that must be left to it.
    #[inline(always)]
    fn sample_direct<B: BsdfLanes<L>>(
        &self,
        integrator: &PathTracer<'_>,
        lanes: L,
        bsdf: &B,
        (u_light, u): (L::Float, [L::Float; 2]),
        block: &[u32],
        (scratch, vertices): (&mut Scratch, &mut Vertices<'_>),
    ) -> u32 {
        let Self { surface, .. } = self;
        let world = integrator.world();
        let (light, others) =
            world.sample_light_in_lanes(lanes, surface, u_light, u, &mut scratch.light);
        let lost = (self.live & !surface.valid).to_bits() | (others & self.live.to_bits());

        let wi = surface.frame.to_local(light.direction);
        let (scattered, pdf) = bsdf.eval(lanes, self.wo, wi);
        let ratio = pdf / light.pdf;
        let one = lanes.float(1.0);
        let weight = light.delta.select(one, one / (ratio * ratio + 1.0));
        let radiance = (self.throughput * scattered * light.radiance).scale(weight / light.pdf);
        let asks = light.valid
            & self.stays_on_its_side(lanes, light.direction, wi)
            & !scattered.is_zero()
            & !radiance.is_zero();
        let asks = (self.live & asks).to_bits() & !lost;
        if asks != 0 {
            let zero = lanes.float(0.0);
            let usable = are_usable(lanes, light.origin, light.segment).to_bits();
            let [origins, segments, radiances, ..] = &mut scratch.out;
            lanes.rows(light.origin.columns(zero), origins);
            lanes.rows(light.segment.columns(light.t_max), segments);
            lanes.rows(radiance.columns(zero), radiances);
            for_each_lane(asks, |lane| {
                let ([x, y, z, t_max], path) = (segments[lane], block[lane] as usize);
                let segment = Vec3::new(x, y, z);
                let ray = if usable >> lane & 1 == 1 {
                    Ray::usable(vec3(origins[lane]), segment, t_max)
                } else {
                    Ray::MISS
                };
                let shadow = ShadowRay { ray, radiance: vec3(radiances[lane]) };
                vertices.shadow_rays.push(&vertices.paths[path], shadow);
            });
        }
        lost
    }

    /// Where light that goes on in a direction stays on the viewer's side, or crosses a surface
    /// that its shading normal has it cross too; see [`super::crossing::classify_crossing`].
    #[inline(always)]
    fn stays_on_its_side(&self, lanes: L, direction: Vec3f<L>, wi: Vec3f<L>) -> L::Mask {
        let zero = lanes.float(0.0);
        let above = self.surface.normal.dot(direction);
        let stays = above.gt(zero) ^ self.surface.front;
        let seems_to_stay = wi.z.gt(zero) ^ self.wo.z.gt(zero);
        !above.eq(zero) & !(stays ^ seems_to_stay)
    }

    /// Takes the paths on in the directions that their BSDFs have scattered them to, or ends them.
    #[inline(always)]
    fn scatter(
        &self,
        integrator: &PathTracer<'_>,
        lanes: L,
        scattered: &BsdfSamples<L>,
        u_roulette: L::Float,
        block: &[u32],
        (scratch, vertices): (&mut Scratch, &mut Vertices<'_>),
    ) {
        let (zero, surface) = (lanes.float(0.0), &self.surface);
        let direction = surface.frame.to_world(scattered.wi);
        let mut throughput = self.throughput * scattered.weight;
        let passes = self.stays_on_its_side(lanes, direction, scattered.wi);
        let goes_on = self.live & scattered.valid & passes;
        let lost = goes_on & !throughput.is_finite(lanes);
        let mut goes_on = goes_on & !lost;
        if integrator.plays_roulette(self.depth) {
            let Vec3f { x, y, z } = throughput;
            let brightest = y.most(z).most(x);
            let survival = (brightest * self.eta_squared).least(lanes.float(0.95));
            goes_on = goes_on & u_roulette.lt(survival);
            throughput = throughput.divide(survival);
        }
        goes_on = goes_on & !throughput.is_zero();

        let origin = surface.offset_origin(lanes, direction);
        let usable = are_usable(lanes, origin, direction);
        let lost = lost | (goes_on & !usable);
        goes_on = goes_on & usable;
        let normal = Vec3f::select(surface.front, surface.normal, -surface.normal);
        let [origins, directions, throughputs, positions, normals] = &mut scratch.out;
        lanes.rows(origin.columns(zero), origins);
        lanes.rows(direction.columns(zero), directions);
        lanes.rows(throughput.columns(scattered.pdf), throughputs);
        lanes.rows(surface.position.columns(zero), positions);
        lanes.rows(normal.columns(zero), normals);
        for_each_lane(goes_on.to_bits(), |lane| {
            let i = block[lane] as usize;
            let (origin, direction) = (vec3(origins[lane]), vec3(directions[lane]));
            let next = Ray::usable(origin, direction, f32::INFINITY);
            let path = &mut vertices.paths[i];
            path.throughput = vec3(throughputs[lane]);
            path.pdf = throughputs[lane][3];
            let (position, normal) = (vec3(positions[lane]), vec3(normals[lane]));
            path.context = LightSampleContext { position, normal };
            vertices.rays[i] = next;
            vertices.alive[i] = true;
        });
        // To be counted and left out, not hidden.
        for_each_lane(lost.to_bits(), |lane| {
            let path = &vertices.paths[block[lane] as usize];
            vertices.samples[path.slot as usize].radiance = Vec3::NAN;
        });
    }

    /// What is seen of the surfaces, apart from their light; see [`super::first_hit`].
    #[inline(always)]
    fn describe_first_hits<B: BsdfLanes<L>>(
        &self,
        lanes: L,
        bsdf: &B,
        block: &[u32],
        vertices: &mut Vertices<'_>,
    ) {
        let slot = |lane: usize| vertices.paths[block[lane] as usize].slot as usize;
        let mut seen = self.live.to_bits();
        if self.depth > 1 {
            for_each_lane(self.live.to_bits(), |lane| {
                let first = &vertices.samples[slot(lane)].first;
                seen ^= u32::from(!first.is_some_and(|first| first.goes_on)) << lane;
            });
        }
        if seen == 0 {
            return;
        }
        let (zero, surface) = (lanes.float(0.0), &self.surface);
        let shading = surface.frame.normal;
        let normal = Vec3f::select(surface.front, shading, -shading);
        let mirrors = bsdf.is_mirror_like(lanes).to_bits();
        let [mut albedos, mut normals, mut positions] = [Rows::default(); 3];
        lanes.rows(bsdf.albedo(lanes).columns(zero), &mut albedos);
        lanes.rows(normal.columns(zero), &mut normals);
        lanes.rows(surface.position.columns(surface.t), &mut positions);
        for_each_lane(seen, |lane| {
            let path = &vertices.paths[block[lane] as usize];
            let (albedo, normal) = (vec3(albedos[lane]), vec3(normals[lane]));
            let goes_on = mirrors >> lane & 1 == 1;
            match &mut vertices.samples[path.slot as usize].first {
                Some(first) => first.follow(path.throughput, albedo, normal, goes_on),
                first => {
                    let (position, distance) = (vec3(positions[lane]), positions[lane][3]);
                    *first = Some(FirstHit { albedo, normal, position, distance, goes_on });
                }
            }
        });
        *vertices.follows |= mirrors & seen != 0;
    }
}

/// Calls `f` with the number of each bit that is set, the lowest first.
#[inline(always)]
fn for_each_lane(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// A vector and a fourth number.
#[inline(always)]
fn row(v: Vec3, w: f32) -> [f32; 4] {
    [v.x, v.y, v.z, w]
}

/// The first three of four numbers.
#[inline(always)]
fn vec3([x, y, z, _]: [f32; 4]) -> Vec3 {
    Vec3::new(x, y, z)
}
