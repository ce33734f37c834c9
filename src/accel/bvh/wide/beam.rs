//! Rays from one point that run side by side, and what boxes they may enter.

use fearless_simd::{Simd, SimdBase, SimdMask};

use super::node::{self, Floats};
use crate::geom::{BlockRef, SlabRay, grow_own_box};
use crate::math::{Ray, Vec3};
use crate::simd::{Vectors, Width};

/// What holds all rays of a packet.
///
/// Where a ray meets a plane is `(plane - origin) * inverse`, and that is monotone in the inverse,
/// in floating point too: so all rays meet it between where those with the largest and the smallest
/// inverse do. A box that a ray enters is never missed.
pub struct Beam {
    origin: [f32; 4],
    negative: [usize; 3],
    /// Reciprocals for near planes and for far ones, the least and the greatest.
    near: [[f32; 4]; 2],
    far: [[f32; 4]; 2],
    t_min: f32,
}

impl Beam {
    /// That of rays; `None` if they come from several points, or head several ways.
    #[inline(always)]
    pub fn new<'a>(rays: impl IntoIterator<Item = &'a Ray>) -> Option<Self> {
        let mut rays = rays.into_iter();
        let first = rays.next()?;
        let (origin, mut t_min) = (first.origin(), first.t_min());
        let signs = first.direction().is_negative_bitmask();
        let (mut least, mut greatest) = (first.direction(), first.direction());
        let mut alike = true;
        for ray in rays {
            let direction = ray.direction();
            alike &= ray.origin() == origin && direction.is_negative_bitmask() == signs;
            least = least.min(direction);
            greatest = greatest.max(direction);
            t_min = t_min.min(ray.t_min());
        }
        if !alike {
            return None;
        }
        let slab = |direction: Vec3| {
            let ray = Ray::new(origin, direction, 0.0, 1.0);
            (ray != Ray::MISS).then(|| SlabRay::new(&ray))
        };
        let (a, b) = (slab(least)?, slab(greatest)?);
        Some(Self {
            origin: a.origin,
            negative: a.negative,
            near: [a.inv_near, b.inv_near],
            far: [a.inv_far, b.inv_far],
            t_min,
        })
    }

    /// Where the first ray may enter boxes, by their near and far planes along each axis, and the
    /// last may leave them.
    #[inline(always)]
    fn interval<S: Simd, const W: usize>(
        &self,
        simd: S,
        planes: [[Floats<S, W>; 2]; 3],
        t_max: f32,
    ) -> [Floats<S, W>; 2]
    where
        Width: Vectors<W>,
    {
        let mut enter = Floats::<S, W>::splat(simd, self.t_min);
        let mut exit = Floats::<S, W>::splat(simd, t_max);
        for axis in 0..3 {
            let [near, far] = planes[axis];
            let (near, far) = (near - self.origin[axis], far - self.origin[axis]);
            enter = (near * self.near[0][axis]).min(near * self.near[1][axis]).max(enter);
            exit = (far * self.far[0][axis]).max(far * self.far[1][axis]).min(exit);
        }
        [enter, exit]
    }

    /// See [`node::intersect_children`].
    #[inline(always)]
    pub fn intersect_children<S: Simd, const W: usize>(
        &self,
        simd: S,
        planes: &[[f32; W]; 6],
        t_max: f32,
    ) -> ([u32; W], u32)
    where
        Width: Vectors<W>,
    {
        let load = |axis: usize, side: usize| {
            Floats::<S, W>::load_array_ref(simd, &planes[2 * axis + side])
        };
        let [x, y, z] = self.negative.map(|side| side & 1);
        let planes = [
            [load(0, x), load(0, 1 - x)],
            [load(1, y), load(1, 1 - y)],
            [load(2, z), load(2, 1 - z)],
        ];
        let [enter, exit] = self.interval(simd, planes, t_max);
        node::make_keys(simd, enter, exit)
    }

    /// A bit for each triangle of a block whose own box a ray may enter.
    #[inline(always)]
    pub fn enter_triangles<S: Simd, const W: usize>(
        &self,
        simd: S,
        block: &BlockRef<'_, W>,
        t_max: f32,
    ) -> u32
    where
        Width: Vectors<W>,
    {
        let zero = Floats::<S, W>::splat(simd, 0.0);
        let mut planes = [[zero; 2]; 3];
        for axis in 0..3 {
            let load = |vertex: usize| {
                Floats::<S, W>::load_array_ref(simd, &block.vertices[3 * vertex + axis])
            };
            let (a, b, c) = (load(0), load(1), load(2));
            let [lo, hi] = grow_own_box([a.min(b).min(c), a.max(b).max(c)]);
            planes[axis] = if self.negative[axis] == 0 { [lo, hi] } else { [hi, lo] };
        }
        let [enter, exit] = self.interval(simd, planes, t_max);
        enter.simd_le(exit).to_bitmask() as u32
    }
}
