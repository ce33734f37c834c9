//! Rooms.

use super::Shape;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// The inside of a box about the origin: closed, and of twelve triangles, always.
#[derive(Clone, Debug)]
pub struct Shell {
    /// Half its sides.
    pub half: DVec3,
}

impl Shape for Shell {
    fn count(&self, _level: u32) -> u64 {
        12
    }

    fn build(&self, _level: u32) -> Tessellation {
        let mut made = Tessellation::default();
        for (normal, right) in [
            (DVec3::X, DVec3::Z),
            (DVec3::NEG_X, DVec3::NEG_Z),
            (DVec3::Y, DVec3::NEG_X),
            (DVec3::NEG_Y, DVec3::NEG_X),
            (DVec3::Z, DVec3::NEG_X),
            (DVec3::NEG_Z, DVec3::X),
        ] {
            // Counter-clockwise as seen from the middle.
            let up = (-normal).cross(right);
            let corner = |x: f64, y: f64| (normal + right * x + up * y) * self.half;
            made.flat_quad([
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ]);
        }
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.length()
    }
}
