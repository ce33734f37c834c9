//! What holds of all shapes.

use super::*;
use crate::math::{DVec2, DVec3, Vec3};

fn all() -> Vec<Box<dyn Shape>> {
    let corner = |r: f64, y: f64| DVec2::new(r, y);
    let cap = Profile::open(&[
        (corner(0.0, 0.0), 0.0),
        (corner(0.1, 0.0), 0.02),
        (corner(0.1, 0.2), 0.0),
        (corner(0.0, 0.3), 0.0),
    ]);
    let bends = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE];
    let spline = [DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 2.0, 0.0), DVec3::X];
    let tube = |path, ripples| Tube { path, radius: 0.02, ripples };
    vec![
        Box::new(Revolve(cap)),
        Box::new(Revolve(Profile::torus(0.2, 0.05))),
        Box::new(Revolve(Profile::ring(0.1, 0.2, 0.05, 0.01))),
        Box::new(tube(Path::Bends { points: bends, radius: 0.1 }, 0)),
        Box::new(tube(Path::Helix { radius: 0.1, pitch: 0.05, turns: 5 }, 0)),
        Box::new(tube(Path::Spline(spline), 0)),
        Box::new(tube(Path::Spline(spline), 40)),
        Box::new(RoundedBox { half: DVec3::new(0.1, 0.2, 0.3), fillet: 0.02 }),
        Box::new(Plate::gear(24, 0.1, 0.02, 0.03, 0.2)),
        Box::new(Plate::solid(Profile::polygon(6, 0.1, 0.0), 0.1)),
        Box::new(Plate::beam(DVec2::new(0.03, 0.04), 0.01, 1.0)),
        Box::new(Bolt { radius: 0.004, length: 0.03 }),
        Box::new(Thread { radius: 0.01, depth: 0.002, pitch: 0.003, turns: 5 }),
        Box::new(Honeycomb { half: DVec2::new(0.2, 0.1), thickness: 0.02 }),
        Box::new(Quad { half: DVec2::new(0.2, 0.1) }),
        Box::new(Ribbon { length: 1.0, width: 0.04 }),
        Box::new(Shell { half: DVec3::new(3.0, 1.4, 2.0) }),
        Box::new(Rock { half: DVec3::new(1.0, 0.6, 0.8), seed: 3 }),
        Box::new(Foliage { half: DVec3::new(2.0, 1.6, 1.8), seed: 4 }),
    ]
}

#[test]
fn counts_are_kept_and_grow_with_the_level() {
    for shape in all() {
        let mut last = 1;
        for level in [0, 1, 2, 3, 5, 8, 13, 30, 77, 200] {
            let count = shape.count(level);
            assert!(count >= last, "{shape:?} at {level}: {count} after {last}");
            assert_eq!(shape.build(level).indices.len() as u64, count, "{shape:?} at {level}");
            last = count;
        }
    }
}

#[test]
fn triangles_have_area_and_face_where_their_normals_point() {
    for shape in all() {
        for level in [0, 1, 2, 5, 9, 40, 120] {
            let made = shape.build(level);
            for triangle in &made.indices {
                let corner = |i: usize| made.vertices[triangle[i] as usize];
                let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(corner(i).position));
                let face = (b - a).cross(c - a);
                assert!(face.length() > 0.0, "{shape:?} at {level}: {triangle:?}");
                for i in 0..3 {
                    let normal = Vec3::from(corner(i).normal);
                    assert!((normal.length() - 1.0).abs() < 1e-5);
                    let turned = normal.dot(face) / face.length();
                    assert!(turned > -0.05, "{shape:?} at {level}: {triangle:?} {turned}");
                }
            }
        }
    }
}

#[test]
fn land_is_one_sheet_that_faces_up() {
    use crate::generate::ground::Ground;
    let land = Terrain(Ground { seed: 2, half: 300.0 });
    for level in [0, 1, 4] {
        let made = land.build(level);
        assert_eq!(made.indices.len() as u64, land.count(level));
        for triangle in &made.indices {
            let corner = |i: usize| Vec3::from(made.vertices[triangle[i] as usize].position);
            assert!((corner(1) - corner(0)).cross(corner(2) - corner(0)).y > 0.0);
        }
    }
}

#[test]
fn no_point_is_beyond_the_extent() {
    for shape in all() {
        let made = shape.build(7);
        let [low, high] = made.bounds().map(Vec3::from);
        let size = f64::from((high - low).length());
        assert!(size < 2.5 * shape.extent() && shape.extent() < 2.5 * size, "{shape:?}");
    }
}
