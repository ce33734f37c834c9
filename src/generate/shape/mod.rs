//! Shapes that can be tessellated as finely as there are triangles for them.
//!
//! Axes of symmetry are +Y. A shape is a description and nothing more; its triangles are made when
//! they are written, and made again to the same bits whenever they are asked for.

mod bolt;
mod honeycomb;
mod path;
mod plate;
mod profile;
mod quad;
mod revolve;
mod ribbon;
mod rock;
mod rounded_box;
mod shell;
mod terrain;
mod thread;
mod tube;

pub use bolt::Bolt;
pub use honeycomb::Honeycomb;
pub use path::Path;
pub use plate::{Bore, Plate};
pub use profile::Profile;
pub use quad::Quad;
pub use revolve::Revolve;
pub use ribbon::Ribbon;
pub use rock::{Foliage, Rock};
pub use rounded_box::RoundedBox;
pub use shell::Shell;
pub use terrain::Terrain;
pub use thread::Thread;
pub use tube::Tube;

use super::tessellation::Tessellation;
use std::fmt::Debug;

/// Something with a surface.
pub trait Shape: Debug + Send + Sync {
    /// Triangles at a level of detail: never fewer at a higher level, 1 at least.
    fn count(&self, level: u32) -> u64;

    /// As many triangles as [`Shape::count`] says, none without area.
    fn build(&self, level: u32) -> Tessellation;

    /// About the distance of its farthest points, metres.
    fn extent(&self) -> f64;
}

/// Sine and cosine of `columns` equal steps around a circle.
fn circle(columns: usize) -> Vec<(f64, f64)> {
    let step = std::f64::consts::TAU / columns as f64;
    (0..columns).map(|i| libm::sincos(i as f64 * step)).collect()
}

/// Columns around a round part, and into how many pieces straight lengths are cut. Like a CAD
/// program's, they stay whole for long, and triangles along cylinders become thin.
fn columns(level: u32) -> (usize, usize) {
    const MOST_COLUMNS: u32 = 384;
    ((6 + level).min(MOST_COLUMNS) as usize, 1 + level as usize / 40)
}

/// Segments of a right angle that go with `columns` around; 0: it is left sharp.
fn arc(columns: usize) -> usize {
    (columns / 9).min(24)
}

#[cfg(test)]
mod tests {
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
        use super::super::ground::Ground;
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
}
