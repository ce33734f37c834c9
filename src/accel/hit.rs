//! What rays hit, and which hits count.

use crate::math::TriangleId;

/// Takes back hits, for instance in the holes of a leaf's texture.
pub trait HitFilter: Sync {
    /// Whether a hit of the batch's ray number `ray` counts.
    ///
    /// Must be a pure function of its arguments: structures differ in which hits they ask about,
    /// how often and in which order.
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool;
}

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ClosestHit {
    /// Distance in multiples of the ray's direction; infinite on a miss.
    pub t: f32,
    /// Weight of the triangle's second vertex.
    pub u: f32,
    /// Weight of its third vertex.
    pub v: f32,
    /// The triangle; [`TriangleId::NONE`] on a miss.
    pub triangle: TriangleId,
}

impl ClosestHit {
    /// No hit.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: TriangleId::NONE };

    /// Whether anything was hit.
    #[inline(always)]
    pub fn is_hit(&self) -> bool {
        self.triangle != TriangleId::NONE
    }

    /// Whether it is nearer, or as near and of a triangle before the other's.
    #[inline(always)]
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }

    /// The same hit to the bit; what tests compare by.
    pub fn same_bits(&self, other: &Self) -> bool {
        bytemuck::bytes_of(self) == bytemuck::bytes_of(other)
    }
}

/// Whether a ray hits anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct AnyHit(pub bool);
