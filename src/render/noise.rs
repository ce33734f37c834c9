//! When the noise of a tile is low enough.
//!
//! At doublings of the samples, tiles are told to stop by the error that the variance of their
//! pixels tells. The decision is a function of the sums alone, so a picture has the same bits
//! whatever threads, structures and interruptions made it. It looks at the neighbours too: a tile
//! that has missed a rare bright path is likely to have a neighbour that has not.
//!
//! Stopping by the samples themselves biases what is shown, for tiles stop sooner where chance has
//! made them dark: the more samples before the first decision, the less. Kirk and Arvo 1991,
//! "Unbiased sampling techniques for image synthesis"; the tests of closed forms hold ours small.

use super::tile::{SIDE, Tile};
use crate::film::Window;

/// How good a picture is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseTarget {
    /// The relative error of each tile: root of the mean variance of its pixels over their mean.
    pub error: f32,
    /// Samples that each pixel takes whatever its noise.
    pub min_spp: u64,
}

/// How good a picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReached {
    /// The largest relative error of a tile.
    pub largest: f64,
    /// The share of tiles whose error, and that of their neighbours, is below the target.
    pub share: f64,
}

/// Of the mean radiance of the picture: darker tiles are held to this, for noise in the dark is
/// not seen.
const DARK: f64 = 0.01;

/// The relative errors of tiles.
pub(super) struct Errors {
    /// By tile.
    errors: Vec<f64>,
    /// Tiles in a row.
    columns: usize,
}

impl Errors {
    /// Measures all tiles of a part of the frame, row by row.
    pub fn measure<'t>(crop: Window, tiles: impl Iterator<Item = &'t Tile>) -> Self {
        let sums: Vec<_> = tiles.map(sum_up).collect();
        let pixels = crop.area().max(1) as f64;
        let dark = DARK * sums.iter().map(|tile| tile.radiance).sum::<f64>() / pixels;
        let error = |tile: &Sums| {
            let (mean, variance) = (tile.radiance / tile.pixels, tile.variance / tile.pixels);
            let level = mean.max(dark);
            if level > 0.0 { variance.sqrt() / level } else { 0.0 }
        };
        let side = SIDE as i32;
        let columns = ((crop.x1 - 1) / side - crop.x0 / side + 1) as usize;
        Self { errors: sums.iter().map(error).collect(), columns }
    }

    /// Whether a tile and its neighbours are below a target.
    pub fn is_low(&self, tile: usize, target: f64) -> bool {
        let (row, column) = (tile / self.columns, tile % self.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(self.errors.len() / self.columns);
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        rows.flat_map(|row| columns.clone().map(move |column| row * self.columns + column))
            .all(|near| self.errors[near] <= target)
    }

    /// How much larger than a target a tile's error is.
    pub fn excess(&self, tile: usize, target: f64) -> f64 {
        self.errors[tile] / target
    }

    /// What they come to.
    pub fn reached(&self, target: f64) -> NoiseReached {
        let low = (0..self.errors.len()).filter(|&tile| self.is_low(tile, target)).count();
        NoiseReached {
            largest: self.errors.iter().copied().fold(0.0, f64::max),
            share: low as f64 / self.errors.len().max(1) as f64,
        }
    }
}

/// Sums over the pixels of a tile, of the mean of their channels.
struct Sums {
    pixels: f64,
    radiance: f64,
    variance: f64,
}

fn sum_up(tile: &Tile) -> Sums {
    let mut sums = Sums { pixels: 0.0, radiance: 0.0, variance: 0.0 };
    for (_, _, pixel) in tile.iter() {
        let (radiance, variance) = pixel.radiance_and_variance();
        sums.pixels += 1.0;
        sums.radiance += radiance.iter().sum::<f64>() / 3.0;
        sums.variance += variance.iter().sum::<f64>() / 3.0;
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::render::tile::tile_windows;

    /// Tiles of four samples: two of `level - spread`, two of `level + spread`.
    fn tiles(crop: Window, levels: &dyn Fn(usize) -> (f32, f32)) -> Vec<Tile> {
        let windows = tile_windows(crop).into_iter().enumerate();
        let of = |(at, window)| {
            let (level, spread) = levels(at);
            let mut tile = Tile::new(window, 0);
            for pixel in &mut tile.pixels {
                for sign in [-1.0, 1.0, -1.0, 1.0] {
                    pixel.add(Vec3::splat(level + sign * spread), None);
                }
            }
            tile
        };
        windows.map(of).collect()
    }

    #[test]
    fn errors_are_relative_to_the_tile_and_held_to_a_level_in_the_dark() {
        let crop = Window::of_size(48, 20);
        let level = |at: usize| match at {
            0 => (2.0, 0.2),
            1 => (0.0, 0.001),
            _ => (1.0, 0.0),
        };
        let errors = Errors::measure(crop, tiles(crop, &level).iter());
        // Squared deviations of .2² over 3, and over 4 for the mean.
        let expected = (4.0 * 0.04 / 12.0_f64).sqrt() / 2.0;
        assert!((errors.errors[0] - expected).abs() < 1e-6);
        let mean = (2.0 * 256.0 + 256.0 + 3.0 * 64.0) / 960.0;
        let expected = (4.0 * 1e-6 / 12.0_f64).sqrt() / (0.01 * mean);
        assert!((errors.errors[1] - expected).abs() < 1e-4, "{}", errors.errors[1]);
        let black = Errors::measure(crop, tiles(crop, &|_| (0.0, 0.0)).iter());
        assert_eq!(black.reached(0.01), NoiseReached { largest: 0.0, share: 1.0 });
    }

    #[test]
    fn a_noisy_tile_keeps_its_neighbours() {
        let crop = Window { x0: 8, y0: 0, x1: 80, y1: 64 }; // five columns, four rows
        let level = |at: usize| (1.0, if at == 6 { 0.5 } else { 0.0 });
        let errors = Errors::measure(crop, tiles(crop, &level).iter());
        let low: Vec<usize> = (0..20).filter(|&at| errors.is_low(at, 0.1)).collect();
        assert_eq!(low, [3, 4, 8, 9, 13, 14, 15, 16, 17, 18, 19]);
        assert_eq!(errors.reached(0.1).share, 11.0 / 20.0);
    }
}
