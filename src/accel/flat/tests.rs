//! Few triangles are answered as brute force answers them, whatever the slice.

use std::sync::Arc;

use super::*;
use crate::accel::{Accel, AccelSpec, AnyHit, Batch, ClosestHit, HitFilter, Options, Steps, build};
use crate::geom::TriangleList;
use crate::math::Vec3;
use crate::simd::Isa;

fn random(seed: &mut u32) -> f32 {
    *seed = seed.wrapping_mul(1664525).wrapping_add(1013904223);
    (*seed >> 8) as f32 / 16777216.0
}

fn point(seed: &mut u32) -> Vec3 {
    Vec3::new(random(seed), random(seed), random(seed))
}

/// A box's walls, a slanted one, a thin one, one without area, twins, and some at random.
fn triangles(seed: &mut u32) -> Vec<Triangle> {
    let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let wall = |a: Vec3, b: Vec3, c: Vec3| {
        [Triangle { a, b: a + b, c: a + b + c }, Triangle { a, b: a + b + c, c: a + c }]
    };
    let mut all = [wall(o, x, y), wall(o, y, z), wall(o, z, x), wall(z, x, y)].concat();
    all.extend(wall(y, x + y * 1e-3, z));
    all.extend([all[0], Triangle { a: o, b: x, c: x * 0.5 + y * 1e-6 }]);
    all.push(Triangle { a: o, b: x, c: x * 3.0 });
    all.extend((0..6).map(|_| Triangle { a: point(seed), b: point(seed), c: point(seed) }));
    all
}

/// From anywhere, walls and vertices to anywhere, vertices and along axes, of any length.
fn rays(seed: &mut u32, triangles: &[Triangle]) -> Vec<Ray> {
    (0..4000)
        .map(|i| {
            let at = triangles[i % triangles.len()];
            let origin = match i % 5 {
                0 => point(seed) * 3.0 - 1.0,
                1 => point(seed).with_y(0.0),
                2 => at.a.midpoint(at.b),
                3 => at.c.lerp(at.b, random(seed)) + (point(seed) - 0.5) * 1e-6,
                _ => (point(seed) - 0.5) * 1e9,
            };
            let towards = match i % 7 {
                0 => Vec3::from_array([0, 1, 2].map(|k| f32::from(u8::from(i % 3 == k)))),
                1 => at.b - origin,
                2 => at.a.lerp(at.c, random(seed)) - origin,
                _ => point(seed) - origin,
            };
            let length = [1.0, 1e-20, 1e20, 1e3, 1e-3][i / 7 % 5];
            let t_max = if i % 4 == 0 { random(seed) / length } else { f32::INFINITY };
            let t_min = if i % 6 == 0 { 0.1 / length } else { 0.0 };
            Ray::new(origin, towards * length, t_min, t_max)
        })
        .collect()
}

struct Sieve;

impl HitFilter for Sieve {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        (ray as u32 ^ hit.triangle.index).wrapping_mul(0x9e37_79b9) >> 8 & 3 != 0
    }
}

#[test]
fn slices_of_any_length_are_answered_as_by_brute_force() {
    let seed = &mut 5;
    let triangles = triangles(seed);
    let rays = rays(seed, &triangles);
    let source = Arc::new(TriangleList(triangles));
    let brute: AccelSpec = "brute".parse().expect("known");
    let oracle = build(&brute, source.clone(), Isa::Auto).expect("it builds");
    for isa in Isa::available() {
        let options = &Options::defaults(&[]);
        let level = isa.level().expect("available");
        let steps = &Steps::untold();
        let flat = Flat::build(&BuildInput { source: source.clone(), options, level, steps });
        // Where vectors are short, a tree is faster.
        let Some(flat) = flat else { continue };
        let (mut from, mut slice, mut hit) = (0, 1, 0);
        while from + slice <= rays.len() {
            let filter = (slice % 3 == 0).then_some(&Sieve as &dyn HitFilter);
            let batch = Batch::new(&rays[from..from + slice]).with_filter(filter);
            let answers = |accel: &dyn Accel| {
                let mut hits = vec![ClosestHit::MISS; slice];
                let mut any = vec![AnyHit(true); slice];
                accel.tracer().closest_hits(&batch, &mut hits);
                accel.tracer().any_hits(&batch, &mut any);
                (hits, any)
            };
            let ((hits, any), (sure, sure_any)) = (answers(&flat), answers(&*oracle));
            for (i, (found, sure)) in hits.iter().zip(&sure).enumerate() {
                let ray = batch.rays()[i];
                assert!(found.same_bits(sure), "{isa}, {ray:?}: {found:?}, not {sure:?}");
                hit += usize::from(sure.is_hit());
            }
            assert_eq!(any, sure_any, "{isa}");
            from += slice;
            slice = slice % 40 + 1;
        }
        assert!(hit > 500, "{hit} hits");
    }
}
