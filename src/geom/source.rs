//! Triangles in world space, and where they come from.

use crate::math::{Aabb, TriangleId, Vec3};

/// A triangle; a hit's barycentrics `u` and `v` belong to `b` and `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Triangle {
    /// First vertex, with weight `1 - u - v`.
    pub a: Vec3,
    /// Second vertex, with weight `u`.
    pub b: Vec3,
    /// Third vertex, with weight `v`.
    pub c: Vec3,
}

impl Triangle {
    /// The smallest box of its vertices.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        Aabb { min: self.a.min(self.b).min(self.c), max: self.a.max(self.b).max(self.c) }
    }

    /// The cross product of two edges: along the normal of the front, of twice the area's length.
    #[inline]
    pub fn double_area(&self) -> Vec3 {
        (self.b - self.a).cross(self.c - self.a)
    }
}

/// The vertices of a triangle, axis by axis, wherever they lie.
pub trait Corners {
    /// The coordinates of `a`, `b` and `c` along an axis below 3.
    fn along(&self, axis: usize) -> [f32; 3];
}

impl Corners for Triangle {
    #[inline(always)]
    fn along(&self, axis: usize) -> [f32; 3] {
        [self.a.to_array()[axis], self.b.to_array()[axis], self.c.to_array()[axis]]
    }
}

/// Hands out the triangles of a scene in world space, by an id that counts all instances through.
///
/// Vertices are finite, and the answer for an id never changes: structures may ask when they are
/// built, or again for every ray.
pub trait TriangleSource: Send + Sync {
    /// The number of triangles; ids run from 0 to it, exclusively.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A triangle's vertices in world space.
    fn triangle(&self, id: TriangleId) -> Triangle;
}

/// Triangles that are already in world space.
#[derive(Clone, Debug, Default)]
pub struct TriangleList(pub Vec<Triangle>);

impl TriangleSource for TriangleList {
    fn len(&self) -> usize {
        self.0.len()
    }

    #[inline]
    fn triangle(&self, id: TriangleId) -> Triangle {
        self.0[id.index()]
    }
}
