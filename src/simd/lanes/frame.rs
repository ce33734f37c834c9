//! Orthonormal frames, one a lane.

use super::traits::{Float, Lanes};
use super::vec3f::Vec3f;

/// A right-handed orthonormal frame in each lane; with one lane it has the bits of
/// [`crate::math::Frame`].
#[derive(Clone, Copy)]
pub struct FrameLanes<L: Lanes> {
    /// First axis.
    pub tangent: Vec3f<L>,
    /// Second axis.
    pub bitangent: Vec3f<L>,
    /// Third axis.
    pub normal: Vec3f<L>,
}

impl<L: Lanes> FrameLanes<L> {
    /// Some frame about a unit `normal`; see [`crate::math::Frame::from_normal`].
    #[inline(always)]
    pub fn from_normal(lanes: L, normal: Vec3f<L>) -> Self {
        let Vec3f { x, y, z } = normal;
        let sign = lanes.float(1.0).copysign(z);
        let a = lanes.float(-1.0) / (sign + z);
        let b = x * y * a;
        Self {
            tangent: Vec3f { x: sign * x * x * a + 1.0, y: sign * b, z: -sign * x },
            bitangent: Vec3f { x: b, y: sign + y * y * a, z: -y },
            normal,
        }
    }

    /// From world to this frame.
    #[inline(always)]
    pub fn to_local(self, v: Vec3f<L>) -> Vec3f<L> {
        Vec3f { x: v.dot(self.tangent), y: v.dot(self.bitangent), z: v.dot(self.normal) }
    }

    /// From this frame to world.
    #[inline(always)]
    pub fn to_world(self, v: Vec3f<L>) -> Vec3f<L> {
        self.tangent.scale(v.x) + self.bitangent.scale(v.y) + self.normal.scale(v.z)
    }
}
