//! Boxes with fillets along their edges.

use std::f64::consts::FRAC_PI_2;

use super::Shape;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// A box about the origin. Its faces stay two triangles each, however fine its fillets.
#[derive(Clone, Debug)]
pub struct RoundedBox {
    /// Half its sides.
    pub half: DVec3,
    /// Radius of the fillets, below the least half side.
    pub fillet: f64,
}

/// Segments of a fillet; 0: edges are sharp.
fn segments(level: u32) -> usize {
    if level == 0 { 0 } else { (1 + (level as usize - 1) / 4).min(24) }
}

impl Shape for RoundedBox {
    fn count(&self, level: u32) -> u64 {
        let k = segments(level) as u64;
        // The two large faces across Y, the rows next to them, and the rows between those.
        if k == 0 { 12 } else { 4 + 2 * (4 * k + 8) + (2 * k - 1) * 8 * (k + 1) }
    }

    fn build(&self, level: u32) -> Tessellation {
        match segments(level) {
            0 => self.sharp(),
            k => self.rounded(k),
        }
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.length()
    }
}

impl RoundedBox {
    fn sharp(&self) -> Tessellation {
        let mut made = Tessellation::default();
        for (normal, right) in [
            (DVec3::X, DVec3::NEG_Z),
            (DVec3::NEG_X, DVec3::Z),
            (DVec3::Y, DVec3::X),
            (DVec3::NEG_Y, DVec3::X),
            (DVec3::Z, DVec3::X),
            (DVec3::NEG_Z, DVec3::NEG_X),
        ] {
            let up = normal.cross(right);
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

    fn rounded(&self, k: usize) -> Tessellation {
        let mut made = Tessellation::default();
        let mut rows = Vec::new();
        for (half, sign) in [(0, -1.0), (1, 1.0)] {
            for i in 0..=k {
                let step = if half == 0 { k - i } else { i };
                rows.push(self.row(&mut made, sign, step, k));
            }
        }
        for pair in rows.windows(2) {
            made.band(&pair[0], &pair[1], true);
        }
        let corner = |row: &[u32], i: usize| row[i * (k + 1)];
        let (bottom, top) = (&rows[0], &rows[2 * k + 1]);
        made.quad([3, 2, 1, 0].map(|i| corner(bottom, i)));
        made.quad([0, 1, 2, 3].map(|i| corner(top, i)));
        made
    }

    /// A rounded rectangle at `step` of `k` from the middle towards the pole; at the pole its
    /// four corners are points.
    fn row(&self, made: &mut Tessellation, sign: f64, step: usize, k: usize) -> Vec<u32> {
        let core = self.half - self.fillet;
        let (sin, cos) = libm::sincos(FRAC_PI_2 * step as f64 / k as f64);
        let mut row = Vec::with_capacity(4 * (k + 1));
        for (corner, (x, z)) in
            [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].into_iter().enumerate()
        {
            let centre = DVec3::new(x, sign, z) * core;
            if step == k {
                let pole = DVec3::Y * sign;
                let vertex = made.vertex(centre + pole * self.fillet, pole);
                row.extend(std::iter::repeat_n(vertex, k + 1));
                continue;
            }
            for j in 0..=k {
                let turn = FRAC_PI_2 * (corner as f64 + j as f64 / k as f64);
                let (sin_turn, cos_turn) = libm::sincos(turn);
                let normal = DVec3::new(cos * sin_turn, sign * sin, cos * cos_turn);
                row.push(made.vertex(centre + normal * self.fillet, normal));
            }
        }
        row
    }
}
