//! The exact test for eight rays at once: [`super::intersect_triangle()`] with one ray a lane.
//!
//! It does the same additions and multiplications in the same order, lane by lane, so it computes
//! the same bits; a test holds it to that. All rays of a bundle must have the same heading.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, f64x4};

use super::bundle::RayBundle;
use super::heading::Heading;
use super::sheared::intersect_sheared;
use super::slab::own_box;
use super::triangle::Triangle;

const LANES: usize = RayBundle::LANES;

/// Hits of eight rays with a triangle, lane by lane.
pub struct BundleHits {
    /// A bit for each ray that hits at a distance within its own limits.
    pub hits: u32,
    /// Distances.
    pub t: [f32; LANES],
    /// Weights of second vertices.
    pub u: [f32; LANES],
    /// Weights of third vertices.
    pub v: [f32; LANES],
}

impl RayBundle {
    /// Which of the rays, of those in `lanes`, hit a triangle, and where.
    #[inline(always)]
    pub fn intersect_triangle<S: Simd>(
        &self,
        simd: S,
        heading: Heading,
        triangle: &Triangle,
        lanes: u32,
    ) -> BundleHits {
        let (mut t, mut u, mut v) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let mut misses = 0;
        for half in 0..2 {
            if lanes & 0xf << (4 * half) == 0 {
                continue;
            }
            let from = 4 * half;
            let [x, y, z] = heading.axes.map(|axis| axis % 3);
            let origin = [
                load_doubled(simd, &self.origin[x], from),
                load_doubled(simd, &self.origin[y], from),
                load_doubled(simd, &self.origin[z], from),
            ];
            let shear = [
                load_quarter(simd, &self.shear[0], from),
                load_quarter(simd, &self.shear[1], from),
                load_quarter(simd, &self.shear[2], from),
            ];
            let a = project(simd, [triangle.a[x], triangle.a[y], triangle.a[z]], origin, shear);
            let b = project(simd, [triangle.b[x], triangle.b[y], triangle.b[z]], origin, shear);
            let c = project(simd, [triangle.c[x], triangle.c[y], triangle.c[z]], origin, shear);
            let ([near, across, up], missed) = intersect_sheared(simd, a, b, c);
            misses |= missed << from;
            store_quarter(&mut t, from, near);
            store_quarter(&mut u, from, across);
            store_quarter(&mut v, from, up);
        }
        let distance = f32x8::load_array(simd, t);
        let (enter, exit) = self.interval(simd, &own_box(triangle), heading.negative);
        let clamped = distance.max(enter).min(exit);
        let [t_min, t_max] = self.spans(simd);
        let taken = enter.simd_le(exit)
            & distance.simd_lt(f32::INFINITY)
            & clamped.simd_gt(t_min)
            & clamped.simd_le(t_max)
            & !self.are_beyond(simd, distance, exit);
        let hits = taken.to_bitmask() as u32 & !misses & lanes;
        BundleHits { hits, t: clamped.to_array(), u, v }
    }
}

/// Loads four of eight numbers.
#[inline(always)]
fn load_quarter<S: Simd>(simd: S, values: &[f64; LANES], from: usize) -> f64x4<S> {
    f64x4::load_array(simd, [values[from], values[from + 1], values[from + 2], values[from + 3]])
}

/// Loads four of eight numbers, in double precision.
#[inline(always)]
fn load_doubled<S: Simd>(simd: S, values: &[f32; LANES], from: usize) -> f64x4<S> {
    let four = [values[from], values[from + 1], values[from + 2], values[from + 3]];
    f64x4::load_array(simd, four.map(f64::from))
}

/// Projects a vertex: each ray is its third axis.
#[inline(always)]
fn project<S: Simd>(
    simd: S,
    [x, y, z]: [f32; 3],
    origin: [f64x4<S>; 3],
    shear: [f64x4<S>; 3],
) -> [f64x4<S>; 3] {
    let x = f64x4::splat(simd, f64::from(x)) - origin[0];
    let y = f64x4::splat(simd, f64::from(y)) - origin[1];
    let z = f64x4::splat(simd, f64::from(z)) - origin[2];
    [x - z * shear[0], y - z * shear[1], z * shear[2]]
}

/// Writes four of eight numbers, rounded.
#[inline(always)]
fn store_quarter<S: Simd>(values: &mut [f32; LANES], from: usize, quarter: f64x4<S>) {
    let quarter = quarter.to_array();
    for lane in 0..4 {
        values[from + lane] = quarter[lane] as f32;
    }
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};
    use proptest::prelude::*;

    use super::*;
    use crate::geom::intersect_triangle::intersect;
    use crate::math::{Ray, Vec3};
    use crate::simd::baseline;

    fn point() -> impl Strategy<Value = Vec3> {
        let (fixed, far) = (|x: f32| Just(x), 1e5_f32..1.0001e5);
        let part = || {
            let (zero, one, far) = (fixed(0.0), fixed(1.0), far.clone());
            prop_oneof![4 => -2.0_f32..2.0, 1 => zero, 1 => one, 1 => far]
        };
        [part(), part(), part()].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn eight_tests_at_once_are_eight_times_the_test(
            a in point(), b in point(), c in point(), origin in point(),
            aims in prop::collection::vec((0.0_f32..1.2, 0.0_f32..1.2), 8), exponent in -40_i32..40,
        ) {
            let scale = f32::from_bits(((exponent + 127) as u32) << 23);
            let triangle = Triangle { a: a * scale, b: b * scale, c: c * scale };
            let mut bundle = RayBundle::EMPTY;
            let mut rays: Vec<(usize, Ray)> = Vec::new();
            let mut heading = None;
            for (lane, (u, v)) in aims.into_iter().enumerate() {
                let target = a * (1.0 - u - v) + b * u + c * v;
                let ray = Ray::new(origin * scale, (target - origin) * scale, 0.0, f32::INFINITY);
                let own = Heading::of(ray.direction());
                if ray != Ray::MISS && *heading.get_or_insert(own) == own {
                    bundle.put(lane, &ray);
                    rays.push((lane, ray));
                }
            }
            prop_assume!(heading.is_some());
            let heading = heading.unwrap();
            bundle.prepare(baseline(), heading);
            let found = dispatch!(Level::new(), simd => {
                bundle.intersect_triangle(simd, heading, &triangle, 0xff)
            });
            for (lane, ray) in rays {
                let own = intersect(&ray, &triangle);
                let bits = |[t, u, v]: [f32; 3]| [t.to_bits(), u.to_bits(), v.to_bits()];
                let here = [found.t[lane], found.u[lane], found.v[lane]];
                let here = (found.hits >> lane & 1 == 1).then_some(here);
                prop_assert_eq!(here.map(bits), own.filter(|[t, ..]| *t > 0.0).map(bits));
            }
        }
    }
}
