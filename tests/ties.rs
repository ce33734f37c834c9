//! Where several triangles share the nearest `t`, or almost do: the lowest id wins everywhere.

use std::sync::Arc;

use dapple::Isa;
use dapple::accel::{Batch, ClosestHit, VARIANTS, build};
use dapple::geom::{Triangle, TriangleList, TriangleSource};
use dapple::math::{PrimId, Ray, TriangleId, Vec3};
use dapple::testing::Random;

/// Fans, coplanar overlaps and coincident twins on a grid of powers of two, where splitting planes
/// like to lie, with faces in all three directions.
fn tangle(scale: f32) -> Vec<Triangle> {
    let mut triangles = Vec::new();
    for i in 0..512_usize {
        let (x, y, z) = ((i % 8) as f32, (i / 8 % 8) as f32, (i / 64) as f32);
        let at = Vec3::new(x, y, z) * 0.25;
        let axis = i % 3;
        let mut u = Vec3::ZERO;
        let mut v = Vec3::ZERO;
        u[axis] = 0.25;
        v[(axis + 1) % 3] = 0.25;
        let square = [
            Triangle { a: at, b: at + u, c: at + u + v },
            Triangle { a: at, b: at + u + v, c: at + v },
        ];
        triangles.extend(square);
        if i % 4 == 0 {
            triangles.extend(square); // Coincident.
        }
        if i % 5 == 0 {
            // Coplanar and overlapping, wound the other way.
            triangles.push(Triangle { a: at, b: at + v * 3.0, c: at + u * 3.0 });
        }
    }
    for t in &mut triangles {
        *t = Triangle { a: t.a * scale, b: t.b * scale, c: t.c * scale };
    }
    triangles
}

/// From grid points, planes and elsewhere; at vertices, along edges, edge-on and straight.
fn rays(triangles: &[Triangle], scale: f32, count: usize) -> Vec<Ray> {
    (0..count)
        .map(|i| {
            let random = &mut Random::new(11, i as u64);
            let triangle = triangles[random.below(triangles.len())];
            let target = match random.below(3) {
                0 => triangle.a,
                1 => triangle.b.midpoint(triangle.c),
                _ => triangle.c,
            };
            let grid = Vec3::new(
                random.below(10) as f32 - 1.0,
                random.below(10) as f32 - 1.0,
                random.below(10) as f32 - 1.0,
            );
            let from = match random.below(3) {
                0 => grid * 0.25 * scale,
                1 => (random.cube() * 4.0 - 1.0) * scale,
                _ => target + Vec3::AXES[random.below(3)] * scale,
            };
            let direction = match random.below(4) {
                0 => triangle.b - triangle.a,
                1 => Vec3::AXES[random.below(3)] * [1.0, -1.0][random.below(2)],
                _ => target - from,
            };
            Ray::new(from, direction, 0.0, f32::INFINITY)
        })
        .collect()
}

/// Holds all structures, and those whose leaves have parts of triangles, against the first.
fn all_agree(triangles: Vec<Triangle>, rays: &[Ray], what: &str) -> Vec<ClosestHit> {
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(triangles));
    let mut expected: Option<Vec<ClosestHit>> = None;
    // Brute force comes first in the table.
    let ids = VARIANTS.iter().map(|variant| variant.id);
    for spec in ids.chain(["bvh2:build=sbvh", "mbvh8:build=esc"]) {
        let parsed = spec.parse().expect("in the table");
        let accel = build(&parsed, Arc::clone(&source), Isa::Auto).expect("a small scene builds");
        let mut hits = vec![ClosestHit::MISS; rays.len()];
        accel.tracer().closest_hits(&Batch::new(rays), &mut hits);
        let expected = expected.get_or_insert_with(|| hits.clone());
        let differs = hits.iter().zip(&*expected).position(|(a, b)| !a.same_bits(b));
        assert_eq!(differs.map(|i| (rays[i], hits[i], expected[i])), None, "{spec}, {what}");
    }
    expected.expect("the table has rows")
}

#[test]
fn ties_go_to_the_lowest_id_at_every_scale() {
    for scale in [1.0_f32, 1e-20, 1e20, 1e-3, 65536.0] {
        let triangles = tangle(scale);
        let rays = rays(&triangles, scale, 20_000);
        let hits = all_agree(triangles, &rays, &format!("scale {scale}"));
        let hit = hits.iter().filter(|hit| hit.is_hit()).count();
        assert!(hit > rays.len() / 4, "only {hit} rays hit at scale {scale}");
    }
}

/// Along an axis, exactly in the upper faces of wedges, with directions of all lengths: where
/// these are so short that a hit is far more than 2^36 of them away, no hit may be moved there.
#[test]
fn rays_that_creep_along_faces_are_answered_alike() {
    for height in [0.0_f32, 1.173e-3, -3.0] {
        let wedge = |i: u64| {
            let random = &mut Random::new(5, i);
            let at = Vec3::new(random.below(16) as f32, random.below(16) as f32, height);
            let size = 1.0 + random.below(8) as f32;
            let b = at + Vec3::new(size, 2.0 * size, 0.0);
            Triangle { a: at, b, c: b - Vec3::Z * size }
        };
        let ray = |i: u64| {
            let random = &mut Random::new(6, i);
            let axis = random.below(2);
            let mut origin = Vec3::new(-1.0, -1.0, height);
            origin[1 - axis] = random.below(160) as f32 / 8.0;
            let length = libm::powf(10.0, -36.0 * random.unit());
            Ray::new(origin, Vec3::AXES[axis] * length, 0.0, f32::INFINITY)
        };
        let rays: Vec<_> = (0..8000).map(ray).collect();
        let hits = all_agree((0..400).map(wedge).collect(), &rays, &format!("height {height}"));
        let moved = |(ray, hit): (&Ray, &ClosestHit)| {
            hit.is_hit() && ray.at(hit.t).max_element() < -0.01 + height.min(0.0)
        };
        assert!(!rays.iter().zip(&hits).any(moved), "before all wedges");
        let hit = hits.iter().filter(|hit| hit.is_hit()).count();
        assert!(hit > 1000, "only {hit} rays hit at height {height}");
    }
}

#[test]
fn of_coincident_twins_the_first_is_hit() {
    let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
    let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(vec![triangle; 1000]));
    let ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z, 0.0, 1.0);
    for variant in VARIANTS {
        let spec = variant.id.parse().expect("in the table");
        let accel = build(&spec, Arc::clone(&source), Isa::Auto).expect("a small scene builds");
        let mut hit = [ClosestHit::MISS];
        accel.tracer().closest_hits(&Batch::new(&[ray]), &mut hit);
        assert_eq!(
            (hit[0].t, hit[0].triangle),
            (1.0, TriangleId::unplaced(PrimId(0))),
            "{}",
            variant.id
        );
    }
}
