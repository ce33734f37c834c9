//! What red, green and blue stand for, where a file says so, and the way from there to Rec. 709.

use crate::math::{DMat3, DVec2, DVec3};

/// Places in the CIE xy diagram. `red`, `green` and `blue` are what a pixel's numbers mix, `white`
/// is what equal numbers of them look like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    /// Of the first number.
    pub red: DVec2,
    /// Of the second.
    pub green: DVec2,
    /// Of the third.
    pub blue: DVec2,
    /// Of all three alike.
    pub white: DVec2,
}

/// Places that are nearer than this are the same: writers round to three or four digits.
const SAME: f64 = 1.5e-3;

/// Cone responses of CIE XYZ, for the adaptation to another white (Bradford, as the ICC has it).
const CONES: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

impl Primaries {
    /// Those of Rec. 709 and sRGB, with the white D65.
    pub const REC_709: Self = Self {
        red: DVec2::new(0.64, 0.33),
        green: DVec2::new(0.3, 0.6),
        blue: DVec2::new(0.15, 0.06),
        white: DVec2::new(0.3127, 0.329),
    };

    /// Of eight numbers, as files have them: x and y of red, green, blue and white.
    pub fn from_array([rx, ry, gx, gy, bx, by, wx, wy]: [f64; 8]) -> Self {
        let [red, green] = [DVec2::new(rx, ry), DVec2::new(gx, gy)];
        Self { red, green, blue: DVec2::new(bx, by), white: DVec2::new(wx, wy) }
    }

    /// Whether they are those of Rec. 709, as far as writers round.
    pub fn is_rec_709(&self) -> bool {
        let pairs = |it: &Self| [it.red, it.green, it.blue, it.white];
        let all = pairs(self).into_iter().zip(pairs(&Self::REC_709));
        all.into_iter().all(|(a, b)| (a - b).abs().max_element() < SAME)
    }

    /// What takes colours to linear Rec. 709; white stays white. None where they span no colours.
    pub fn to_rec_709(&self) -> Option<DMat3> {
        let own = self.to_xyz()?;
        let target = Self::REC_709.to_xyz()?;
        let [from, to] = [CONES * (own * DVec3::ONE), CONES * (target * DVec3::ONE)];
        let adapt = CONES.inverse() * DMat3::from_diagonal(to / from) * CONES;
        let matrix = target.inverse() * adapt * own;
        matrix.is_finite().then_some(matrix)
    }

    /// The shares of red, green and blue in the luminance; they add up to 1.
    pub fn luminance(&self) -> Option<DVec3> {
        Some(self.to_xyz()?.row(1))
    }

    /// What takes colours to CIE XYZ, where white has the luminance 1.
    fn to_xyz(self) -> Option<DMat3> {
        let point = |at: DVec2| DVec3::new(at.x, at.y, 1.0 - at.x - at.y);
        let mixed = DMat3::from_cols(point(self.red), point(self.green), point(self.blue));
        let white = point(self.white) / self.white.y;
        if mixed.determinant().abs() < 1e-6 || !white.is_finite() {
            return None;
        }
        let matrix = mixed * DMat3::from_diagonal(mixed.inverse() * white);
        matrix.is_finite().then_some(matrix)
    }
}

/// Takes all colours through a matrix.
pub fn transform(matrix: &DMat3, pixels: &mut [[f32; 3]]) {
    for pixel in pixels {
        *pixel = (*matrix * DVec3::from_array(pixel.map(f64::from))).as_vec3().to_array();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: [f64; 3]) -> bool {
        (a - DVec3::from_array(b)).abs().max_element() < 1e-3
    }

    #[test]
    fn the_luminance_of_rec_709_is_the_known_one() {
        let shares = Primaries::REC_709.luminance().expect("they span colours");
        assert!(near(shares, [0.2126, 0.7152, 0.0722]), "{shares}");
    }

    /// Against ITU-R BT.2407, which gives this matrix from Rec. 2020 to Rec. 709.
    #[test]
    fn rec_2020_is_taken_to_rec_709() {
        let wide = [0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329];
        let wide = Primaries::from_array(wide);
        assert!(!wide.is_rec_709() && Primaries::REC_709.is_rec_709());
        let matrix = wide.to_rec_709().expect("they span colours");
        assert!(near(matrix.x_axis, [1.6605, -0.1246, -0.0182]), "{matrix}");
        assert!(near(matrix.y_axis, [-0.5876, 1.1329, -0.1006]), "{matrix}");
        assert!(near(matrix.z_axis, [-0.0728, -0.0083, 1.1187]), "{matrix}");
    }

    #[test]
    fn white_stays_white_and_what_is_no_colours_is_none() {
        let radiance = Primaries::from_array([0.64, 0.33, 0.29, 0.6, 0.15, 0.06, 0.333, 0.333]);
        let matrix = radiance.to_rec_709().expect("they span colours");
        assert!(near(matrix * DVec3::ONE, [1.0; 3]), "{matrix}");
        // CIE XYZ itself.
        let third = 1.0 / 3.0;
        let xyz = Primaries::from_array([1.0, 0.0, 0.0, 1.0, 0.0, 0.0, third, third]);
        let matrix = xyz.to_rec_709().expect("they span colours");
        assert!(near(matrix * DVec3::ONE, [1.0; 3]), "{matrix}");
        assert_eq!(Primaries::from_array([0.0; 8]).to_rec_709(), None);
        assert_eq!(Primaries::from_array([0.3; 8]).to_rec_709(), None);
    }
}
