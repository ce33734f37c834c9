//! The exact test for sixteen pairs of a ray and a triangle at once: a pair each lane.
//!
//! It does what [`super::intersect_triangle()`] does, the same additions and multiplications in the
//! same order, lane by lane, so it computes the same bits; a test holds it to that. Neither rays
//! nor triangles have anything in common: each lane's vertices are laid along the axes as its ray
//! has permuted them.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, SimdNarrow, SimdWiden};

use super::ray_lanes::{PerRay, RayLanes, load_columns, store_columns};
use super::sheared::intersect_sheared;
use super::slab::{FARTHEST_ALONG, INVERSE_ALONG, own_box};
use super::triangle::Triangle;
use crate::math::PrimId;

const LANES: usize = RayLanes::LANES;

/// A triangle for lanes, in which all orders of axes that rays may have lie one after the other.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub struct PairTriangle {
    /// For axes x, y, z, x, y: the coordinates of a, b and c, and where the own box begins.
    rows: [[f32; 4]; 5],
    /// Where the own box ends along x, y, z, and the id as its bits; the same for y, z, x and for
    /// z, x, y.
    ends: [[f32; 4]; 3],
}

impl PairTriangle {
    /// Lays out a triangle.
    pub fn new(id: PrimId, triangle: &Triangle) -> Self {
        let (mut rows, mut ends) = ([[0.0; 4]; 5], [[0.0; 4]; 3]);
        let (Triangle { a, b, c }, bounds) = (triangle, own_box(triangle));
        for at in 0..5 {
            let axis = at % 3;
            rows[at] = [a[axis], b[axis], c[axis], bounds.min[axis]];
        }
        for first in 0..3 {
            let [x, y, z] = [first, (first + 1) % 3, (first + 2) % 3];
            let id = f32::from_bits(id.0);
            ends[first] = [bounds.max[x], bounds.max[y], bounds.max[z], id];
        }
        Self { rows, ends }
    }
}

/// What lanes found.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub struct PairHits {
    /// Of each lane distance, the weights of second and third vertex, and the triangle's id as its
    /// bits.
    pub hits: PerRay<[f32; 4]>,
    /// A bit for each lane whose ray hits its triangle, not limited by the ray's own interval.
    pub lanes: u32,
}

/// The triangles of lanes, axis by axis as their rays have them, then the ends of own boxes
/// and the ids.
type Rows = [[[f32; 4]; LANES]; 4];

impl RayLanes {
    /// Finds which of the rays in `lanes`, prepared, hit the triangle of their lane, and where.
    #[inline(always)]
    pub fn intersect_pairs<S: Simd>(
        &self,
        simd: S,
        lanes: u32,
        triangles: &[PairTriangle],
        numbers: &PerRay<u32>,
        found: &mut PairHits,
    ) {
        let mut rows: Rows = [[[0.0; 4]; LANES]; 4];
        let mut rest = lanes & 0xffff;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let triangle = &triangles[numbers[lane] as usize];
            let first = usize::from(self.first_axis[lane]).min(2);
            for along in 0..3 {
                rows[along][lane] = triangle.rows[first + along];
            }
            rows[3][lane] = triangle.ends[first];
        }
        found.lanes = 0;
        let width = S::f32s::LEN;
        for from in (0..LANES).step_by(width) {
            if lanes >> from & ((1_u64 << width) - 1) as u32 != 0 {
                self.intersect_from(simd, from, &rows, found);
            }
        }
        found.lanes &= lanes;
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
        let ([t0, u0, v0], misses0) = intersect_half(simd, [a0, b0, c0], o0, low);
        let ([t1, u1, v1], misses1) = intersect_half(simd, [a1, b1, c1], o1, high);
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
        let beyond =
            t.simd_gt(exit) & exit.simd_ge(FARTHEST_ALONG) & largest.simd_ge(INVERSE_ALONG);
        let taken = enter.simd_le(exit) & t.simd_lt(f32::INFINITY) & !beyond;
        found.lanes |= (taken.to_bitmask() as u32 & !misses) << from;
        store_columns::<S>([t.max(enter).min(exit), u, v, ends[3]], &mut found.hits, from);
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
) -> ([S::f64s; 3], u32) {
    let a = project::<S>(a, origin, shear);
    let b = project::<S>(b, origin, shear);
    let c = project::<S>(c, origin, shear);
    intersect_sheared(simd, a, b, c)
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geom::intersect_triangle::intersect;
    use crate::math::{Ray, Vec3};
    use crate::simd::{Isa, vectorized};

    fn point() -> impl Strategy<Value = Vec3> {
        let part = || {
            prop_oneof![
                4 => -2.0_f32..2.0, 1 => Just(0.0_f32), 1 => Just(1.0_f32), 1 => 1e5_f32..1.0001e5
            ]
        };
        [part(), part(), part()].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4_000))]
        #[test]
        fn sixteen_pairs_at_once_are_sixteen_times_the_test(
            corners in prop::collection::vec([point(), point(), point()], 3),
            starts in prop::collection::vec((point(), 0.0_f32..1.2, 0.0_f32..1.2), 1..=16),
            exponent in -40_i32..40,
        ) {
            let scale = f32::from_bits(((exponent + 127) as u32) << 23);
            let triangle = |[a, b, c]: [Vec3; 3]| {
                Triangle { a: a * scale, b: b * scale, c: c * scale }
            };
            let triangles: Vec<Triangle> = corners.into_iter().map(triangle).collect();
            let lay_out = |(i, triangle)| PairTriangle::new(PrimId::from_index(i), triangle);
            let laid_out: Vec<_> = triangles.iter().enumerate().map(lay_out).collect();
            let numbers = std::array::from_fn(|lane| (lane % 3) as u32);
            let rays: Vec<Ray> = (starts.iter().enumerate())
                .map(|(lane, &(start, u, v))| {
                    let Triangle { a, b, c } = triangles[lane % 3];
                    let origin = start * scale;
                    let target = a * (1.0 - u - v) + b * u + c * v;
                    Ray::new(origin, target - origin, 0.0, f32::INFINITY)
                })
                .collect();
            let asked = ((1_u64 << rays.len()) - 1) as u32;
            for isa in Isa::available() {
                let level = isa.level().expect("available");
                let found = vectorized!(level, simd => {
                    let (mut lanes, mut found) = (RayLanes::EMPTY, PairHits::default());
                    lanes.fill(&rays);
                    lanes.prepare(simd);
                    lanes.intersect_pairs(simd, asked, &laid_out, &numbers, &mut found);
                    found
                });
                for (lane, ray) in rays.iter().enumerate() {
                    let number = numbers[lane];
                    let own = intersect(ray, &triangles[number as usize]);
                    let own = own.filter(|[t, ..]| *t > 0.0);
                    let here = found.hits[lane];
                    let hit = found.lanes >> lane & 1 == 1 && here[0] > 0.0;
                    let bits = |[t, u, v]: [f32; 3]| [t.to_bits(), u.to_bits(), v.to_bits()];
                    let found = hit.then_some([here[0], here[1], here[2]]).map(bits);
                    prop_assert_eq!(found, own.map(bits), "{}, lane {}", isa, lane);
                    prop_assert!(!hit || here[3].to_bits() == number);
                }
            }
        }
    }
}
