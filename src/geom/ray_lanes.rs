//! Sixteen rays side by side, whatever way each of them goes.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, SimdWiden};

use super::block::{BlockRef, Edges};
use super::{SlabRay, Triangle};
use crate::math::{Ray, Vec3};

/// Rays side by side.
const LANES: usize = 16;

/// A number of each ray.
pub(super) type PerRay<T> = [T; LANES];

/// Up to sixteen rays, a lane each. They need not go the same way: of each, what the exact test
/// needs is laid along axes of its own, permuted as [`super::ShearRay`] permutes them.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub struct RayLanes {
    /// Origins and where the rays begin, by lane.
    starts: [[f32; 4]; LANES],
    /// Directions and where they end.
    ways: [[f32; 4]; LANES],
    /// Permuted origins, and reciprocal directions for near planes and far ones.
    pub(super) origin: [PerRay<f32>; 3],
    pub(super) inv_near: [PerRay<f32>; 3],
    pub(super) inv_far: [PerRay<f32>; 3],
    /// See [`super::ShearRay`].
    pub(super) shear: [PerRay<f64>; 3],
    /// The axis that comes first; the two behind it follow in a circle.
    pub(super) first_axis: PerRay<u8>,
}

impl RayLanes {
    /// Rays side by side.
    pub const LANES: usize = LANES;

    /// Without rays.
    pub const EMPTY: Self = Self {
        starts: [[0.0; 4]; LANES],
        ways: [[0.0, 0.0, 1.0, f32::NEG_INFINITY]; LANES],
        origin: [[0.0; LANES]; 3],
        inv_near: [[1.0; LANES]; 3],
        inv_far: [[1.0; LANES]; 3],
        shear: [[0.0; LANES]; 3],
        first_axis: [0; LANES],
    };

    /// Takes up to sixteen rays, and prepares them for the filter; what was in the other lanes
    /// stays.
    #[inline(always)]
    pub fn fill(&mut self, rays: &[Ray]) {
        for (lane, ray) in rays.iter().enumerate().take(LANES) {
            self.put(lane, ray);
        }
    }

