//! Flights: camera paths, in files of one camera per line.
//!
//! A line is ten numbers: where the camera stands, what it looks at, which way is up (three each),
//! and the angle between the upper and the lower edge of the picture in degrees. Numbers are
//! separated by blanks or commas; a `#` begins a comment.

use std::fmt::Write;

use super::Camera;
use crate::math::Vec3;

/// A camera of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it stands.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// Which way is up.
    pub up: Vec3,
    /// Angle between the upper and the lower edge of the picture, degrees.
    pub yfov: f32,
}

/// Why a file is not a flight.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FlightError {
    /// A line is not a camera.
    #[error(
        "line {line}: expected ten numbers: eye, target and up (three each), and the angle of view \
         in degrees; found {found:?}"
    )]
    NotTen {
        /// From 1 on.
        line: usize,
        /// What is there.
        found: String,
    },
    /// A camera looks nowhere.
    #[error("line {line}: the target must be away from the eye")]
    NoDirection {
        /// From 1 on.
        line: usize,
    },
    /// A camera sees nothing, or all.
    #[error("line {line}: the angle of view must be above 0 and below 180 degrees, not {degrees}")]
    Angle {
        /// From 1 on.
        line: usize,
        /// What is there.
        degrees: String,
    },
    /// No line is a camera.
    #[error("there is no camera in it: a flight has one a line")]
    Empty,
}

impl Pose {
    /// A camera that stands upright.
    pub const fn new(eye: Vec3, target: Vec3, yfov: f32) -> Self {
        Self { eye, target, up: Vec3::Y, yfov }
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera::look_at(self.eye, self.target, self.up, self.yfov.to_radians())
    }
}

/// Reads a flight.
///
/// # Errors
/// The first line that is not a camera, or that there is none at all.
pub fn parse(text: &str) -> Result<Vec<Pose>, FlightError> {
    let mut flight = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default().trim();
        if !content.is_empty() {
            flight.push(parse_pose(number + 1, content)?);
        }
    }
    if flight.is_empty() { Err(FlightError::Empty) } else { Ok(flight) }
}

fn parse_pose(line: usize, content: &str) -> Result<Pose, FlightError> {
    let words = content.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
    let numbers: Option<Vec<f32>> =
        words.map(|word| word.parse().ok().filter(|x: &f32| x.is_finite())).collect();
    let numbers = numbers.and_then(|numbers| <[f32; 10]>::try_from(numbers).ok());
    let Some(numbers) = numbers else {
        return Err(FlightError::NotTen { line, found: content.chars().take(80).collect() });
    };
    let point = |first: usize| Vec3::new(numbers[first], numbers[first + 1], numbers[first + 2]);
    let pose = Pose { eye: point(0), target: point(3), up: point(6), yfov: numbers[9] };
    if !(pose.yfov > 0.0 && pose.yfov < 180.0) {
        return Err(FlightError::Angle { line, degrees: pose.yfov.to_string() });
    }
    if pose.eye == pose.target {
        return Err(FlightError::NoDirection { line });
    }
    Ok(pose)
}

/// A flight as a file has it; read again, it is the same to the bit.
pub fn write(flight: &[Pose]) -> String {
    let mut text = String::from("# eye, target, up, angle of view in degrees\n");
    for Pose { eye, target, up, yfov } in flight {
        for Vec3 { x, y, z } in [eye, target, up] {
            // Writing to a string cannot fail.
            let _ = write!(text, "{x} {y} {z}  ");
        }
        let _ = writeln!(text, "{yfov}");
    }
    text
}

/// Interpolates `count` cameras, evenly along the Catmull-Rom curve through `keys`; ends included.
pub fn through(keys: &[Pose], count: usize) -> Vec<Pose> {
    let Some(last) = keys.len().checked_sub(1) else { return Vec::new() };
    let at = |number: usize| {
        let place = number as f32 / count.saturating_sub(1).max(1) as f32 * last as f32;
        let from = (place as usize).min(last.saturating_sub(1));
        let share = place - from as f32;
        let key = |i: isize| &keys[(from as isize + i).clamp(0, last as isize) as usize];
        let of = |part: fn(&Pose) -> Vec3| catmull_rom([-1, 0, 1, 2].map(|i| part(key(i))), share);
        let yfov = key(0).yfov + (key(1).yfov - key(0).yfov) * share;
        Pose { eye: of(|p| p.eye), target: of(|p| p.target), up: of(|p| p.up), yfov }
    };
    (0..count).map(at).collect()
}

/// The Catmull-Rom curve from the second of four points to the third.
fn catmull_rom([a, b, c, d]: [Vec3; 4], t: f32) -> Vec3 {
    if t == 1.0 {
        return c; // not all but
    }
    let (square, cube) = (t * t, t * t * t);
    let linear = (c - a) * t;
    let second = (a * 2.0 - b * 5.0 + c * 4.0 - d) * square;
    (b * 2.0 + linear + second + (b * 3.0 - a - c * 3.0 + d) * cube) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keys() -> [Pose; 3] {
        [0.0, 1.0, 4.0].map(|x| Pose::new(Vec3::new(x, 0.1, -x), Vec3::ONE * 9.0, 40.0 + x))
    }

    #[test]
    fn what_is_written_is_read_again() {
        let flight = through(&keys(), 7);
        assert_eq!(parse(&write(&flight)), Ok(flight));
        let one = parse("\n# a remark\n0,0,0, 0 0 -1, 0 1 0, 45 # and one more\n");
        assert_eq!(one, Ok(vec![Pose::new(Vec3::ZERO, Vec3::NEG_Z, 45.0)]));
    }

    #[test]
    fn faults_are_told_with_their_line() {
        let fault = |text: &str| parse(text).expect_err("no flight").to_string();
        assert!(fault("0 0 0 0 0 1 0 1 0 40\n1 2 x").starts_with("line 2: expected ten numbers"));
        assert!(fault("0 0 0 0 0 inf 0 1 0 40").starts_with("line 1: expected"));
        assert!(fault("0 0 0 0 0 1 0 1 0 180").ends_with("not 180"));
        assert!(fault("0 0 1 0 0 1 0 1 0 40").contains("away from the eye"));
        assert!(fault("# nothing").contains("no camera"));
    }

    #[test]
    fn curves_go_through_their_keys() {
        let keys = keys();
        let flight = through(&keys, 5);
        assert_eq!([flight[0], flight[2], flight[4]], keys);
        assert!(flight[1].eye.x > 0.0 && flight[1].eye.x < 1.0, "{:?}", flight[1]);
        assert_eq!(through(&keys[..1], 2), [keys[0]; 2]);
        assert_eq!(through(&keys, 1), keys[..1]);
        assert!(through(&[], 3).is_empty());
    }
}
