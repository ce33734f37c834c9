//! The rooms that a machine gives to its units.

use crate::math::DVec3;

/// Size of the room that a unit takes, metres.
pub(super) const CELL: DVec3 = DVec3::new(0.56, 0.53, 0.48);

/// Height of the lowest units over the floor.
pub(super) const BASE: f64 = 0.1;

/// Units by their number along each axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid(pub [usize; 3]);

impl Grid {
    /// More units for more triangles, but fewer than in proportion: each also becomes finer.
    pub fn for_triangles(triangles: u64) -> Self {
        Self(match triangles {
            0..16_000 => [1, 1, 1],
            16_000..50_000 => [2, 1, 1],
            50_000..100_000 => [2, 2, 1],
            100_000..250_000 => [3, 2, 1],
            250_000..500_000 => [3, 2, 2],
            500_000..1_500_000 => [4, 2, 2],
            1_500_000..3_000_000 => [4, 3, 2],
            3_000_000..10_000_000 => [5, 3, 2],
            _ => [5, 3, 3],
        })
    }

    /// The machine's, without what stands out.
    pub fn size(self) -> DVec3 {
        DVec3::from(self.0.map(|n| n as f64)) * CELL + DVec3::Y * BASE
    }

    /// The middle of a unit's room; the machine stands on height 0, its middle over the origin.
    pub fn centre(self, x: usize, y: usize, z: usize) -> DVec3 {
        let number = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5);
        let size = self.size();
        number * CELL + DVec3::new(-0.5 * size.x, BASE, -0.5 * size.z)
    }
}