    /// Takes a ray.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        let (o, d) = (ray.origin(), ray.direction());
        self.starts[lane % LANES] = [o.x, o.y, o.z, ray.t_min()];
        self.ways[lane % LANES] = [d.x, d.y, d.z, ray.t_max()];
    }

    /// Narrows a lane's ray, for the filter.
    #[inline(always)]
    pub fn end_at(&mut self, lane: usize, t_max: f32) {
        self.ways[lane % LANES][3] = t_max;
    }

    /// The rays from lane `from` on, as many as a vector has lanes: origin and `t_min`, direction
    /// and `t_max`.
    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, from: usize) -> [[S::f32s; 4]; 2] {
        [load_columns(simd, &self.starts, from), load_columns(simd, &self.ways, from)]
    }

    /// Of each triangle of a block, of those in `asked`, a bit for each ray that may hit it.
    #[inline(always)]
    pub fn find_candidates<S: Simd, const W: usize>(
        &self,
        simd: S,
        block: &BlockRef<'_, W>,
        mut asked: u32,
    ) -> [u32; W] {
        let mut candidates = [0; W];
        while asked != 0 {
            let number = asked.trailing_zeros() as usize % W;
            asked &= asked - 1;
            let Triangle { a, b, c } = block.triangle(number);
            let splat = |p: Vec3| {
                let part = |x: f32| S::f32s::splat(simd, x);
                [part(p.x), part(p.y), part(p.z)]
            };
            let edges = Edges::new([splat(a), splat(b), splat(c)]);
            for from in (0..LANES).step_by(S::f32s::LEN) {
                let [[ox, oy, oz, _], [dx, dy, dz, t_max]] = self.load(simd, from);
                let length = dx.abs() + dy.abs() + dz.abs();
                let passes = edges.find_candidates([[ox, oy, oz], [dx, dy, dz]], length, t_max);
                let all = (1_u64 << S::f32s::LEN) - 1;
                candidates[number] |= ((passes & all) as u32) << from;
            }
        }
        candidates
    }

    /// Prepares them for the exact test.
    ///
    /// The arithmetic is that of [`super::SlabRay`] and [`super::ShearRay`], lane by lane.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S) {
        for from in (0..LANES).step_by(S::f32s::LEN) {
            self.prepare_from(simd, from);
        }
    }

    #[inline(always)]
    fn prepare_from<S: Simd>(&mut self, simd: S, from: usize) {
        let len = S::f32s::LEN;
        let [[ox, oy, oz, _], [dx, dy, dz, _]] = self.load(simd, from);
        let (ax, ay, az) = (dx.abs(), dy.abs(), dz.abs());
        let (y_wins, z_wins) = (ay.simd_gt(ax), az.simd_gt(ax.max(ay)));
        let (y_bits, z_bits) = (y_wins.to_bitmask(), z_wins.to_bitmask());
        for lane in 0..len {
            let (y, z) = (y_bits >> lane & 1, z_bits >> lane & 1);
            self.first_axis[from + lane] = ((1 + y) * (1 - z)) as u8;
        }
        let turn = |[x, y, z]: [S::f32s; 3]| {
            [
                z_wins.select(x, y_wins.select(z, y)),
                z_wins.select(y, y_wins.select(x, z)),
                z_wins.select(z, y_wins.select(y, x)),
            ]
        };
        let (origin, direction) = (turn([ox, oy, oz]), turn([dx, dy, dz]));
        for axis in 0..3 {
            origin[axis].store_slice(&mut self.origin[axis][from..from + len]);
            let size = direction[axis].abs().max(SlabRay::SMALLEST).copysign(direction[axis]);
            let inverse = S::f32s::splat(simd, 1.0) / size;
            let (near, far) = (inverse * (1.0 - SlabRay::SLACK), inverse * (1.0 + SlabRay::SLACK));
            near.store_slice(&mut self.inv_near[axis][from..from + len]);
            far.store_slice(&mut self.inv_far[axis][from..from + len]);
        }
        let (x, y, z) = (direction[0].widen(), direction[1].widen(), direction[2].widen());
        self.prepare_shear(simd, from, [x.0, y.0, z.0]);
        self.prepare_shear(simd, from + len / 2, [x.1, y.1, z.1]);
    }

    #[inline(always)]
    fn prepare_shear<S: Simd>(&mut self, simd: S, at: usize, [x, y, z]: [S::f64s; 3]) {
        let lanes = at..at + S::f64s::LEN;
        let scale = S::f64s::splat(simd, 1.0) / z;
        (x * scale).store_slice(&mut self.shear[0][lanes.clone()]);
        (y * scale).store_slice(&mut self.shear[1][lanes.clone()]);
        scale.store_slice(&mut self.shear[2][lanes]);
    }
}

/// The columns of rows of four, from row `from` on, as many as a vector has lanes.
#[inline(always)]
pub(super) fn load_columns<S: Simd>(simd: S, rows: &PerRay<[f32; 4]>, from: usize) -> [S::f32s; 4] {
    let len = S::f32s::LEN;
    let values = &rows.as_flattened()[4 * from..4 * (from + len)];
    let load = |i: usize| S::f32s::from_slice(simd, &values[i * len..(i + 1) * len]);
    let (even, odd) = load(0).deinterleave(load(1));
    let (more_even, more_odd) = load(2).deinterleave(load(3));
    let ([x, z], [y, w]) = (even.deinterleave(more_even).into(), odd.deinterleave(more_odd).into());
    [x, y, z, w]
}

/// The other way round.
#[inline(always)]
pub(super) fn store_columns<S: Simd>(
    [x, y, z, w]: [S::f32s; 4],
    rows: &mut PerRay<[f32; 4]>,
    from: usize,
) {
    let len = S::f32s::LEN;
    let values = &mut rows.as_flattened_mut()[4 * from..4 * (from + len)];
    let ((even, more_even), (odd, more_odd)) = (x.interleave(z), y.interleave(w));
    let ((a, b), (c, d)) = (even.interleave(odd), more_even.interleave(more_odd));
    a.store_slice(&mut values[..len]);
    b.store_slice(&mut values[len..2 * len]);
    c.store_slice(&mut values[2 * len..3 * len]);
    d.store_slice(&mut values[3 * len..]);
}
