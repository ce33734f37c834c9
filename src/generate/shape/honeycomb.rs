//! Honeycombs.

use super::Shape;
use crate::generate::tessellation::Tessellation;
use crate::math::{DVec2, DVec3};

/// A panel of open hexagonal cells across +Y, about the origin. More detail makes more cells.
#[derive(Clone, Debug)]
pub struct Honeycomb {
    /// Half its sides along X and Z.
    pub half: DVec2,
    /// Along Y.
    pub thickness: f64,
}

/// Triangles of a cell: two rims and the walls inside, two for each side.
const CELL: u64 = 36;

/// Width of the opening, as a share of the cell's.
const OPENING: f64 = 0.86;

impl Honeycomb {
    /// Cells along X and Z.
    fn cells(&self, level: u32) -> (usize, usize) {
        let columns = (2 + level).min(400) as usize;
        let pitch = 2.0 * self.half.x / columns as f64;
        // Rows are closer than columns by the height of an equilateral triangle.
        let rows = 2.0 * self.half.y / (pitch * 0.75_f64.sqrt());
        (columns, rows.clamp(1.0, 1000.0) as usize)
    }
}

impl Shape for Honeycomb {
    fn count(&self, level: u32) -> u64 {
        let (columns, rows) = self.cells(level);
        (columns * rows) as u64 * CELL
    }

    fn build(&self, level: u32) -> Tessellation {
        let (columns, rows) = self.cells(level);
        // Room for the odd rows, which are half a cell further.
        let pitch = 2.0 * self.half.x / (columns as f64 + 0.5);
        let row_pitch = 2.0 * self.half.y / (rows as f64 + 1.0 / 3.0);
        let scale = DVec2::new(pitch, row_pitch / 0.75_f64.sqrt());
        let mut made = Tessellation::default();
        for row in 0..rows {
            for column in 0..columns {
                let shift = 0.5 + 0.5 * (row % 2) as f64;
                let x = (column as f64 + shift) * pitch - self.half.x;
                let z = (row as f64 + 2.0 / 3.0) * row_pitch - self.half.y;
                self.cell(&mut made, DVec2::new(x, z), scale);
            }
        }
        made
    }

    fn extent(&self) -> f64 {
        2.0 * self.half.length()
    }
}

impl Honeycomb {
    fn cell(&self, made: &mut Tessellation, centre: DVec2, scale: DVec2) {
        // Corners at 30°, 90°, … of a hexagon 1 wide, from Z towards X.
        const CORNERS: [(f64, f64); 6] = [
            (0.0, 0.577_350_269_189_625_8),
            (0.5, 0.288_675_134_594_812_9),
            (0.5, -0.288_675_134_594_812_9),
            (0.0, -0.577_350_269_189_625_8),
            (-0.5, -0.288_675_134_594_812_9),
            (-0.5, 0.288_675_134_594_812_9),
        ];
        let corner = |i: usize, size: f64, up: f64| {
            let (x, z) = CORNERS[i % 6];
            let at = centre + DVec2::new(x, z) * scale * size;
            DVec3::new(at.x, up * 0.5 * self.thickness, at.y)
        };
        for up in [1.0, -1.0] {
            let ring = |made: &mut Tessellation, size: f64| -> Vec<u32> {
                (0..6).map(|i| made.vertex(corner(i, size, up), DVec3::Y * up)).collect()
            };
            let (outer, inner) = (ring(made, 1.0), ring(made, OPENING));
            if up > 0.0 {
                made.band(&outer, &inner, true);
            } else {
                made.band(&inner, &outer, true);
            }
        }
        for i in 0..6 {
            let wall = [(i, 1.0), (i + 1, 1.0), (i + 1, -1.0), (i, -1.0)];
            made.flat_quad(wall.map(|(i, up)| corner(i, OPENING, up)));
        }
    }
}
