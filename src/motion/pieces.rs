//! How fast a motion is at most, and so which boxes hold what moves.
//!
//! # Why the boxes hold all that moves
//! Between two times at which no track changes its way, translations and scales go straight and
//! rotations turn evenly, so that the speed of a point is bounded. Of a chain `L1 L2 … Ln p` it is
//! the sum of what each link does to the point that those within it have made: with `r` the
//! farthest that point may be from the link's origin and `v` its speed there, a link with
//! translation `T`, rotation `R` and scale `S` makes of them at most
//!
//! ```text
//! r' = max |T| + max |S| r        v' = |dT/dt| + (|dR/dt| max |S| + |dS/dt|) r + max |S| v
//! ```
//!
//! where `|S|` is the largest of the three scales. Lengths that go straight are largest at an end.
//! Within a piece of the duration `h` nothing is further than `v h / 2` from where it is in its
//! middle: a box for the middle, grown by that, holds it throughout.
//!
//! Nothing leaves the straight line between where it is at both ends by more than `a h^2 / 8`,
//! where `a` bounds its acceleration. As `T` and `S` go straight, that is
//!
//! ```text
//! a' = (|dR/dt|^2 |S| + 2 |dR/dt| |dS/dt|) r + 2 (|dR/dt| |S| + |dS/dt|) v + |S| a
//! ```

use glam::{DAffine3, DVec3};

use super::link::Link;
use super::path::Motion;

/// A piece of the time that the shutter is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// From when to when it goes.
    pub span: [f64; 2],
    /// Its middle, as samples' times are told.
    pub middle: f32,
    /// No point moves further from where it is in the middle.
    pub margin: f64,
}

/// The most pieces between two keys.
const MOST: usize = 256;
/// And so many in all, or one between each two keys.
const MOST_OF_ALL: usize = 1 << 16;

impl Motion {
    /// Cuts the time into pieces in which nothing within `reach` of the innermost origin moves
    /// further than by `margin`, or as many as are worth it.
    pub fn pieces(&self, reach: f64, margin: f64) -> Vec<Piece> {
        let times = self.times();
        let most = (MOST_OF_ALL / times.len()).clamp(1, MOST) as f64;
        let mut pieces = Vec::new();
        for pair in times.windows(2) {
            let (from, duration) = (pair[0], pair[1] - pair[0]);
            let way = self.fastest(from, pair[1], reach)[0] * duration;
            let count = (0.5 * way / margin).ceil();
            let count = if count >= 1.0 { count.min(most) } else { 1.0 };
            let half = 0.5 * duration / count;
            let piece = |i: u32| {
                let exact = from + half * (2.0 * f64::from(i) + 1.0);
                let middle = exact as f32;
                let off = (f64::from(middle) - exact).abs();
                // Where it is rounded out of the piece, no sample's time is in it.
                let margin = way / duration * (half + off) * (1.0 + 1e-12);
                let span = [exact - half, exact + half];
                (off <= half).then_some(Piece { span, middle, margin })
            };
            pieces.extend((0..count as u32).filter_map(piece));
        }
        pieces
    }

    /// By how much nothing within `reach` of the innermost origin leaves the straight line between
    /// where it is at two times, in between; `None` if there are keys between them.
    pub fn bend(&self, reach: f64, [from, to]: [f64; 2]) -> Option<f64> {
        if self.has_key_between([from, to]) {
            return None;
        }
        let [_, acceleration] = self.fastest(from, to, reach);
        let duration = to - from;
        Some(acceleration * duration * duration / 8.0 * (1.0 + 1e-12))
    }

    /// The same of the way back: in the innermost space, of points that stand still in the world,
    /// where in between one within `reach` is. `None` also if more than one link moves, or a scale.
    ///
    /// With `y` such a point around the link that moves, and `h` the duration, that is `R^-1 (y -
    /// T)` within it, whose acceleration is `|dR/dt|^2 |y - T| + 2 |dR/dt| |dT/dt|` at most.
    pub fn bend_back(&self, reach: f64, [from, to]: [f64; 2]) -> Option<f64> {
        let place = self.links().iter().position(Link::moves)?;
        let [Link::Moving(parts), inner @ ..] = &self.links()[place..] else { return None };
        let are_few = !parts.scale.moves() && !inner.iter().any(Link::moves);
        if !are_few || self.has_key_between([from, to]) {
            return None;
        }
        let scale = DAffine3::from_scale(parts.scale.at(from));
        let within = inner.iter().fold(scale, |all, link| all * link.at(from));
        let (_, moving) = parts.translation.within(from, to);
        let (_, turning) = parts.rotation.within(from, to);
        let duration = to - from;
        let away =
            frobenius_norm(&within) * reach + within.translation.length() + moving * duration;
        let acceleration = turning * (turning * away + 2.0 * moving);
        let bend = frobenius_norm(&within.inverse()) * acceleration * duration * duration / 8.0;
        bend.is_finite().then_some(bend * (1.0 + 1e-9))
    }

    fn has_key_between(&self, [from, to]: [f64; 2]) -> bool {
        let between = |time: f64| from < time && time < to;
        self.links().iter().any(|link| match link {
            Link::Still(_) => false,
            Link::Moving(parts) => parts.times().any(between),
        })
    }

