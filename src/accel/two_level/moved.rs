//! What moves, where it is at a ray's time.

use fearless_simd::Simd;

use super::verdict::Inside;
use crate::accel::{ClosestHit, PreparedRay, Query};
use crate::geom::{Motions, Triangle};
use crate::math::{Affine3A, InstanceId, PrimId, TriangleId};

/// What moves and a ray is in.
#[derive(Clone, Copy, Default)]
pub enum Within {
    /// A mesh that keeps its shape.
    #[default]
    Stiff,
    /// A mesh that changes its shape.
    Deforming,
    /// A body, by its number.
    Body(usize),
}

/// A placement at the time of a ray.
#[derive(Clone, Copy, Default)]
pub struct Moved {
    /// Which it is, and when.
    at: Option<(InstanceId, f32)>,
    /// Where that stands.
    to_world: Affine3A,
    /// What the ray is in.
    pub within: Within,
}

impl Moved {
    /// Where a placement stands at a time, as is known from the last time or found.
    #[inline(always)]
    pub fn find(&mut self, at: (InstanceId, f32), motions: &dyn Motions) -> Affine3A {
        if self.at != Some(at) {
            (self.at, self.to_world) = (Some(at), motions.to_world_at(at.0, at.1));
        }
        self.to_world
    }
}

/// What the exact test says of a triangle of a placement at a time, by its corners in the mesh's
/// space.
#[inline(always)]
pub fn test_at<S: Simd, Q: Query>(
    simd: S,
    motions: &dyn Motions,
    (TriangleId { instance: placement, index }, corners, time): (TriangleId, &Triangle, f32),
    (world, query): (&PreparedRay<'_>, &Q),
    moved: &mut Moved,
) -> Option<ClosestHit> {
    let to_world = moved.find((placement, time), motions);
    let inside = Inside::new(placement, 0.0, 0.0);
    inside.test(simd, (&to_world, world), (PrimId(index), corners), &query.nearest(), Q::ANY)
}
