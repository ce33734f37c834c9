//! Polylines in a plane whose corners are sharp or rounded.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::math::DVec2;

/// A polyline; its front is to the right of its direction. Around an axis its points are radius
/// and height.
#[derive(Clone, Debug)]
pub struct Profile {
    corners: Vec<(DVec2, f64)>,
    closed: bool,
}

/// A smooth stretch of a polyline: points, and normals of unit length.
pub type Run = Vec<(DVec2, DVec2)>;

impl Profile {
    /// From the first to the last point; each corner with the radius that rounds it, or 0.
    pub fn open(corners: &[(DVec2, f64)]) -> Self {
        Self { corners: corners.to_vec(), closed: false }
    }

    /// Back to the first point, counter-clockwise.
    pub fn closed(corners: &[(DVec2, f64)]) -> Self {
        Self { corners: corners.to_vec(), closed: true }
    }

    /// The section of a ring, from its bottom at height 0.
    pub fn ring(inner: f64, outer: f64, height: f64, fillet: f64) -> Self {
        let points = [(inner, 0.0), (outer, 0.0), (outer, height), (inner, height)];
        Self::closed(&points.map(|(r, y)| (DVec2::new(r, y), fillet)))
    }

    /// The section of a cylinder with its bottom at height 0.
    pub fn cylinder(radius: f64, height: f64, fillet: f64) -> Self {
        let points = [(0.0, 0.0), (radius, 0.0), (radius, height), (0.0, height)];
        Self::open(&points.map(|(r, y)| (DVec2::new(r, y), if r > 0.0 { fillet } else { 0.0 })))
    }

    /// The section of a torus about height 0.
    pub fn torus(radius: f64, tube: f64) -> Self {
        let points = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Self::closed(&points.map(|(r, y)| (DVec2::new(radius + r * tube, y * tube), tube)))
    }

    /// A regular polygon about the origin.
    pub fn polygon(sides: usize, radius: f64, fillet: f64) -> Self {
        let corner = |i: usize| {
            let (sin, cos) = libm::sincos(TAU * i as f64 / sides as f64);
            (DVec2::new(cos, sin) * radius, fillet)
        };
        Self { corners: (0..sides).map(corner).collect(), closed: true }
    }

    /// A rectangle about the origin.
    pub fn rectangle(half: DVec2, fillet: f64) -> Self {
        let signs = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        Self::closed(&signs.map(|(x, y)| (DVec2::new(x, y) * half, fillet)))
    }

    /// Teeth around the origin: trapezoids from `root` to `tip`, a little rounded.
    pub fn teeth(number: usize, root: f64, tip: f64) -> Self {
        let step = TAU / number as f64;
        let corner = |i: usize| {
            let (share, radius) = [(0.0, root), (0.3, root), (0.44, tip), (0.86, tip)][i % 4];
            let (sin, cos) = libm::sincos(((i / 4) as f64 + share) * step);
            (DVec2::new(cos, sin) * radius, 0.15 * (tip - root))
        };
        Self { corners: (0..4 * number).map(corner).collect(), closed: true }
    }

    /// The largest distance of a corner from the origin.
    pub fn reach(&self) -> f64 {
        self.corners.iter().map(|(corner, _)| corner.length()).fold(0.0, f64::max)
    }

    /// The smooth stretches in order, each from where the one before ended. A right angle that is
    /// rounded takes `arc` segments, and is sharp for 0; a straight piece takes `straight`.
    pub fn runs(&self, arc: usize, straight: usize) -> Vec<Run> {
        if arc == 0 {
            let corners = self.corners.iter().map(|&(at, _)| (at, 0.0)).collect();
            return Self { corners, closed: self.closed }.runs(1, straight);
        }
        let n = self.corners.len();
        let edges = if self.closed { n } else { n - 1 };
        let direction = |edge: usize| self.corners[(edge + 1) % n].0 - self.corners[edge % n].0;
        let mut runs: Vec<Run> = vec![Vec::new()];
        for edge in 0..edges {
            let along = direction(edge).normalize_or_zero();
            let normal = right(along);
            let start = self.corners[edge].0 + along * self.cut(edge);
            let end = self.corners[(edge + 1) % n].0 - along * self.cut((edge + 1) % n);
            let run = runs.last_mut().expect("starts with one");
            let length = (end - start).length();
            if run.is_empty() {
                run.push((start, normal));
            }
            if length > 1e-9 {
                for i in 1..=straight {
                    run.push((start + (end - start) * (i as f64 / straight as f64), normal));
                }
            }
            let next = (edge + 1) % n;
            if !self.closed && next == n - 1 {
                break;
            }
            if self.cut(next) > 0.0 {
                self.round(next, along, direction(next).normalize_or_zero(), arc, run);
            } else {
                runs.push(Vec::new());
            }
        }
        runs.retain(|run| run.len() > 1);
        runs
    }

    /// How much rounding a corner takes of the two edges that meet there.
    fn cut(&self, corner: usize) -> f64 {
        let n = self.corners.len();
        let (at, fillet) = self.corners[corner];
        let end = !self.closed && (corner == 0 || corner == n - 1);
        if fillet <= 0.0 || end {
            return 0.0;
        }
        let before = at - self.corners[(corner + n - 1) % n].0;
        let after = self.corners[(corner + 1) % n].0 - at;
        let (a, b) = (before.normalize_or_zero(), after.normalize_or_zero());
        let half_tangent = a.perp_dot(b).abs() / (1.0 + a.dot(b)).max(1e-6);
        (fillet * half_tangent).min(0.5 * before.length().min(after.length()))
    }

    /// Adds the points of a rounded corner but for its first.
    fn round(&self, corner: usize, before: DVec2, after: DVec2, arc: usize, run: &mut Run) {
        let angle = libm::atan2(before.perp_dot(after), before.dot(after));
        let cut = self.cut(corner);
        let half_tangent = before.perp_dot(after).abs() / (1.0 + before.dot(after)).max(1e-6);
        let radius = cut / half_tangent.max(1e-9);
        let outwards = if angle > 0.0 { radius } else { -radius };
        let start = self.corners[corner].0 - before * cut;
        let centre = start - right(before) * outwards;
        let segments = (arc as f64 * angle.abs() / FRAC_PI_2).ceil().max(1.0) as usize;
        for i in 1..=segments {
            let (sin, cos) = libm::sincos(angle * i as f64 / segments as f64);
            let normal = DVec2::new(cos, sin).rotate(right(before));
            run.push((centre + normal * outwards, normal));
        }
    }
}

fn right(direction: DVec2) -> DVec2 {
    DVec2::new(direction.y, -direction.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_rounded_by_half_its_side_is_a_circle() {
        let circle = Profile::rectangle(DVec2::ONE, 1.0);
        let runs = circle.runs(4, 3);
        assert_eq!((runs.len(), runs[0].len()), (1, 17));
        for (point, normal) in &runs[0] {
            assert!((point.length() - 1.0).abs() < 1e-12);
            assert!((*point - *normal).length() < 1e-12);
        }
        assert!((runs[0][0].0 - runs[0][16].0).length() < 1e-12);
    }

    #[test]
    fn sharp_corners_part_runs() {
        let square = Profile::rectangle(DVec2::ONE, 0.0);
        let runs = square.runs(4, 1);
        assert_eq!(runs.len(), 4);
        assert!(runs.iter().all(|run| run.len() == 2));
        assert_eq!(runs[0][0].1, DVec2::new(0.0, -1.0));
    }
}
