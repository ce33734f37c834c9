//! Curves through space that tubes follow.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::math::DVec3;

/// A curve.
#[derive(Clone, Debug)]
pub enum Path {
    /// Straight pieces, the corners between them bent at a radius.
    Bends {
        /// The ends and the corners.
        points: Vec<DVec3>,
        /// Of the bends, where the pieces are long enough for it.
        radius: f64,
    },
    /// About +Y, upwards from height 0.
    Helix {
        /// From the axis.
        radius: f64,
        /// Height of a turn.
        pitch: f64,
        /// Whole turns.
        turns: usize,
    },
    /// A cubic curve by Bézier's four points.
    Spline([DVec3; 4]),
}

/// A point of a curve, the direction there, and one across it that does not spin.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// The point.
    pub at: DVec3,
    /// Unit direction along the curve.
    pub along: DVec3,
    /// A unit direction at right angles to it.
    pub across: DVec3,
}

impl Path {
    /// Stations along the curve. A right angle takes `arc` segments, a straight piece `straight`;
    /// a spline takes four times `arc`.
    pub fn stations(&self, arc: usize, straight: usize) -> Vec<Station> {
        let points = match self {
            Self::Bends { points, radius } => bends(points, *radius, arc, straight),
            Self::Helix { radius, pitch, turns } => {
                let steps = 4 * arc.max(2) * turns;
                (0..=steps).map(|i| helix(*radius, *pitch, i, 4 * arc.max(2))).collect()
            }
            Self::Spline(points) => spline(points, 4 * arc),
        };
        transported(&points)
    }

    /// A spline's stations, `steps` and one.
    pub fn even_stations(&self, steps: usize) -> Vec<Station> {
        match self {
            Self::Spline(points) => transported(&spline(points, steps)),
            _ => self.stations(steps.div_ceil(8), steps.div_ceil(4)),
        }
    }

    /// About the distance between its farthest points.
    pub fn extent(&self) -> f64 {
        let (low, high) = match self {
            Self::Bends { points, .. } => bounds(points),
            Self::Spline(points) => bounds(points),
            Self::Helix { radius, pitch, turns } => {
                (DVec3::ZERO, DVec3::new(2.0 * radius, pitch * *turns as f64, 2.0 * radius))
            }
        };
        (high - low).length()
    }
}

fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    (low, points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max))
}

type Directed = (DVec3, DVec3);

fn helix(radius: f64, pitch: f64, step: usize, steps_a_turn: usize) -> Directed {
    let turn = step as f64 / steps_a_turn as f64;
    let (sin, cos) = libm::sincos(turn * TAU);
    let along = DVec3::new(cos * radius * TAU, pitch, -sin * radius * TAU);
    (DVec3::new(sin * radius, turn * pitch, cos * radius), along.normalize())
}

fn spline([a, b, c, d]: &[DVec3; 4], steps: usize) -> Vec<Directed> {
    let point = |i| {
        let t = f64::from(i) / steps as f64;
        let s = 1.0 - t;
        let at =
            *a * (s * s * s) + *b * (3.0 * s * s * t) + *c * (3.0 * s * t * t) + *d * (t * t * t);
        let along = (*b - *a) * (s * s) + (*c - *b) * (2.0 * s * t) + (*d - *c) * (t * t);
        (at, along.normalize_or(DVec3::Y))
    };
    (0..=steps as u32).map(point).collect()
}

fn bends(points: &[DVec3], radius: f64, arc: usize, straight: usize) -> Vec<Directed> {
    let mut made: Vec<Directed> = Vec::new();
    let mut start = points[0];
    for i in 0..points.len() - 1 {
        let along = (points[i + 1] - points[i]).normalize_or(DVec3::Y);
        let Some(&after) = points.get(i + 2) else {
            line(&mut made, start, points[i + 1], along, straight);
            break;
        };
        let next = (after - points[i + 1]).normalize_or(DVec3::Y);
        let across = along.cross(next).length();
        let half_tangent = across / (1.0 + along.dot(next)).max(1e-6);
        let room = (points[i + 1] - points[i]).length().min((after - points[i + 1]).length());
        let cut = (radius * half_tangent).min(0.49 * room);
        line(&mut made, start, points[i + 1] - along * cut, along, straight);
        start = points[i + 1] + next * cut;
        let angle = libm::atan2(across, along.dot(next));
        if angle < 1e-6 {
            continue;
        }
        let inwards = (next - along * along.dot(next)).normalize_or_zero();
        let bend = cut / half_tangent;
        let centre = points[i + 1] - along * cut + inwards * bend;
        let segments = (arc as f64 * angle / FRAC_PI_2).ceil().max(1.0) as usize;
        for k in 1..=segments {
            let (sin, cos) = libm::sincos(angle * k as f64 / segments as f64);
            made.push((
                centre - inwards * (bend * cos) + along * (bend * sin),
                along * cos + inwards * sin,
            ));
        }
    }
    made
}

/// A straight piece; its start is there already unless it is the first.
fn line(made: &mut Vec<Directed>, start: DVec3, end: DVec3, along: DVec3, pieces: usize) {
    if made.is_empty() {
        made.push((start, along));
    }
    for i in 1..=pieces {
        made.push((start + (end - start) * (i as f64 / pieces as f64), along));
    }
}

/// Carries a direction across along the curve by double reflection (Wang et al. 2008).
fn transported(points: &[Directed]) -> Vec<Station> {
    let mut across = points[0].1.any_orthonormal_vector();
    let mut made = Vec::with_capacity(points.len());
    let mut last = points[0];
    for &(at, along) in points {
        let step = at - last.0;
        let square = step.length_squared();
        if square > 0.0 {
            let reflect = |v: DVec3| v - step * (2.0 / square * step.dot(v));
            let (mirrored, direction) = (reflect(across), reflect(last.1));
            let second = along - direction;
            let square = second.length_squared();
            across = if square > 0.0 {
                mirrored - second * (2.0 / square * second.dot(mirrored))
            } else {
                mirrored
            };
        }
        across = (across - along * along.dot(across)).normalize_or(along.any_orthonormal_vector());
        made.push(Station { at, along, across });
        last = (at, along);
    }
    made
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_have_frames_and_keep_the_ends() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::ONE];
        for path in [
            Path::Bends { points: points.clone(), radius: 0.2 },
            Path::Spline([points[0], points[1], points[2], points[3]]),
        ] {
            let stations = path.stations(6, 2);
            assert!((stations.last().expect("some").at - DVec3::ONE).length() < 1e-12);
            for station in &stations {
                assert!((station.along.length() - 1.0).abs() < 1e-9);
                assert!((station.across.length() - 1.0).abs() < 1e-9);
                assert!(station.along.dot(station.across).abs() < 1e-9);
            }
            for pair in stations.windows(2) {
                assert!(pair[0].across.dot(pair[1].across) > 0.8, "{path:?} spins");
                assert!((pair[1].at - pair[0].at).dot(pair[0].along) > 0.0, "{path:?} turns back");
            }
        }
    }
}
