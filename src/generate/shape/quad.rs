//! Flat rectangles.

use super::Shape;
use crate::generate::tessellation::Tessellation;
use crate::math::{DVec2, DVec3};

/// A rectangle about the origin that faces +Y: two triangles, always.
#[derive(Clone, Debug)]
pub struct Quad {
    /// Half its sides along X and Z.
    pub half: DVec2,
}

impl Shape for Quad {
    fn count(&self, _level: u32) -> u64 {
        2
    }

    fn build(&self, _level: u32) -> Tessellation {
        let mut made = Tessellation::default();
        let corner = |x: f64, z: f64| DVec3::new(x * self.half.x, 0.0, z * self.half.y);
        made.flat_quad([
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ]);
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.length()
    }
}
