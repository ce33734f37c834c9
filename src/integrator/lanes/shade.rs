//! The steps of a vertex, in order.

use super::super::dimensions::{choice_dimension, direction_dimension, light_dimension};
use super::super::path::PathTracer;
use super::super::state::FirstHit;
use super::vertices::{Block, Scratch, VertexRows, Vertices, for_each_lane, vec3};
use crate::material::lanes::BsdfLanes;
use crate::sampling::SamplerLanes;
use crate::simd::lanes::{Float, Lanes, Mask, Rows, Vec3f};
use crate::world::lanes::SurfaceLanes;

/// What a block of paths has come to.
pub(super) struct VertexLanes<L: Lanes> {
    /// The lanes that hold a path.
    pub live: L::Mask,
    pub throughput: Vec3f<L>,
    pub eta_squared: L::Float,
    pub surface: SurfaceLanes<L>,
    /// Whose surface bounds a solid, and who arrived inside of it.
    pub solid: L::Mask,
    pub inside: L::Mask,
    /// Towards the viewer; local.
    pub wo: Vec3f<L>,
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
    for paths in order.chunks(L::WIDTH) {
        let scratch = &mut scratch;
        let mut block = Block { integrator, lanes, depth, paths, scratch, vertices };
        rows.fetch(&block, B::ROWS, B::TRANSMITS);
        let lost = shade_block::<L, B>(&mut block, &rows);
        for_each_lane(lost, |lane| rest.push(paths[lane]));
    }
}

/// The steps of a vertex; a bit for each lane that was left as it was.
#[inline(always)]
fn shade_block<L: Lanes, B: BsdfLanes<L>>(block: &mut Block<'_, '_, L>, rows: &VertexRows) -> u32 {
    let (lanes, depth, world) = (block.lanes, block.depth, block.integrator.world());
    // The surfaces, and how they scatter light.
    let direction = Vec3f::of_columns(lanes.columns(&rows.direction));
    let surface = SurfaceLanes::new(lanes, world, &rows.surface, direction);
    let wo = surface.frame.to_local(-direction);
    let bsdf = B::load(lanes, &rows.surface.bsdf, world.form(), wo);
    let [r, g, b, eta_squared] = lanes.columns(&rows.throughput);
    let throughput = Vec3f::new(r, g, b);
    let [key, index, ..] = lanes.columns(&rows.stream);
    let sampler = SamplerLanes::<L>::new(key.to_bits(), index.to_bits());
    let [u_lobe, u_roulette, u_light, _] = sampler.set(lanes, choice_dimension(depth));
    let (live, none) = (lanes.first(block.paths.len()), lanes.mask(0));
    let mut vertex =
        VertexLanes { live, throughput, eta_squared, surface, solid: none, inside: none, wo };
    if B::TRANSMITS {
        vertex.solid = rows.solids.solids(lanes);
        (vertex.throughput, vertex.inside) = rows.solids.absorb(lanes, &surface, throughput);
    }

    // Sample direct light.
    let lost = if B::IS_DELTA || world.lights.is_dark() {
        (live & !surface.valid).to_bits()
    } else {
        let u = sampler.pair(lanes, light_dimension(depth));
        vertex.sample_direct(block, &bsdf, u_light, u)
    };
    vertex.live = live & !lanes.mask(lost);
    if depth == 1 || *block.vertices.follows {
        vertex.describe_first_hits(block, &bsdf);
    }

    // Sample the BSDF for the next direction, and perhaps end the path there.
    let u = sampler.pair(lanes, direction_dimension(depth));
    let scattered = bsdf.sample(lanes, wo, u_lobe, u);
    vertex.scatter::<B>(block, &scattered, u_roulette);
    lost
}

impl<L: Lanes> VertexLanes<L> {
    /// What is seen of the surfaces, apart from their light; see [`super::super::first_hit`].
    #[inline(always)]
    fn describe_first_hits<B: BsdfLanes<L>>(&self, block: &mut Block<'_, '_, L>, bsdf: &B) {
        let Block { lanes, depth, paths, vertices, .. } = block;
        let lanes = *lanes;
        let slot = |lane: usize| vertices.paths[paths[lane] as usize].slot as usize;
        let mut seen = self.live.to_bits();
        if *depth > 1 {
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
        let [mut albedos, mut normals, mut positions, mut throughputs] = [Rows::default(); 4];
        lanes.rows(bsdf.albedo(lanes).columns(zero), &mut albedos);
        lanes.rows(normal.columns(zero), &mut normals);
        lanes.rows(surface.position.columns(surface.t), &mut positions);
        lanes.rows(self.throughput.columns(zero), &mut throughputs);
        for_each_lane(seen, |lane| {
            let path = &vertices.paths[paths[lane] as usize];
            let (albedo, normal) = (vec3(albedos[lane]), vec3(normals[lane]));
            let goes_on = mirrors >> lane & 1 == 1;
            match &mut vertices.samples[path.slot as usize].first {
                Some(first) => first.follow(vec3(throughputs[lane]), albedo, normal, goes_on),
                first => {
                    let (position, distance) = (vec3(positions[lane]), positions[lane][3]);
                    *first = Some(FirstHit { albedo, normal, position, distance, goes_on });
                }
            }
        });
        *vertices.follows |= mirrors & seen != 0;
    }
}