    /// Bounds the speed and the acceleration of all within `reach`, between two times with no key
    /// between them.
    fn fastest(&self, from: f64, to: f64, reach: f64) -> [f64; 2] {
        let (mut reach, mut speed, mut acceleration) = (reach, 0.0, 0.0);
        for link in self.links().iter().rev() {
            match link {
                Link::Still(transform) => {
                    let norm = frobenius_norm(transform);
                    (speed, acceleration) = (norm * speed, norm * acceleration);
                    reach = norm * reach + transform.translation.length();
                }
                Link::Moving(parts) => {
                    let (scales, scaling) = parts.scale.within(from, to);
                    let (translations, moving) = parts.translation.within(from, to);
                    let (_, turning) = parts.rotation.within(from, to);
                    let scale = scales.map(|scale| scale.abs().max_element());
                    let scale = scale[0].max(scale[1]);
                    let away = translations[0].length().max(translations[1].length());
                    let turned = turning * scale + scaling;
                    acceleration = (turning * scale + 2.0 * scaling) * turning * reach
                        + 2.0 * turned * speed
                        + scale * acceleration;
                    speed = moving + turned * reach + scale * speed;
                    reach = away + scale * reach;
                }
            }
        }
        [speed, acceleration]
    }
}

/// Bounds by how much a transform makes anything longer.
fn frobenius_norm(transform: &DAffine3) -> f64 {
    let matrix = transform.matrix3;
    let squares = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::length_squared);
    squares.iter().sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DAffine3, DQuat, DVec3};

    use super::super::{MovingParts, Track};
    use super::*;

    #[test]
    fn nothing_leaves_the_margin_of_its_piece() {
        let turn = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
        let arm = |axis: DVec3, away: DVec3| MovingParts {
            translation: Track::new(&[(0.0, away), (0.4, -away), (1.0, away * 2.0)])
                .expect("has keys"),
            rotation: Track::new(&[(0.0, turn(axis, 0.0)), (0.7, turn(axis, 170.0))])
                .expect("has keys"),
            scale: Track::new(&[(0.2, DVec3::ONE), (0.9, DVec3::new(2.0, -1.0, 0.5))])
                .expect("has keys"),
        };
        let links = [
            Link::Moving(Arc::new(arm(DVec3::Y, DVec3::new(3.0, 1.0, 0.0)))),
            Link::Still(DAffine3::from_translation(DVec3::new(0.0, 2.0, 1.0))),
            Link::Moving(Arc::new(arm(DVec3::X, DVec3::new(0.0, -1.0, 0.5)))),
        ];
        let motion = Motion::new(links).expect("moves");
        let points = [DVec3::X, -DVec3::Y, DVec3::splat(0.5)];
        let pieces = motion.pieces(1.0, 0.05);
        assert!(pieces.len() > 20 && pieces.len() < 5 * 256, "{}", pieces.len());
        let mut start = 0.0;
        for Piece { middle, margin, .. } in pieces {
            // But for what the rounding of the middles has added up to.
            let end = (2.0 * f64::from(middle) - start).min(1.0);
            for step in 0..8 {
                let time = start + (end - start) * f64::from(step) / 8.0;
                for point in points {
                    let at = |time| motion.at(time).transform_point3(point);
                    let way = at(time).distance(at(f64::from(middle)));
                    assert!(way <= margin, "{time}: {way} {margin}");
                }
            }
            start = end;
        }
        assert!((start - 1.0).abs() < 1e-3, "all of the time is covered");
        // Of straight lines between times, where no key is between those.
        let (mut most, mut known) = (0.0_f64, 0);
        for part in 0..64 {
            let [from, to] = [part, part + 1].map(|end| f64::from(end) / 64.0);
            let Some(bend) = motion.bend(1.0, [from, to]) else { continue };
            known += 1;
            for step in 1..8 {
                let place = f64::from(step) / 8.0;
                for point in points {
                    let at =
                        |place: f64| motion.at(from + (to - from) * place).transform_point3(point);
                    let off = at(place).distance(at(0.0).lerp(at(1.0), place));
                    // With room for what both are rounded.
                    assert!(off <= bend + 1e-12, "{from} {place}: {off} {bend}");
                    most = if bend > 1e-6 { most.max(off / bend) } else { most };
                }
            }
        }
        assert!(known > 55 && most > 0.1, "{known} {most}: it bounds, and not for nothing");
    }

    #[test]
    fn ways_back_bend_less_than_is_told() {
        let turn = |degrees: f64| DQuat::from_axis_angle(DVec3::Y, degrees.to_radians());
        let parts = MovingParts {
            translation: Track::new(&[(0.0, DVec3::X), (1.0, DVec3::new(-2.0, 3.0, 0.5))])
                .expect("has keys"),
            rotation: Track::new(&[(0.0, turn(0.0)), (0.5, turn(150.0)), (1.0, turn(300.0))])
                .expect("has keys"),
            scale: Track::still(DVec3::new(0.5, 2.0, -1.0)),
        };
        let links = [
            Link::Still(DAffine3::from_scale(DVec3::splat(3.0))),
            Link::Moving(Arc::new(parts)),
            Link::Still(DAffine3::from_rotation_x(0.3)),
        ];
        let motion = Motion::new(links).expect("moves");
        let mut most = 0.0_f64;
        for part in 0..32 {
            let [from, to] = [part, part + 1].map(|end| f64::from(end) / 32.0);
            let bend = motion.bend_back(1.0, [from, to]).expect("is known");
            let back = |time: f64, point| motion.at(time).inverse().transform_point3(point);
            for step in 0..=8 {
                let place = f64::from(step) / 8.0;
                let time = from + (to - from) * place;
                for corner in [DVec3::X, -DVec3::Y, DVec3::splat(0.5)] {
                    let point = motion.at(time).transform_point3(corner);
                    let straight = back(from, point).lerp(back(to, point), place);
                    let off = straight.distance(corner);
                    assert!(off <= bend + 1e-12, "{time}: {off} {bend}");
                    most = most.max(off / bend);
                }
            }
        }
        assert!(most > 0.05, "{most}: it bounds, and not for nothing");
        assert!(motion.bend_back(1.0, [0.4, 0.6]).is_none(), "a key is between");
    }
}
