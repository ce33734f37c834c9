//! Polygons into triangles by clipping ears.
//!
//! D. Eberly, "Triangulation by Ear Clipping", 2002; the walk that goes on two corners behind the
//! last ear, which makes fewer slivers, is that of the library earcut. Strictly convex polygons
//! become a fan about their first corner, as everywhere.

use crate::math::{DVec3, Vec3};

/// Polygons that would take too long, as no modeller makes them.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("a face of {corners} corners is too intricate to be cut into triangles: split it")]
pub(super) struct Intricate {
    corners: usize,
}

/// Cuts polygons, as long as the file's budget lasts: of looks at corners, and of
/// point-in-triangle tests.
pub(super) struct Triangulator {
    budget: u64,
    flat: Vec<[f64; 2]>,
    next: Vec<u32>,
    previous: Vec<u32>,
}

/// What passes for an ear. A polygon without self-intersections has ears of the first kind unless
/// corners coincide or lie on its edges; the others make sure that any input comes to an end.
#[derive(Clone, Copy)]
enum Ear {
    /// Turns left, and no other corner is inside or on its border.
    Clean,
    /// Turns left, and no other corner is inside.
    Touched,
    /// Has no area.
    Flat,
    /// Anything.
    Any,
}

impl Triangulator {
    /// For a file whose polygons have `corners` in all.
    pub(super) fn new(corners: usize) -> Self {
        // 300 million tests, which take longer than looks, take some three seconds (on an AMD EPYC,
        // both cores busy); real files need a few per corner.
        let budget = 300_000_000 + 200 * corners as u64;
        Self { budget, flat: Vec::new(), next: Vec::new(), previous: Vec::new() }
    }

    /// Appends the polygon's triangles, two fewer than it has corners, as indices into `polygon`.
    ///
    /// # Errors
    /// [`Intricate`] if the budget is used up.
    pub(super) fn cut(
        &mut self,
        polygon: &[Vec3],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), Intricate> {
        let count = polygon.len() as u32;
        if count == 3 {
            triangles.push([0, 1, 2]);
            return Ok(());
        }
        self.flatten(polygon);
        self.next = (1..count).chain([0]).collect();
        self.previous = [count - 1].into_iter().chain(0..count - 1).collect();
        if (0..count).all(|corner| self.turn(corner) > 0.0) {
            triangles.extend((2..count).map(|corner| [0, corner - 1, corner]));
            return Ok(());
        }
        self.clip(count, triangles)
    }

    fn clip(&mut self, count: u32, triangles: &mut Vec<[u32; 3]>) -> Result<(), Intricate> {
        const KINDS: [Ear; 4] = [Ear::Clean, Ear::Touched, Ear::Flat, Ear::Any];
        let (mut corner, mut left) = (0, count);
        let (mut kind, mut looked_at) = (0, 0);
        while left > 3 {
            self.budget = self.budget.saturating_sub(1);
            let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
            if self.is_ear(corner, KINDS[kind]) {
                triangles.push([before, corner, after]);
                self.next[before as usize] = after;
                self.previous[after as usize] = before;
                left -= 1;
                corner = self.next[after as usize];
                (kind, looked_at) = (0, 0);
            } else {
                corner = after;
                looked_at += 1;
                if looked_at == left {
                    (kind, looked_at) = (kind + 1, 0);
                }
            }
            if self.budget == 0 {
                return Err(Intricate { corners: count as usize });
            }
        }
        let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
        triangles.push([before, corner, after]);
        Ok(())
    }

    /// Projects along the axis that the polygon faces most, so that it turns left in the plane.
    fn flatten(&mut self, polygon: &[Vec3]) {
        let normal = newell(polygon);
        let size = normal.abs();
        let (x, y, facing) = if size.x > size.y && size.x > size.z {
            (1, 2, normal.x)
        } else if size.y > size.z {
            (2, 0, normal.y)
        } else {
            (0, 1, normal.z)
        };
        let (x, y) = if facing < 0.0 { (y, x) } else { (x, y) };
        self.flat.clear();
        self.flat.extend(polygon.iter().map(|p| [f64::from(p[x]), f64::from(p[y])]));
    }

    /// Twice the signed area of the corner and its neighbours: positive where it turns left.
    fn turn(&self, corner: u32) -> f64 {
        let [a, b, c] = [self.previous[corner as usize], corner, self.next[corner as usize]];
        double_area([a, b, c].map(|corner| self.flat[corner as usize]))
    }

    fn is_ear(&mut self, corner: u32, kind: Ear) -> bool {
        let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
        let turn = self.turn(corner);
        let least = match kind {
            Ear::Any => return true,
            Ear::Flat => return turn == 0.0,
            Ear::Clean | Ear::Touched if turn <= 0.0 => return false,
            Ear::Clean => 0.0,
            Ear::Touched => f64::MIN_POSITIVE,
        };
        let [a, b, c] = [before, corner, after].map(|corner| self.flat[corner as usize]);
        let mut other = self.next[after as usize];
        while other != before {
            self.budget = self.budget.saturating_sub(1);
            let p = self.flat[other as usize];
            let inside = double_area([a, b, p]) >= least
                && double_area([b, c, p]) >= least
                && double_area([c, a, p]) >= least;
            if inside && p != a && p != b && p != c {
                return false;
            }
            other = self.next[other as usize];
        }
        true
    }
}

