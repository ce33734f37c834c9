//! A chain of which one link moves, prepared to be asked often.
//!
//! Between two keys that link goes straight and turns evenly, by `theta` about an axis. With `K`,
//! the matrix of the cross product with that axis, a turn is `I + sin(theta) K + (1 - cos(theta))
//! K^2` (Rodrigues), so that the whole chain is a sum of transforms that are known before:
//!
//! ```text
//! M(t) = start + (t - from) drift + sin(theta) side + (1 - cos(theta)) back
//! ```
//!
//! To add these takes a third of the time that multiplying the links does. Where a scale changes,
//! or two links move, the links are multiplied.

use glam::{DAffine3, DMat3, DVec3};

use super::link::{Link, MovingParts};
use super::sincos::sincos;

/// A chain between all its keys.
#[derive(Clone, Debug)]
pub struct Course {
    /// In the order of time; never empty.
    pieces: Vec<CoursePiece>,
    /// When each begins.
    begins: Vec<f64>,
}

/// A chain from one key to the next.
#[derive(Clone, Copy, Debug)]
struct CoursePiece {
    /// When it begins.
    from: f64,
    /// Half of the angle that it turns by, radians in one unit of time.
    half_rate: f64,
    start: DAffine3,
    /// By how much it is moved, in one unit of time.
    drift: DVec3,
    side: DAffine3,
    back: DAffine3,
}

/// Of a chain with more keys none is prepared: 328 bytes a piece.
const MOST: usize = 16;

impl Course {
    /// Prepares a chain; `None` unless one link moves, keeps its scale and has few keys.
    pub fn new(links: &[Link]) -> Option<Self> {
        let place = links.iter().position(Link::moves)?;
        let (outer, [Link::Moving(parts), inner @ ..]) = links.split_at(place) else { return None };
        if parts.scale.moves() || inner.iter().any(Link::moves) {
            return None;
        }
        let mut times: Vec<f64> = [0.0, 1.0].into_iter().chain(parts.times()).collect();
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        if times.len() > MOST + 1 {
            return None;
        }
        let still =
            |links: &[Link]| links.iter().fold(DAffine3::IDENTITY, |all, link| all * link.at(0.0));
        let around = (still(outer), still(inner));
        let piece = |pair: &[f64]| CoursePiece::new(parts, [pair[0], pair[1]], &around);
        let pieces: Vec<CoursePiece> = times.windows(2).map(piece).collect();
        let begins = pieces.iter().map(|piece| piece.from).collect();
        (!pieces.is_empty()).then_some(Self { pieces, begins })
    }

    /// Bytes of its pieces.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.pieces) + size_of_val(&*self.begins)
    }

    /// The whole transform at a time from 0 to below 1.
    #[inline]
    pub fn at(&self, time: f64) -> DAffine3 {
        // Most keys are at even distances: then the first guess is right.
        let last = self.begins.len() - 1;
        let mut piece = ((time * self.begins.len() as f64) as usize).min(last);
        while piece > 0 && self.begins[piece] > time {
            piece -= 1;
        }
        while piece < last && self.begins[piece + 1] <= time {
            piece += 1;
        }
        self.pieces[piece].at(time)
    }
}

impl CoursePiece {
    /// Of a link between two keys, within and around what stands still.
    fn new(
        parts: &MovingParts,
        [from, to]: [f64; 2],
        (outer, inner): &(DAffine3, DAffine3),
    ) -> Self {
        let (translation, way) = parts.translation.from_to(from, to);
        let (rotation, turn) = parts.rotation.from_to(from, to);
        let axis = turn.axis;
        // The columns of the matrix of the cross product.
        let across =
            DMat3::from_cols(axis.cross(DVec3::X), axis.cross(DVec3::Y), axis.cross(DVec3::Z));
        let turned = outer.matrix3 * DMat3::from_quat(rotation);
        let scaled = DMat3::from_diagonal(parts.scale.at(from));
        let within =
            DAffine3 { matrix3: scaled * inner.matrix3, translation: scaled * inner.translation };
        let linear = |matrix: DMat3| DAffine3 {
            matrix3: matrix * within.matrix3,
            translation: matrix * within.translation,
        };
        let mut start = linear(turned);
        start.translation += outer.matrix3 * translation + outer.translation;
        Self {
            from,
            half_rate: turn.half_angle,
            start,
            drift: outer.matrix3 * way,
            side: linear(turned * across),
            back: linear(turned * (across * across)),
        }
    }

    #[inline]
    fn at(&self, time: f64) -> DAffine3 {
        let (passed, mut at) = ((time - self.from).max(0.0), self.start);
        at.translation += self.drift * passed;
        if self.half_rate != 0.0 {
            let (sine, cosine) = sincos(self.half_rate * passed);
            let (side, back) = (2.0 * sine * cosine, 2.0 * sine * sine);
            at.matrix3 += self.side.matrix3 * side + self.back.matrix3 * back;
            at.translation += self.side.translation * side + self.back.translation * back;
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DQuat;

    use super::*;
    use crate::motion::{Motion, Track};

    #[test]
    fn a_course_is_the_product_of_its_links_at_all_times() {
        let turn =
            |degrees: f64| DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), degrees.to_radians());
        let parts = MovingParts {
            translation: Track::new(&[
                (0.2, DVec3::ZERO),
                (0.6, DVec3::X),
                (0.6, DVec3::Y),
                (2.0, DVec3::Z),
            ])
            .expect("has keys"),
            rotation: Track::new(&[(-1.0, turn(0.0)), (0.5, turn(170.0)), (0.7, turn(-30.0))])
                .expect("has keys"),
            scale: Track::still(DVec3::new(1.0, -2.0, 0.5)),
        };
        let outer =
            DAffine3::from_rotation_y(0.4) * DAffine3::from_scale(DVec3::new(1.0, 3.0, 1.0));
        let inner = DAffine3::from_translation(DVec3::new(4.0, 5.0, 6.0));
        let links = [Link::Still(outer), Link::Moving(Arc::new(parts)), Link::Still(inner)];
        let motion = Motion::new(links.clone()).expect("it moves");
        let further = DAffine3::from_translation(DVec3::Y) * outer;
        let moved = motion.within(further);
        let course = Course::new(&links).expect("one link moves");
        for step in 0..=1000 {
            let time = f64::from(step) / 1000.0;
            let product = links.iter().fold(DAffine3::IDENTITY, |all, link| all * link.at(time));
            assert!(course.at(time).abs_diff_eq(product, 1e-13), "{time}");
            assert!(moved.at(time).abs_diff_eq(further * product, 1e-12), "{time}");
        }
    }

    #[test]
    fn two_links_that_move_and_scales_that_change_are_left() {
        let grows = Track::new(&[(0.0, DVec3::ONE), (1.0, DVec3::X)]).expect("has keys");
        let still = Track::still(DVec3::ONE);
        let link = |translation, scale| {
            let rotation = Track::still(DQuat::IDENTITY);
            Link::Moving(Arc::new(MovingParts { translation, rotation, scale }))
        };
        let (moving, growing) = (link(grows.clone(), still.clone()), link(still, grows));
        assert!(Course::new(std::slice::from_ref(&moving)).is_some());
        assert!(Course::new(&[moving.clone(), moving]).is_none());
        assert!(Course::new(&[growing]).is_none());
    }
}
