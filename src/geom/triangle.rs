//! Triangles.

use crate::math::{Aabb, Vec3};

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
    /// Its vertices.
    #[inline(always)]
    pub fn corners(&self) -> [Vec3; 3] {
        [self.a, self.b, self.c]
    }

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
