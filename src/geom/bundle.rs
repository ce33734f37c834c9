//! Bundles: eight rays at once against one box or one triangle.
//!
//! The box test is the slab test's arithmetic, lane by lane ([`super::slab`]), so it says the same
//! of each ray. The triangle test is the filter of [`super::block`], with one ray a lane.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x8, mask32x8};

use super::block::Edges;
use super::heading::Heading;
use super::slab::{FARTHEST_ALONG, INVERSE_ALONG};
use super::{SlabRay, Triangle};
use crate::math::{Aabb, Ray, Vec3};

/// Rays of a bundle.
const LANES: usize = 8;

type PerRay = [f32; LANES];

/// Up to eight rays as structure of arrays, which all go the same way along each axis.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct RayBundle {
    pub(super) origin: [PerRay; 3],
    inv_near: [PerRay; 3],
    inv_far: [PerRay; 3],
    t_min: PerRay,
    t_max: PerRay,
    direction: [PerRay; 3],
    /// Sums of the magnitudes of the directions' parts.
    norm: PerRay,
    /// Of each ray what [`super::ShearRay`] is by.
    pub(super) shear: [[f64; LANES]; 3],
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
        shear: [[1.0; LANES]; 3],
    };

    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        let (origin, direction) = (ray.origin(), ray.direction());
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.direction[axis][lane] = direction[axis];
        }
        self.t_min[lane] = ray.t_min();
        self.t_max[lane] = ray.t_max();
    }

    /// Prepares its rays for boxes and triangles; all must head that way.
    ///
    /// The arithmetic is that of [`super::SlabRay`] and [`super::ShearRay`], lane by lane.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S, heading: Heading) {
        let [_, direction] = self.rays(simd);
        for axis in 0..3 {
            let size = direction[axis].abs().max(SlabRay::SMALLEST).copysign(direction[axis]);
            let inverse = f32x8::splat(simd, 1.0) / size;
            self.inv_near[axis] = (inverse * (1.0 - SlabRay::SLACK)).to_array();
            self.inv_far[axis] = (inverse * (1.0 + SlabRay::SLACK)).to_array();
        }
        self.norm = (direction[0].abs() + direction[1].abs() + direction[2].abs()).to_array();
        let [x, y, z] = heading.axes.map(|axis| self.direction[axis]);
        for lane in 0..LANES {
            let scale = 1.0 / f64::from(z[lane]);
            self.shear[0][lane] = f64::from(x[lane]) * scale;
            self.shear[1][lane] = f64::from(y[lane]) * scale;
            self.shear[2][lane] = scale;
        }
    }

    /// Narrows a lane's ray; with minus infinity it enters nothing any more.
    #[inline(always)]
    pub fn end_at(&mut self, lane: usize, t_max: f32) {
        self.t_max[lane] = t_max;
    }

    /// The greatest `o · axis + t_max (d · axis)` of its rays.
    #[inline(always)]
    pub fn end_along<S: Simd>(&self, simd: S, axis: Vec3) -> f32x8<S> {
        let ([o, d], [_, t_max]) = (self.rays(simd), self.spans(simd));
        dot(o, axis) + t_max * dot(d, axis)
    }

    /// Origins and directions by axis.
    #[inline(always)]
    pub fn rays<S: Simd>(&self, simd: S) -> [[f32x8<S>; 3]; 2] {
        let (o, d) = (&self.origin, &self.direction);
        [
            [
                f32x8::load_array_ref(simd, &o[0]),
                f32x8::load_array_ref(simd, &o[1]),
                f32x8::load_array_ref(simd, &o[2]),
            ],
            [
                f32x8::load_array_ref(simd, &d[0]),
                f32x8::load_array_ref(simd, &d[1]),
                f32x8::load_array_ref(simd, &d[2]),
            ],
        ]
    }

    /// Where the rays begin and end.
    #[inline(always)]
    pub fn spans<S: Simd>(&self, simd: S) -> [f32x8<S>; 2] {
        [f32x8::load_array_ref(simd, &self.t_min), f32x8::load_array_ref(simd, &self.t_max)]
    }

    /// A bit for each ray that enters a box; `negative` is the side of each axis that they enter
    /// by.
    #[inline(always)]
    pub fn enter<S: Simd>(&self, simd: S, bounds: &Aabb, negative: [usize; 3]) -> u32 {
        let (enter, exit) = self.interval(simd, bounds, negative);
        let [t_min, t_max] = self.spans(simd);
        enter.max(t_min).simd_le(exit.min(t_max)).to_bitmask() as u32
    }

    /// [`SlabRay::is_beyond`] of each ray.
    #[inline(always)]
    pub(super) fn are_beyond<S: Simd>(&self, simd: S, t: f32x8<S>, exit: f32x8<S>) -> mask32x8<S> {
        let load = |axis: usize| f32x8::load_array_ref(simd, &self.inv_near[axis]).abs();
        let largest = load(0).max(load(1)).max(load(2));
        t.simd_gt(exit) & exit.simd_ge(FARTHEST_ALONG) & largest.simd_ge(INVERSE_ALONG)
    }

    /// See [`SlabRay::interval`].
    #[inline(always)]
    pub fn interval<S: Simd>(
        &self,
        simd: S,
        bounds: &Aabb,
        negative: [usize; 3],
    ) -> (f32x8<S>, f32x8<S>) {
        let (mut enter, mut exit) =
            (f32x8::splat(simd, f32::NEG_INFINITY), f32x8::splat(simd, f32::INFINITY));
        for axis in 0..3 {
            let sides = [bounds.min[axis], bounds.max[axis]];
            let (near, far) = (sides[negative[axis] & 1], sides[1 - (negative[axis] & 1)]);
            let origin = f32x8::load_array_ref(simd, &self.origin[axis]);
            let inverse = f32x8::load_array_ref(simd, &self.inv_near[axis]);
            enter = ((f32x8::splat(simd, near) - origin) * inverse).max(enter);
            let inverse = f32x8::load_array_ref(simd, &self.inv_far[axis]);
            exit = ((f32x8::splat(simd, far) - origin) * inverse).min(exit);
        }
        (enter, exit)
    }

    /// A bit for each ray that may hit a triangle.
    #[inline(always)]
    pub fn find_candidates<S: Simd>(&self, simd: S, triangle: &FilterTriangle<S>) -> u32 {
        let norm = f32x8::load_array_ref(simd, &self.norm);
        triangle.0.find_candidates(self.rays(simd), norm, self.spans(simd)[1]) as u32
    }
}

/// A triangle, prepared for bundles.
#[derive(Clone, Copy)]
pub struct FilterTriangle<S: Simd>(Edges<f32x8<S>>);

impl<S: Simd> FilterTriangle<S> {
    /// Prepares a triangle.
    #[inline(always)]
    pub fn new(simd: S, triangle: &Triangle) -> Self {
        Self(Edges::new([
            splat(simd, triangle.a),
            splat(simd, triangle.b),
            splat(simd, triangle.c),
        ]))
    }
}

/// The same point in all lanes.
#[inline(always)]
fn splat<S: Simd>(simd: S, p: Vec3) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, p.x), f32x8::splat(simd, p.y), f32x8::splat(simd, p.z)]
}

/// The part of vectors along another.
#[inline(always)]
pub(super) fn dot<S: Simd>(a: [f32x8<S>; 3], b: Vec3) -> f32x8<S> {
    a[0] * b.x + a[1] * b.y + a[2] * b.z
}