/// Twice the signed area of a triangle: positive if it turns left.
fn double_area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// The polygon's normal by Newell's method, of twice its area's length; zero if it has none.
pub(super) fn newell(polygon: &[Vec3]) -> DVec3 {
    let mut normal = DVec3::ZERO;
    let origin = polygon[0].as_dvec3();
    let mut from = DVec3::ZERO;
    for point in polygon.iter().skip(1).chain([&polygon[0]]) {
        let to = point.as_dvec3() - origin;
        normal += from.cross(to);
        from = to;
    }
    normal
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cut(polygon: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        Triangulator::new(polygon.len()).cut(polygon, &mut triangles).expect("it is small");
        triangles
    }

    fn flat(points: &[[f32; 2]]) -> Vec<Vec3> {
        points.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect()
    }

    /// Signed areas in the plane z = 0.
    fn areas(polygon: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f64> {
        let corner = |i: u32| polygon[i as usize].as_dvec3();
        let double =
            |t: &[u32; 3]| (corner(t[1]) - corner(t[0])).cross(corner(t[2]) - corner(t[0]));
        triangles.iter().map(|t| double(t).z / 2.0).collect()
    }

    #[test]
    fn convex_polygons_become_fans() {
        let square = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(cut(&square), [[0, 1, 2], [0, 2, 3]]);
        let reversed: Vec<Vec3> = square.into_iter().rev().collect();
        assert_eq!(cut(&reversed), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn a_dart_is_not_covered_outside() {
        // The third corner is reflex: a fan about the first would be right, about the second wrong.
        let dart = flat(&[[2.0, 0.0], [0.0, 2.0], [0.5, 0.5], [-2.0, -4.0]]);
        for start in 0..4 {
            let turned: Vec<Vec3> = (0..4).map(|i| dart[(start + i) % 4]).collect();
            let areas = areas(&turned, &cut(&turned));
            let whole = newell(&turned).z / 2.0;
            assert!(areas.iter().all(|area| area * whole > 0.0), "{areas:?}");
            assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-9);
        }
    }

    #[test]
    fn corners_on_edges_leave_no_flat_triangles() {
        let square =
            flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [0.0, 1.0]]);
        let areas = areas(&square, &cut(&square));
        assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 2.0);
    }

    #[test]
    fn a_bridge_to_a_hole_is_not_crossed() {
        // A square of side 3 with a hole of side 1, joined by the doubled edge 0-4.
        let outer = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [0.0, 0.0]];
        let inner = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0]];
        let ring = flat(&[&outer[..], &inner[..]].concat());
        let areas = areas(&ring, &cut(&ring));
        assert!(areas.iter().all(|&area| area >= 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 8.0);
    }

    #[test]
    fn shapes_without_sense_come_to_an_end() {
        let bow = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(cut(&bow).len(), 2);
        assert_eq!(cut(&flat(&[[1.0, 1.0]; 6])).len(), 4);
        assert_eq!(cut(&flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0]])).len(), 2);
    }

    #[test]
    fn a_polygon_made_to_last_is_refused() {
        // A saw of thin teeth inside which all further teeth lie.
        let count = 60_000;
        let saw: Vec<Vec3> = (0..count)
            .map(|i| Vec3::new(((i * 7919) % 60_013) as f32, ((i * 104_729) % 59_999) as f32, 0.0))
            .collect();
        let mut triangulator = Triangulator { budget: 1_000_000, ..Triangulator::new(count) };
        let cut = triangulator.cut(&saw, &mut Vec::new());
        assert_eq!(cut, Err(Intricate { corners: count }));
    }

    /// Corners without area are ears only after all others have been looked at, each time anew.
    #[test]
    fn there_and_back_again_is_refused() {
        let count = 6_000;
        let line: Vec<Vec3> = (0..count).map(|i| Vec3::X * (i % 2) as f32).collect();
        let mut triangulator = Triangulator { budget: 1_000_000, ..Triangulator::new(count) };
        let cut = triangulator.cut(&line, &mut Vec::new());
        assert_eq!(cut, Err(Intricate { corners: count }));
    }

    proptest! {
        /// A star-shaped polygon about the origin: simple, mostly concave, area known.
        #[test]
        fn any_simple_polygon_is_covered_once(
            radii in proptest::collection::vec(0.1_f32..1.0, 4..40),
            axis in 0_usize..3,
        ) {
            let step = std::f32::consts::TAU / radii.len() as f32;
            let polygon: Vec<Vec3> = radii.iter().enumerate().map(|(i, radius)| {
                let (sin, cos) = libm::sincosf(i as f32 * step);
                let (x, y) = (radius * cos, radius * sin);
                [Vec3::new(x, y, 3.0), Vec3::new(-2.0, x, y), Vec3::new(y, 1.0, x)][axis]
            }).collect();
            let mut triangles = Vec::new();
            Triangulator::new(40).cut(&polygon, &mut triangles).unwrap();
            prop_assert_eq!(triangles.len(), polygon.len() - 2);
            let whole = newell(&polygon);
            let mut sum = 0.0;
            for t in triangles {
                let t = t.map(|i| polygon[i as usize]);
                let area = newell(&t).dot(whole.normalize());
                prop_assert!(area > 0.0);
                sum += area;
            }
            prop_assert!((sum - whole.length()).abs() < 1e-5);
        }
    }
}
