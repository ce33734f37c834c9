//! The ground of a forest: a glade, a trail that leads away from it, and hills.

use super::piece::Piece;
use crate::generate::ground::{noise, octaves};
use crate::math::DVec3;

/// A square of land about the origin, a grid that is finest in the middle.
#[derive(Clone, Debug)]
pub struct Land {
    seed: u64,
    /// Half its side, metres.
    half: f64,
    /// Cells along a side.
    cells: usize,
    /// Heights of the corners, row by row.
    heights: Vec<f64>,
}

/// The share of the grid's spacing that is even.
const EVEN: f64 = 0.07;

/// Where the trail is at some `z`.
pub fn trail(z: f64) -> f64 {
    2.3 * libm::sin(z / 11.0) + 0.7 * libm::sin(z / 4.7 + 1.0)
}

impl Land {
    /// Land whose forest is within `reach` metres, of at most so many triangles.
    pub fn new(triangles: u64, reach: f64, seed: u64) -> Self {
        let cells = ((triangles / 2) as f64).sqrt() as usize;
        let cells = cells.clamp(4, 4096);
        let half = (2.5 * reach).max(400.0);
        let mut land = Self { seed, half, cells, heights: Vec::new() };
        let heights = (0..=cells).flat_map(|j| (0..=cells).map(move |i| (i, j)));
        let height = |(i, j): (usize, usize)| land.shape(land.place(i), land.place(j));
        land.heights = heights.map(height).collect();
        land
    }

    /// Where a line of the grid is.
    fn place(&self, line: usize) -> f64 {
        let u = 2.0 * line as f64 / self.cells as f64 - 1.0;
        self.half * u * (EVEN + (1.0 - EVEN) * u * u)
    }

    /// The cell that a coordinate is in.
    fn cell(&self, x: f64) -> usize {
        // The lines are in order: they are bisected.
        let (mut low, mut high) = (0, self.cells);
        while high - low > 1 {
            let middle = usize::midpoint(low, high);
            if self.place(middle) <= x { low = middle } else { high = middle }
        }
        low
    }

    /// How high the land is meant to be.
    fn shape(&self, x: f64, z: f64) -> f64 {
        let away = (x * x + z * z).sqrt();
        let near = 0.22 * octaves(self.seed, x / 7.0, z / 7.0, 3);
        let rolling = 1.1 * octaves(self.seed ^ 0x17, x / 31.0 + 0.3, z / 31.0 + 0.7, 3);
        let far = ((away - 45.0) / 300.0).clamp(0.0, 2.0);
        let hills = 24.0 * far * far * (1.0 + 0.7 * noise(self.seed ^ 0x2b, x / 160.0, z / 160.0));
        let calm = (away / 24.0).min(1.0);
        let beside = ((x - trail(z)).abs() / 3.0).min(1.0);
        (near + rolling * calm) * (0.25 + 0.75 * beside) + hills - 0.12 * (1.0 - beside)
    }

    /// The height of the grid's triangles.
    pub fn height(&self, x: f64, z: f64) -> f64 {
        let (i, j) = (self.cell(x), self.cell(z));
        let at = |di: usize, dj: usize| self.heights[(j + dj) * (self.cells + 1) + i + di];
        let share = |x: f64, line: usize| {
            let (low, high) = (self.place(line), self.place(line + 1));
            ((x - low) / (high - low)).clamp(0.0, 1.0)
        };
        let (u, v) = (share(x, i), share(z, j));
        // The diagonal runs from the first corner to the last.
        let (first, last) = (at(0, 0), at(1, 1));
        if u >= v {
            first + (at(1, 0) - first) * u + (last - at(1, 0)) * v
        } else {
            first + (at(0, 1) - first) * v + (last - at(0, 1)) * u
        }
    }

    /// Upwards from the land.
    pub fn normal(&self, x: f64, z: f64) -> DVec3 {
        const STEP: f64 = 0.4;
        let slope = |dx: f64, dz: f64| self.shape(x + dx, z + dz) - self.shape(x - dx, z - dz);
        DVec3::new(-slope(STEP, 0.0), 2.0 * STEP, -slope(0.0, STEP)).normalize()
    }

    /// Soil, moss, grass and fallen leaves.
    fn color(&self, x: f64, z: f64) -> DVec3 {
        let patch = 0.5 + 0.5 * noise(self.seed ^ 0x3d, x / 1.7, z / 1.7);
        let wide = 0.5 + 0.5 * noise(self.seed ^ 0x41, x / 19.0, z / 19.0);
        let moss = DVec3::new(0.23, 0.31, 0.09);
        let litter = DVec3::new(0.36, 0.24, 0.12);
        let soil = DVec3::new(0.5, 0.34, 0.2);
        let away = (x * x + z * z).sqrt();
        let meadow = ((away - 60.0) / 80.0).clamp(0.0, 1.0);
        let floor = litter.lerp(moss, (0.2 + 0.45 * patch + 0.5 * wide).min(1.0));
        let floor = floor.lerp(DVec3::new(0.2, 0.3, 0.09), meadow);
        let beside = ((x - trail(z)).abs() - 0.2 - 0.3 * patch).clamp(0.0, 0.7) / 0.7;
        if away > 90.0 { floor } else { soil.lerp(floor, beside) }
    }

    /// Its triangles.
    pub fn build(&self, material: usize) -> Piece {
        let mut piece = Piece::new(material);
        let side = self.cells + 1;
        for (number, &height) in self.heights.iter().enumerate() {
            let (x, z) = (self.place(number % side), self.place(number / side));
            let at = DVec3::new(x, height, z);
            piece.corner(at, self.color(x, z));
        }
        for j in 0..self.cells {
            for i in 0..self.cells {
                let corner = |di: usize, dj: usize| ((j + dj) * side + i + di) as u32;
                let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
                piece.indices.extend([[a, c, b], [a, d, c]]);
            }
        }
        piece.smooth();
        piece
    }

    /// How many triangles it has.
    pub fn triangles(&self) -> u64 {
        2 * (self.cells * self.cells) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_on_the_land_stands_on_its_triangles() {
        let land = Land::new(800, 50.0, 3);
        let piece = land.build(0);
        assert_eq!(piece.indices.len() as u64, land.triangles());
        for triangle in &piece.indices {
            let corners = triangle.map(|i| DVec3::from(piece.positions[i as usize].map(f64::from)));
            let [a, b, c] = corners;
            assert!((b - a).cross(c - a).y > 0.0, "it faces upwards");
            let middle = (a + b + c) / 3.0;
            let height = land.height(middle.x, middle.z);
            assert!((height - middle.y).abs() < 1e-3, "{height} at {middle}");
        }
    }
}
