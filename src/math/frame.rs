//! Orthonormal frames, and a turn from one to another.

use glam::{Mat3, Vec3};

/// A right-handed orthonormal frame; `normal` is its third axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// First axis.
    pub tangent: Vec3,
    /// Second axis.
    pub bitangent: Vec3,
    /// Third axis.
    pub normal: Vec3,
}

impl Frame {
    /// Some frame about a unit `normal`.
    ///
    /// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
    #[inline]
    pub fn from_normal(normal: Vec3) -> Self {
        let sign = 1.0_f32.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: Vec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The frame about a unit `normal` whose tangent is the nearest to `tangent`; any frame where
    /// the two are parallel or `tangent` is zero.
    pub fn from_normal_tangent(normal: Vec3, tangent: Vec3) -> Self {
        let along = tangent - normal * normal.dot(tangent);
        match along.try_normalize() {
            Some(tangent) => Self { tangent, bitangent: normal.cross(tangent), normal },
            None => Self::from_normal(normal),
        }
    }

    /// From world to this frame.
    #[inline]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.tangent), v.dot(self.bitangent), v.dot(self.normal))
    }

    /// From this frame to world.
    #[inline]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.tangent * v.x + self.bitangent * v.y + self.normal * v.z
    }
}

/// The turn by the shortest way that takes +Y to a unit direction.
pub fn turn_upright(up: Vec3) -> Mat3 {
    let (axis, cosine) = (Vec3::Y.cross(up), up.y); // of the turn; times its sine
    if cosine < -0.999_999 {
        return Mat3::from_diagonal(Vec3::new(1.0, -1.0, -1.0));
    }
    let across = Mat3::from_cols(
        Vec3::new(0.0, axis.z, -axis.y),
        Vec3::new(-axis.z, 0.0, axis.x),
        Vec3::new(axis.y, -axis.x, 0.0),
    );
    Mat3::IDENTITY + across + across * across * (1.0 / (1.0 + cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        for normal in [Vec3::Z, -Vec3::Z, Vec3::X, Vec3::new(1.0, -2.0, -3.0).normalize()] {
            let frame = Frame::from_normal(normal);
            assert!(frame.tangent.cross(frame.bitangent).distance(normal) < 1e-6);
            assert!((frame.tangent.length() - 1.0).abs() < 1e-6);
            let v = Vec3::new(0.3, -0.5, 0.7);
            assert!(frame.to_world(frame.to_local(v)).distance(v) < 1e-6);
        }
    }

    #[test]
    fn the_turn_takes_up_there_by_the_shortest_way() {
        assert_eq!(turn_upright(Vec3::Y), Mat3::IDENTITY);
        for up in [Vec3::X, Vec3::Z, Vec3::NEG_Y, Vec3::NEG_Z, Vec3::new(0.6, -0.64, 0.48)] {
            let turn = turn_upright(up);
            assert!((turn * Vec3::Y).abs_diff_eq(up, 1e-6), "{up}");
            assert!((turn.determinant() - 1.0).abs() < 1e-5);
            assert!((turn * turn.transpose()).abs_diff_eq(Mat3::IDENTITY, 1e-5));
        }
        assert!((turn_upright(Vec3::Z) * Vec3::Z).abs_diff_eq(Vec3::NEG_Y, 1e-6));
    }
}
