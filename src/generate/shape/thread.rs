//! The threads of screws.

use super::Shape;
use super::detail::circle;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// Two flanks that wind about +Y, downwards from height 0; its ends are open, to be covered.
#[derive(Clone, Debug)]
pub struct Thread {
    /// Of the crest.
    pub radius: f64,
    /// From crest to root.
    pub depth: f64,
    /// Height of a turn.
    pub pitch: f64,
    /// Whole turns.
    pub turns: usize,
}

fn columns(level: u32) -> usize {
    (5 + level / 2).min(128) as usize
}

impl Shape for Thread {
    fn count(&self, level: u32) -> u64 {
        (4 * columns(level) * self.turns) as u64
    }

    fn build(&self, level: u32) -> Tessellation {
        let columns = columns(level);
        let around = circle(columns);
        let mut made = Tessellation::default();
        let root = self.radius - self.depth;
        let bottom = -(self.turns as f64 + 1.0) * self.pitch;
        let slope = self.pitch / std::f64::consts::TAU;
        let mut flanks: [[Vec<u32>; 2]; 2] = Default::default();
        for step in 0..=columns * self.turns {
            let (sin, cos) = around[step % columns];
            let (out, side) = (DVec3::new(sin, 0.0, cos), DVec3::new(cos, 0.0, -sin));
            let low = bottom + self.pitch * step as f64 / columns as f64;
            for (flank, [from, to]) in
                [[(0.0, root), (0.5, self.radius)], [(0.5, self.radius), (1.0, root)]]
                    .into_iter()
                    .enumerate()
            {
                let point = |(turn, radius): (f64, f64)| {
                    out * radius + DVec3::Y * (low + turn * self.pitch)
                };
                let (from, to) = (point(from), point(to));
                for (edge, at) in [from, to].into_iter().enumerate() {
                    let radius = at.dot(out);
                    let normal = (side * radius + DVec3::Y * slope).cross(to - from);
                    flanks[flank][edge].push(made.vertex(at, normal));
                }
            }
        }
        for [from, to] in &flanks {
            made.band(from, to, false);
        }
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.radius + self.pitch * self.turns as f64
    }
}
