//! Numbers over time, as a sampler of an animation has them (glTF 2.0, 3.11 and appendix C).

use glam::DQuat;

/// How numbers go from key to key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// They stay and jump.
    Step,
    /// Straight; rotations turn evenly.
    Linear,
    /// By a spline, with a tangent on either side of each key.
    Cubic,
}

/// The keys of a sampler.
pub struct Curve {
    /// How it goes from key to key.
    pub interpolation: Interpolation,
    /// Whether its sets are rotations.
    pub turns: bool,
    /// Seconds, in order; at least one.
    pub times: Vec<f64>,
    /// A set for each time; of a spline three.
    pub values: Vec<f32>,
    /// How many values a set has.
    pub width: usize,
}

impl Curve {
    /// What it is from `open` to `close`, seconds: values at times from 0 to 1, in order, between
    /// which they go straight, and rotations turn evenly; where two times are the same, they jump.
    /// Splines are cut into so many pieces that this is as good.
    pub fn straight_pieces(&self, [open, close]: [f64; 2]) -> Vec<(f64, Vec<f64>)> {
        /// Of the way from a key to the next.
        const PIECES: f64 = 256.0;
        let times = &self.times;
        let part = |time: f64| (time - open) / (close - open);
        let mut found = vec![(0.0, self.at(open))];
        let mut from = open;
        let inner = times.iter().copied().filter(|&time| time > open && time < close);
        for to in inner.chain([close]) {
            match self.interpolation {
                Interpolation::Linear => {}
                Interpolation::Step => found.push((part(to), self.at(from))),
                Interpolation::Cubic => {
                    let after = times.partition_point(|&time| time <= from);
                    let inside = after > 0 && after < times.len();
                    let span = if inside { times[after] - times[after - 1] } else { to - from };
                    let count = (PIECES * (to - from) / span).ceil().clamp(8.0, PIECES);
                    let at = |i: u32| from + (to - from) * f64::from(i) / count;
                    let at = (1..count as u32).map(at);
                    found.extend(at.map(|time| (part(time), self.at(time))));
                }
            }
            found.push((part(to), self.at(to)));
            from = to;
        }
        found
    }

    /// The numbers at a time; before the first and after the last of its times they stay.
    pub fn at(&self, time: f64) -> Vec<f64> {
        let Self { interpolation, turns, times, values, width } = self;
        let (interpolation, width) = (*interpolation, *width);
        let set = |number: usize| -> Vec<f64> {
            values[number * width..][..width].iter().map(|&value| f64::from(value)).collect()
        };
        let cubic = interpolation == Interpolation::Cubic;
        let key = |number: usize| set(if cubic { 3 * number + 1 } else { number });
        let after = times.partition_point(|&at| at <= time);
        if after == 0 {
            return key(0);
        }
        let before = after - 1;
        if after == times.len() || interpolation == Interpolation::Step {
            return key(before);
        }
        let span = times[after] - times[before];
        let t = (time - times[before]) / span;
        let (a, b) = (key(before), key(after));
        if cubic {
            let (leaving, arriving) = (set(3 * before + 2), set(3 * after));
            let (t2, t3) = (t * t, t * t * t);
            let at = |i: usize| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
                    + span * (t3 - 2.0 * t2 + t) * leaving[i]
                    + (3.0 * t2 - 2.0 * t3) * b[i]
                    + span * (t3 - t2) * arriving[i]
            };
            return (0..width).map(at).collect();
        }
        if *turns {
            let quaternion = |q: &[f64]| DQuat::from_xyzw(q[0], q[1], q[2], q[3]).normalize();
            return quaternion(&a).slerp(quaternion(&b), t).to_array().to_vec();
        }
        a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(interpolation: Interpolation, times: &[f64], values: &[f32], width: usize) -> Curve {
        let (times, values, turns) = (times.to_vec(), values.to_vec(), width == 4);
        Curve { interpolation, turns, times, values, width }
    }

    #[test]
    fn values_between_keys_are_stepped_or_in_line() {
        let (times, values) = ([1.0, 3.0], [0.0, 10.0, 20.0, 4.0, 10.0, 30.0]);
        let at = |interpolation, time| curve(interpolation, &times, &values, 3).at(time);
        assert_eq!(at(Interpolation::Linear, 1.5), [1.0, 10.0, 22.5]);
        assert_eq!(at(Interpolation::Step, 2.9), [0.0, 10.0, 20.0]);
        assert_eq!(at(Interpolation::Step, 3.0), [4.0, 10.0, 30.0]);
        assert_eq!(at(Interpolation::Linear, 0.0), [0.0, 10.0, 20.0]);
        assert_eq!(at(Interpolation::Linear, 9.0), [4.0, 10.0, 30.0]);
    }

    #[test]
    fn splines_leave_and_arrive_by_their_tangents() {
        // In, value, out for each of two keys: from 0 at speed 1 to 2 at speed 1 in two seconds.
        let values = [9.0, 0.0, 1.0, 1.0, 2.0, 9.0];
        let spline = curve(Interpolation::Cubic, &[0.0, 2.0], &values, 1);
        for time in [0.0, 0.5, 1.0, 1.75, 2.0] {
            let found = spline.at(time)[0];
            assert!((found - time).abs() < 1e-12, "a straight line: {found} at {time}");
        }
    }

    #[test]
    fn rotations_take_the_short_way_at_an_even_speed() {
        let half = (0.5_f32).sqrt();
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, -half, 0.0, -half]; // to 90° about Y, negated
        let turn = curve(Interpolation::Linear, &[0.0, 3.0], &values, 4);
        let third = turn.at(1.0);
        let expected = DQuat::from_rotation_y(30_f64.to_radians());
        let found = DQuat::from_xyzw(third[0], third[1], third[2], third[3]);
        assert!(found.dot(expected).abs() > 1.0 - 1e-9, "{found}");
    }

    #[test]
    fn straight_pieces_have_the_values_of_the_curve() {
        let (times, values) = ([1.0, 2.0, 4.0], [0.0, 3.0, -1.0]);
        let linear = curve(Interpolation::Linear, &times, &values, 1).straight_pieces([1.5, 3.0]);
        assert_eq!(linear, [(0.0, vec![1.5]), (1.0 / 3.0, vec![3.0]), (1.0, vec![1.0])]);
        let step = curve(Interpolation::Step, &times, &values, 1).straight_pieces([1.5, 2.5]);
        let expected = [(0.0, 0.0), (0.5, 0.0), (0.5, 3.0), (1.0, 3.0), (1.0, 3.0)];
        assert_eq!(step, expected.map(|(time, value)| (time, vec![value])));
        let values = [0.0, 0.0, 1.0, 0.0, 2.0, -1.0, 0.0, 5.0, 0.0];
        let spline = curve(Interpolation::Cubic, &times, &values, 1);
        let pieces = spline.straight_pieces([0.0, 4.0]);
        for pair in pieces.windows(2) {
            let middle = 4.0 * 0.5 * (pair[0].0 + pair[1].0);
            let straight = 0.5 * (pair[0].1[0] + pair[1].1[0]);
            assert!((spline.at(middle)[0] - straight).abs() < 1e-4, "{middle}");
        }
    }
}
