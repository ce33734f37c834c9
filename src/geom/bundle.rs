//! Bundles: eight rays at once against one box or one triangle.
//!
//! The box test is the slab test's arithmetic, lane by lane ([`super::slab`]), so it says the same
//! of each ray; the triangle test is the filter of [`super::block`] with the lanes given to rays.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};

use super::block::Edges;
use super::{SlabRay, Triangle};
use crate::math::{Aabb, Ray, Vec3};

/// Rays of a bundle.
const LANES: usize = 8;

type Row = [f32; LANES];

/// Up to eight rays as structure of arrays, which all go the same way along each axis.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RayBundle {
    origin: [Row; 3],
    inv_near: [Row; 3],
    inv_far: [Row; 3],
    t_min: Row,
    t_max: Row,
    direction: [Row; 3],
    /// Sums of the magnitudes of the directions' parts.
    norm: Row,
}

impl RayBundle {
    /// Rays of a bundle.
    pub const LANES: usize = LANES;

    /// Without rays: no lane enters anything.
    pub const EMPTY: Self = Self {
        origin: [[0.0; LANES]; 3],
        inv_near: [[1.0; LANES]; 3],
        inv_far: [[1.0; LANES]; 3],
        t_min: [0.0; LANES],
        t_max: [f32::NEG_INFINITY; LANES],
        direction: [[1.0; LANES]; 3],
        norm: [3.0; LANES],
    };

    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        let slab = SlabRay::new(ray);
        let direction = ray.direction();
        for axis in 0..3 {
            self.origin[axis][lane] = slab.origin[axis];
            self.inv_near[axis][lane] = slab.inv_near[axis];
            self.inv_far[axis][lane] = slab.inv_far[axis];
            self.direction[axis][lane] = direction[axis];
        }
        self.norm[lane] = direction.abs().element_sum();
        self.t_min[lane] = ray.t_min();
        self.t_max[lane] = ray.t_max();
    }

    /// Narrows a lane's ray; with minus infinity it enters nothing any more.
    #[inline(always)]
    pub fn end_at(&mut self, lane: usize, t_max: f32) {
        self.t_max[lane] = t_max;
    }

    /// The greatest `o · axis + t_max (d · axis)` of its rays.
    #[inline(always)]
    pub fn end_along<S: Simd>(&self, simd: S, axis: Vec3) -> f32x8<S> {
        let along = |v: [f32x8<S>; 3]| v[0] * axis.x + v[1] * axis.y + v[2] * axis.z;
        let ([origin, direction], [_, t_max]) = (self.rays(simd), self.spans(simd));
        along(origin) + t_max * along(direction)
    }

    /// Origins and directions by axis.
    #[inline(always)]
    pub(super) fn rays<S: Simd>(&self, simd: S) -> [[f32x8<S>; 3]; 2] {
        let load = |row: &Row| f32x8::load_array_ref(simd, row);
        [&self.origin, &self.direction].map(|[x, y, z]| [load(x), load(y), load(z)])
    }

    /// Where the rays begin and end.
    #[inline(always)]
    pub(super) fn spans<S: Simd>(&self, simd: S) -> [f32x8<S>; 2] {
        [&self.t_min, &self.t_max].map(|row| f32x8::load_array_ref(simd, row))
    }

    /// A bit for each ray that enters a box; `negative` is the side of each axis that they enter by.
    #[inline(always)]
    pub fn enter<S: Simd>(&self, simd: S, bounds: &Aabb, negative: [usize; 3]) -> u32 {
        let load = |row: &Row| f32x8::load_array_ref(simd, row);
        let (mut enter, mut exit) = (load(&self.t_min), load(&self.t_max));
        for axis in 0..3 {
            let sides = [bounds.min[axis], bounds.max[axis]];
            let (near, far) = (sides[negative[axis] & 1], sides[1 - (negative[axis] & 1)]);
            let origin = load(&self.origin[axis]);
            let distance =
                |plane: f32, inverse: &Row| (f32x8::splat(simd, plane) - origin) * load(inverse);
            enter = distance(near, &self.inv_near[axis]).max(enter);
            exit = distance(far, &self.inv_far[axis]).min(exit);
        }
        enter.simd_le(exit).to_bitmask() as u32
    }

    /// A bit for each ray that may hit a triangle.
    #[inline(always)]
    pub fn candidates<S: Simd>(&self, simd: S, triangle: &FilterTriangle<S>) -> u32 {
        let load = |row: &Row| f32x8::load_array_ref(simd, row);
        triangle.0.candidates(self.rays(simd), load(&self.norm), load(&self.t_max)) as u32
    }
}

/// A triangle, prepared for bundles.
#[derive(Clone, Copy)]
pub struct FilterTriangle<S: Simd>(Edges<f32x8<S>>);

impl<S: Simd> FilterTriangle<S> {
    /// Prepares a triangle.
    #[inline(always)]
    pub fn new(simd: S, triangle: &Triangle) -> Self {
        let splat = |p: Vec3| [p.x, p.y, p.z].map(|x| f32x8::splat(simd, x));
        Self(Edges::new([splat(triangle.a), splat(triangle.b), splat(triangle.c)]))
    }
}
