//! A value over time, piece by piece.

use std::fmt::Debug;

use glam::{DQuat, DVec3};

/// What a track is of.
pub trait Value: Copy + Debug + PartialEq {
    /// The way from a value to another.
    type Step: Copy + Debug;

    /// The way to another value.
    fn step_to(self, other: Self) -> Self::Step;

    /// The value at a part of the way.
    fn ahead(self, step: &Self::Step, part: f64) -> Self;

    /// So many times that way.
    fn scaled(step: &Self::Step, part: f64) -> Self::Step;

    /// How long the way is: by the units of the value, of rotations in radians.
    fn length(step: &Self::Step) -> f64;
}

impl Value for DVec3 {
    type Step = DVec3;

    fn step_to(self, other: Self) -> DVec3 {
        other - self
    }

    #[inline]
    fn ahead(self, step: &DVec3, part: f64) -> Self {
        self + *step * part
    }

    fn scaled(step: &DVec3, part: f64) -> DVec3 {
        *step * part
    }

    fn length(step: &DVec3) -> f64 {
        step.length()
    }
}

/// The way from a rotation to another: the short one, at an even speed (slerp).
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Unit, or zero.
    pub axis: DVec3,
    /// Half of the angle, radians.
    pub half_angle: f64,
}

impl Value for DQuat {
    type Step = Turn;

    fn step_to(self, other: Self) -> Turn {
        let between = self.conjugate() * other;
        let between = if between.w < 0.0 { -between } else { between };
        let sine = between.xyz().length();
        let axis = between.xyz().try_normalize().unwrap_or(DVec3::ZERO);
        Turn { axis, half_angle: libm::atan2(sine, between.w) }
    }

    #[inline]
    fn ahead(self, turn: &Turn, part: f64) -> Self {
        let (sine, cosine) = libm::sincos(turn.half_angle * part);
        let Turn { axis, .. } = turn;
        self * DQuat::from_xyzw(axis.x * sine, axis.y * sine, axis.z * sine, cosine)
    }

    fn scaled(turn: &Turn, part: f64) -> Turn {
        Turn { half_angle: turn.half_angle * part, ..*turn }
    }

    fn length(turn: &Turn) -> f64 {
        2.0 * turn.half_angle
    }
}

/// A value over time: in a straight line, or by an even turn, from key to key. Before the first and
/// after the last it stays. Where two keys have the same time, it jumps.
#[derive(Clone, Debug)]
pub struct Track<T: Value> {
    /// Never empty.
    pieces: Vec<TrackPiece<T>>,
}

/// From a key to the next; of the last key, for all times.
#[derive(Clone, Copy, Debug)]
struct TrackPiece<T: Value> {
    from: f64,
    /// One over its duration; zero if it does not change.
    rate: f64,
    value: T,
    step: T::Step,
}

impl<T: Value> Track<T> {
    /// A value that stays.
    pub fn still(value: T) -> Self {
        let piece = TrackPiece { from: 0.0, rate: 0.0, value, step: value.step_to(value) };
        Self { pieces: vec![piece] }
    }

    /// A track of keys: times that do not fall, and values; `None` if there are none.
    pub fn new(keys: &[(f64, T)]) -> Option<Self> {
        let (last, _) = keys.split_last()?;
        let mut pieces = Vec::with_capacity(keys.len());
        for pair in keys.windows(2) {
            let [(from, value), (to, next)] = [pair[0], pair[1]];
            let step = value.step_to(next);
            let changes = to > from && value != next;
            let rate = if changes { 1.0 / (to - from) } else { 0.0 };
            pieces.push(TrackPiece { from, rate, value, step });
        }
        let (from, value) = *last;
        pieces.push(TrackPiece { from, rate: 0.0, value, step: value.step_to(value) });
        Some(Self { pieces })
    }

    /// Whether it changes, while the shutter is open.
    pub fn moves(&self) -> bool {
        self.pieces.iter().any(|piece| piece.value != self.pieces[0].value)
    }

    #[inline]
    fn piece(&self, time: f64) -> &TrackPiece<T> {
        let after = self.pieces.partition_point(|piece| piece.from <= time);
        &self.pieces[after.saturating_sub(1)]
    }

    /// The value at a time.
    #[inline]
    pub fn at(&self, time: f64) -> T {
        let piece = self.piece(time);
        piece.at(time)
    }

    /// Where it changes its way, from 0 to 1.
    pub fn times(&self) -> impl Iterator<Item = f64> + '_ {
        let first = self.pieces.partition_point(|piece| piece.from < 0.0);
        let end = self.pieces.partition_point(|piece| piece.from <= 1.0);
        self.pieces[first..end].iter().map(|piece| piece.from)
    }

    /// Within one piece, between two times in it: the value at the first, and the way from there in
    /// one unit of time.
    pub fn from_to(&self, from: f64, to: f64) -> (T, T::Step) {
        let middle = 0.5 * (from + to);
        let piece = self.piece(middle);
        // Before the first key it stays.
        let rate = if middle < piece.from { 0.0 } else { piece.rate };
        (piece.at(from), T::scaled(&piece.step, rate))
    }

    /// Within one piece, between two times in it: the values there, and how fast it changes.
    pub fn within(&self, from: f64, to: f64) -> ([T; 2], f64) {
        let piece = self.piece(0.5 * (from + to));
        ([piece.at(from), piece.at(to)], T::length(&piece.step) * piece.rate)
    }
}

impl<T: Value> TrackPiece<T> {
    #[inline]
    fn at(&self, time: f64) -> T {
        if self.rate == 0.0 {
            return self.value;
        }
        self.value.ahead(&self.step, (time - self.from).max(0.0) * self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_go_straight_from_key_to_key_and_jump_between_two_of_one_time() {
        let at = |x: f64| DVec3::new(x, 0.0, 1.0);
        let keys = [(0.0, at(0.0)), (0.5, at(2.0)), (0.5, at(7.0)), (1.0, at(7.0))];
        let track = Track::new(&keys).expect("has keys");
        for (time, x) in [(-1.0, 0.0), (0.0, 0.0), (0.25, 1.0), (0.5, 7.0), (0.9, 7.0), (2.0, 7.0)]
        {
            assert_eq!(track.at(time), at(x), "{time}");
        }
        assert!(track.moves() && !Track::new(&keys[2..]).expect("has keys").moves());
        assert_eq!(track.within(0.1, 0.4).1, 4.0);
    }

    #[test]
    fn turns_take_the_short_way_at_an_even_speed() {
        let turn = |degrees: f64| DQuat::from_rotation_y(degrees.to_radians());
        let keys = [(0.0, turn(10.0)), (1.0, -turn(130.0))];
        let track = Track::new(&keys).expect("has keys");
        for (time, degrees) in [(0.0, 10.0), (0.25, 40.0), (0.5, 70.0), (1.0, 130.0)] {
            let found = track.at(time);
            assert!(found.dot(turn(degrees)).abs() > 1.0 - 1e-14, "{found} at {time}");
        }
        assert!((track.within(0.2, 0.7).1.to_degrees() - 120.0).abs() < 1e-9);
    }
}
