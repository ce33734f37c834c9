//! The exact test for sixteen pairs of a ray and a triangle at once: a pair each lane.
//!
//! It does what [`super::intersect_triangle()`] does, the same additions and multiplications in the
//! same order, lane by lane, so it computes the same bits; a test holds it to that. Neither rays
//! nor triangles have anything in common: each lane's vertices are laid along the axes as its ray
//! has permuted them.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, SimdNarrow, SimdWiden};

use super::intersect_triangle::{DISTANCE_BOUND, EDGE_ON};
use super::ray_lanes::{PerRay, RayLanes, load_columns};
use super::slab::{FARTHEST_ALONG, INVERSE_ALONG, own_box};
use super::source::Triangle;

const LANES: usize = RayLanes::LANES;

/// A triangle for lanes, in which all orders of axes that rays may have lie one after the other.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub struct PairTriangle {
    /// For axes x, y, z, x, y: the coordinates of a, b and c, and where the own box begins.
    rows: [[f32; 4]; 5],
    /// Where the own box ends, along the same axes; then zeros.
    ends: [f32; 12],
}

impl PairTriangle {
    /// Lays out a triangle.
    pub fn new(triangle: &Triangle) -> Self {
        let (mut rows, mut ends) = ([[0.0; 4]; 5], [0.0; 12]);
        let bounds = own_box(triangle);
        for at in 0..5 {
            let axis = at % 3;
            let Triangle { a, b, c } = triangle;
            rows[at] = [a[axis], b[axis], c[axis], bounds.min[axis]];
            ends[at] = bounds.max[axis];
        }
        Self { rows, ends }
    }
}

/// What lanes found.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairHits {
    /// A bit for each lane whose ray hits its triangle, not limited by the ray's own interval.
    pub hits: u32,
    /// Distances.
    pub t: PerRay<f32>,
    /// Weights of second vertices.
    pub u: PerRay<f32>,
    /// Weights of third vertices.
    pub v: PerRay<f32>,
}

/// The triangles of lanes, axis by axis as their rays have them, then the ends of own boxes.
type Rows = [[[f32; 4]; LANES]; 4];

impl RayLanes {
    /// Finds which of the rays in `lanes`, prepared, hit the triangle of their lane, and where.
    #[inline(always)]
    pub fn intersect_pairs<S: Simd>(
        &self,
        simd: S,
        lanes: u32,
        triangles: &[PairTriangle],
        numbers: &PerRay<u8>,
        found: &mut PairHits,
    ) {
        let mut rows: Rows = [[[0.0; 4]; LANES]; 4];
        let mut rest = lanes & 0xffff;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let triangle = &triangles[usize::from(numbers[lane])];
            let first = usize::from(self.first_axis[lane]).min(2);
            for along in 0..3 {
                rows[along][lane] = triangle.rows[first + along];
            }
            let ends = &triangle.ends[first..first + 4];
            rows[3][lane].copy_from_slice(ends);
        }
        found.hits = 0;
        let width = S::f32s::LEN;
        for from in (0..LANES).step_by(width) {
            if lanes >> from & ((1_u64 << width) - 1) as u32 != 0 {
                self.intersect_from(simd, from, &rows, found);
            }
        }
        found.hits &= lanes;
    }

    /// Shear and scale of the rays from lane `at` on.
    #[inline(always)]
    fn load_shear<S: Simd>(&self, simd: S, at: usize) -> [S::f64s; 3] {
        let load = |row: &PerRay<f64>| S::f64s::from_slice(simd, &row[at..at + S::f64s::LEN]);
        [load(&self.shear[0]), load(&self.shear[1]), load(&self.shear[2])]
    }

    /// The same for the lanes of one vector.
    #[inline(always)]
    fn intersect_from<S: Simd>(&self, simd: S, from: usize, rows: &Rows, found: &mut PairHits) {
        let len = S::f32s::LEN;
        let load = |row: &PerRay<[f32; 4]>| load_columns(simd, row, from);
        let own = |row: &PerRay<f32>| S::f32s::from_slice(simd, &row[from..from + len]);
        let axes = [load(&rows[0]), load(&rows[1]), load(&rows[2])];
        let ends = load(&rows[3]);
        let origin = [own(&self.origin[0]), own(&self.origin[1]), own(&self.origin[2])];
        let corner = |i: usize| [axes[0][i], axes[1][i], axes[2][i]];
        let (o0, o1) = widen_point::<S>(origin);
        let (a0, a1) = widen_point::<S>(corner(0));
        let (b0, b1) = widen_point::<S>(corner(1));
        let (c0, c1) = widen_point::<S>(corner(2));
        let half = len / 2;
        let (low, high) = (self.load_shear(simd, from), self.load_shear(simd, from + half));
        let (t0, u0, v0, misses0) = intersect_half(simd, [a0, b0, c0], o0, low);
        let (t1, u1, v1, misses1) = intersect_half(simd, [a1, b1, c1], o1, high);
        let misses = misses0 | misses1 << half;
        let (t, u, v) = (t0.narrow(t1), u0.narrow(u1), v0.narrow(v1));

        // The interval in the own box.
        let mut enter = S::f32s::splat(simd, f32::NEG_INFINITY);
        let mut exit = S::f32s::splat(simd, f32::INFINITY);
        let mut largest = S::f32s::splat(simd, 0.0);
        for axis in 0..3 {
            let (lo, hi) = (axes[axis][3], ends[axis]);
            let (near, far) = (own(&self.inv_near[axis]), own(&self.inv_far[axis]));
            let down = near.simd_lt(0.0);
            enter = ((down.select(hi, lo) - origin[axis]) * near).max(enter);
            exit = ((down.select(lo, hi) - origin[axis]) * far).min(exit);
            largest = near.abs().max(largest);
        }
        let beyond = t.simd_gt(exit)
            & exit.simd_ge(FARTHEST_ALONG)
            & largest.simd_ge(INVERSE_ALONG);
        let taken = enter.simd_le(exit) & t.simd_lt(f32::INFINITY) & !beyond;
        found.hits |= ((taken.to_bitmask() & !misses) as u32) << from;
        t.max(enter).min(exit).store_slice(&mut found.t[from..from + len]);
        u.store_slice(&mut found.u[from..from + len]);
        v.store_slice(&mut found.v[from..from + len]);
    }
}

