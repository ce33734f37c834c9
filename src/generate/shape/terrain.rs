//! Land.

use super::Shape;
use crate::generate::ground::Ground;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// A square of land about the origin, as a grid.
#[derive(Clone, Debug)]
pub struct Terrain(pub Ground);

/// Cells along a side.
fn cells(level: u32) -> u64 {
    16 * (1 + u64::from(level))
}

impl Shape for Terrain {
    fn count(&self, level: u32) -> u64 {
        2 * cells(level) * cells(level)
    }

    fn build(&self, level: u32) -> Tessellation {
        let Self(ground) = self;
        let (cells, mut made) = (cells(level), Tessellation::default());
        let place = |i: u64| (2.0 * i as f64 / cells as f64 - 1.0) * ground.half;
        let rows: Vec<Vec<u32>> = (0..=cells)
            .map(|j| {
                let z = place(j);
                let corner = |i| {
                    let x = place(i);
                    made.vertex(ground.at(x, z), ground.normal(x, z))
                };
                (0..=cells).map(corner).collect()
            })
            .collect();
        for pair in rows.windows(2) {
            made.band(&pair[1], &pair[0], false);
        }
        made
    }

    fn extent(&self) -> f64 {
        2.0 * DVec3::new(self.0.half, 0.0, self.0.half).length()
    }
}
