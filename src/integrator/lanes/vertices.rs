//! Paths in columns, and the rows that blocks of them are computed from.

use super::super::path::PathTracer;
use super::super::shadow_rays::ShadowRays;
use super::super::state::{Path, PathSample};
use super::solids::SolidRows;
use crate::accel::ClosestHit;
use crate::math::{InstanceId, Ray, Vec3};
use crate::sampling::StreamId;
use crate::simd::lanes::{Lanes, Rows};
use crate::world::lanes::{LightRows, SurfaceRows};

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
pub(super) struct VertexRows {
    pub direction: Rows,
    /// And the square of the indices of refraction that were passed.
    pub throughput: Rows,
    /// Key and index of the streams, as bits.
    pub stream: Rows,
    pub surface: SurfaceRows,
    /// Only for surfaces that let light pass.
    pub solids: SolidRows,
}

/// Where blocks of paths put rows; one for many blocks, since it takes time to clear.
#[derive(Default)]
pub(super) struct Scratch {
    pub light: LightRows,
    pub out: [Rows; 5],
}

/// A block of paths that cross their vertices together.
pub(super) struct Block<'b, 'a, L> {
    pub integrator: &'b PathTracer<'b>,
    pub lanes: L,
    /// The number of the segments that end here.
    pub depth: u32,
    /// The paths, by lane; there may be more lanes.
    pub paths: &'b [u32],
    pub scratch: &'b mut Scratch,
    pub vertices: &'b mut Vertices<'a>,
}

impl VertexRows {
    /// Fetches all that a block's paths need, of the BSDF that many rows; unused lanes repeat the
    /// last path.
    #[inline(always)]
    pub fn fetch<L: Lanes>(&mut self, block: &Block<'_, '_, L>, bsdf_rows: usize, transmits: bool) {
        let (world, vertices) = (block.integrator.world(), &block.vertices);
        if transmits {
            self.solids.clear();
        }
        for lane in 0..L::WIDTH {
            let i = block.paths[lane.min(block.paths.len() - 1)] as usize;
            let (path, hit) = (&vertices.paths[i], &vertices.hits[i]);
            let direction = vertices.rays[i].direction();
            self.direction[lane] = row(direction, 0.0);
            self.throughput[lane] = row(path.throughput, path.eta_squared);
            let StreamId { key, index } = path.stream;
            self.stream[lane] = [f32::from_bits(key), f32::from_bits(index), 0.0, 0.0];
            let hit = (hit, path.time);
            self.surface.fetch(lane, world, vertices.triangles[i], hit, bsdf_rows);
            if transmits {
                self.solids.fetch(lane, world, vertices.triangles[i].0, path);
            }
        }
    }
}

/// Calls `f` with the number of each bit that is set, the lowest first.
#[inline(always)]
pub(super) fn for_each_lane(mut bits: u32, mut f: impl FnMut(usize)) {
    while bits != 0 {
        f(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// A vector and a fourth number.
#[inline(always)]
pub(super) fn row(v: Vec3, w: f32) -> [f32; 4] {
    [v.x, v.y, v.z, w]
}

/// The first three of four numbers.
#[inline(always)]
pub(super) fn vec3([x, y, z, _]: [f32; 4]) -> Vec3 {
    Vec3::new(x, y, z)
}