/// Points in double precision: lower half of the lanes, and upper.
#[inline(always)]
fn widen_point<S: Simd>([x, y, z]: [S::f32s; 3]) -> ([S::f64s; 3], [S::f64s; 3]) {
    let ((x0, x1), (y0, y1), (z0, z1)) = (x.widen(), y.widen(), z.widen());
    ([x0, y0, z0], [x1, y1, z1])
}

/// Where rays meet triangles, `t`, `u` and `v`, and a bit for each lane that misses; of half a
/// vector's lanes, by vertices and origins.
#[inline(always)]
fn intersect_half<S: Simd>(
    simd: S,
    [a, b, c]: [[S::f64s; 3]; 3],
    origin: [S::f64s; 3],
    shear: [S::f64s; 3],
) -> (S::f64s, S::f64s, S::f64s, u64) {
    let a = project::<S>(a, origin, shear);
    let b = project::<S>(b, origin, shear);
    let c = project::<S>(c, origin, shear);
    let (p0, q0) = (c[0] * b[1], c[1] * b[0]);
    let (p1, q1) = (a[0] * c[1], a[1] * c[0]);
    let (p2, q2) = (b[0] * a[1], b[1] * a[0]);
    let (w0, w1, w2) = (p0 - q0, p1 - q1, p2 - q2);
    let outside = (w0.simd_lt(0.0) | w1.simd_lt(0.0) | w2.simd_lt(0.0))
        & (w0.simd_gt(0.0) | w1.simd_gt(0.0) | w2.simd_gt(0.0));
    let det = w0 + w1 + w2;
    let magnitude = (p0.abs() + q0.abs()) + (p1.abs() + q1.abs()) + (p2.abs() + q2.abs());
    let edge_on = det.abs().simd_le(magnitude * EDGE_ON);
    let distance = w0 * a[2] + w1 * b[2] + w2 * c[2];
    let depth = a[2].abs().max(b[2].abs()).max(c[2].abs());
    let on_it = distance.abs().simd_le(magnitude * DISTANCE_BOUND * depth);
    let misses = (outside | edge_on | on_it).to_bitmask();
    let inv_det = S::f64s::splat(simd, 1.0) / det;
    (distance * inv_det, w1 * inv_det, w2 * inv_det, misses)
}

/// Projects vertices: each ray is its third axis.
#[inline(always)]
fn project<S: Simd>(
    [x, y, z]: [S::f64s; 3],
    origin: [S::f64s; 3],
    shear: [S::f64s; 3],
) -> [S::f64s; 3] {
    let (x, y, z) = (x - origin[0], y - origin[1], z - origin[2]);
    [x - z * shear[0], y - z * shear[1], z * shear[2]]
}
