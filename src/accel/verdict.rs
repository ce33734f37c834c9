//! Who says what is hit where the exact test cannot be asked by the structure itself.

use super::ClosestHit;
use crate::geom::Triangle;
use crate::math::{PrimId, Ray};

/// What is known of a block's primitives whose hits a [`Verdict`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlockFilter {
    /// Vertices `a` and `b` are the ends of a box that holds all hits.
    Boxes,
    /// They are triangles whose vertices may be as far off along each axis.
    Near(f32),
}

/// Says what a ray hits of a structure's primitives, where these are no triangles that the exact
/// test could be asked about: placements, or triangles of a mesh in a space of its own.
pub trait Verdict {
    /// The nearest hit of ray number `ray` of the batch with a primitive, at or before the nearest
    /// so far, or for `any` some hit; it counts already.
    ///
    /// A primitive is told by its number and the vertices that the structure has of it.
    fn judge(
        &self,
        ray: usize,
        prim: (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit>;

    /// What a leaf's block of primitives may be filtered by.
    fn filter(&self) -> BlockFilter;

    /// The greatest `t` that counts for a ray, which the batch has in the structure's own measure.
    fn t_max(&self, ray: &Ray) -> f32;

    /// No box that is entered beyond this matters, in the structure's own measure of distance, once
    /// there is a hit at `t`.
    fn limit(&self, t: f32) -> f32;
}
