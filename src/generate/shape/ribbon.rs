//! Bands of any number of triangles.

use super::Shape;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// A flat cable along X that hangs in waves and faces +Y: of `level` + 1 triangles. This is what
/// makes the number of a scene's triangles come out.
#[derive(Clone, Debug)]
pub struct Ribbon {
    /// Along X.
    pub length: f64,
    /// Along Z.
    pub width: f64,
}

impl Shape for Ribbon {
    fn count(&self, level: u32) -> u64 {
        u64::from(level) + 1
    }

    fn build(&self, level: u32) -> Tessellation {
        let mut made = Tessellation::default();
        // The front has the odd triangle more; beside a lone one the back is a point.
        let back = level.div_ceil(2);
        let steps = [level + 1 - back, back];
        let mut side = |steps: u32, z: f64| -> Vec<u32> {
            let point = |i: u32| {
                let share = if steps == 0 { 0.5 } else { f64::from(i) / f64::from(steps) };
                let (sin, cos) = libm::sincos(share * 3.0 * std::f64::consts::TAU);
                let (height, slope) = (0.15 * sin, 0.15 * cos * 3.0 * std::f64::consts::TAU);
                let at =
                    DVec3::new((share - 0.5) * self.length, height * self.width, z * self.width);
                made.vertex(at, DVec3::new(-slope * self.width / self.length, 1.0, 0.0))
            };
            (0..=steps).map(point).collect()
        };
        let (front, back) = (side(steps[0], 0.5), side(steps[1], -0.5));
        let (mut i, mut j) = (0, 0);
        while i + 1 < front.len() || j + 1 < back.len() {
            let front_is_behind = i * back.len() <= j * front.len();
            if i + 1 < front.len() && (front_is_behind || j + 1 == back.len()) {
                made.triangle([front[i], front[i + 1], back[j]]);
                i += 1;
            } else {
                made.triangle([back[j], front[i], back[j + 1]]);
                j += 1;
            }
        }
        made
    }

    fn extent(&self) -> f64 {
        self.length
    }
}
