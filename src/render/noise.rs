//! When the noise of a tile is low enough.
//!
//! At doublings of the samples, tiles are told to stop. How far a pixel has moved since it had half
//! of its samples tells its error: of two independent halves, the square of that step has the mean
//! of the variance of all. The squares of samples, from which the layer `variance` is made, would
//! tell what independent samples have; ours are stratified, and their error is a fraction of that.
//!
//! The decision is a function of the sums alone, so a picture has the same bits whatever threads,
//! structures and interruptions made it. It looks at the neighbours too: a tile that has missed a
//! rare bright path is likely to have a neighbour that has not.
//!
//! Stopping by the samples themselves biases what is shown, for tiles stop sooner where chance has
//! made them dark: the more samples before the first decision, the less. Kirk and Arvo 1991,
//! "Unbiased sampling techniques for image synthesis".

use super::earlier::Earlier;
use super::noise_target::NoiseReached;
use super::tile::{SIDE, Tile};
use crate::film::Window;

/// Of the mean radiance of the picture: darker tiles are held to this, for noise in the dark is
/// not seen.
const DARK: f64 = 0.01;

/// The tiles of a part of the frame, row by row, and how their errors lie beside each other.
pub(super) struct Grid {
    /// Tiles in a row.
    columns: usize,
    /// The errors of the last decision, by tile.
    errors: Vec<f64>,
}

impl Grid {
    /// The errors that the tiles were told.
    pub fn new<'t>(crop: Window, tiles: impl Iterator<Item = &'t Tile>) -> Self {
        let side = SIDE as i32;
        let columns = ((crop.x1 - 1) / side - crop.x0 / side + 1) as usize;
        Self { columns, errors: tiles.map(|tile| tile.earlier.error).collect() }
    }

    /// Whether a tile and its neighbours are below a target.
    pub fn is_low(&self, tile: usize, target: f64) -> bool {
        let (row, column) = (tile / self.columns, tile % self.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(self.errors.len() / self.columns);
        let columns = column.saturating_sub(1)..(column + 2).min(self.columns);
        rows.flat_map(|row| columns.clone().map(move |column| row * self.columns + column))
            .all(|near| self.errors[near] <= target)
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

/// The radiance below which tiles count as dark.
pub(super) fn dark_level<'t>(tiles: impl Iterator<Item = &'t Tile>) -> f64 {
    let (mut sum, mut pixels) = (0.0, 0_usize);
    for (_, _, pixel) in tiles.flat_map(Tile::iter) {
        sum += pixel.radiance().iter().sum::<f64>() / 3.0;
        pixels += 1;
    }
    DARK * sum / pixels.max(1) as f64
}

/// Works out the error of a tile and remembers its pixels, for the next time it has twice as many
/// samples.
pub(super) fn tell_error(tile: &mut Tile, dark: f64) {
    let now: Vec<[f64; 3]> = tile.iter().map(|(_, _, pixel)| pixel.radiance()).collect();
    let (samples, then) = (tile.range.end, &tile.earlier);
    let mut error = f64::INFINITY;
    if then.samples > 0 && then.samples < samples {
        let (mut square, mut level) = (0.0, 0.0);
        for (now, then) in now.iter().zip(&then.means) {
            for (now, &then) in now.iter().zip(then) {
                let step = now - f64::from(then);
                square += step * step;
                level += now;
            }
        }
        let values = 3.0 * now.len() as f64;
        let halves = then.samples as f64 / (samples - then.samples) as f64;
        let (variance, level) = (square / values * halves, (level / values).max(dark));
        error = if level > 0.0 { variance.sqrt() / level } else { 0.0 };
    }
    let means = now.into_iter().map(|pixel| pixel.map(|value| value as f32)).collect();
    tile.earlier = Earlier { error, samples, means };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::render::tile::tile_windows;

    /// Adds so many samples of a level to each pixel of a tile.
    fn add(tile: &mut Tile, level: f32, count: u64) {
        for pixel in &mut tile.pixels {
            for _ in 0..count {
                pixel.add(Vec3::splat(level), None);
            }
        }
        tile.range.end += count;
    }

    #[test]
    fn errors_are_how_far_pixels_move_over_the_level_of_the_tile() {
        let mut tile = Tile::new(Window::of_size(16, 4), 0);
        add(&mut tile, 1.0, 16);
        tell_error(&mut tile, 0.0);
        assert_eq!(tile.earlier.error, f64::INFINITY, "nothing to compare with");
        add(&mut tile, 2.0, 16);
        let mut dark = tile.clone();
        tell_error(&mut tile, 0.0);
        assert!((tile.earlier.error - 0.5 / 1.5).abs() < 1e-12, "a step of .5 to 1.5");
        tell_error(&mut dark, 5.0);
        assert!((dark.earlier.error - 0.5 / 5.0).abs() < 1e-12, "held to the level of the dark");
        add(&mut tile, 0.75, 16);
        tell_error(&mut tile, 0.0);
        // A step of .25 to 1.25 by half as many samples as before: variance 2 * .25².
        assert!((tile.earlier.error - 0.25 * 2.0_f64.sqrt() / 1.25).abs() < 1e-12);
        let mut black = Tile::new(Window::of_size(1, 1), 0);
        add(&mut black, 0.0, 16);
        tell_error(&mut black, 0.0);
        add(&mut black, 0.0, 16);
        tell_error(&mut black, 0.0);
        assert_eq!(black.earlier.error, 0.0);
    }

    /// Of independent samples, the error that is told is the error that there is.
    #[test]
    fn the_error_of_independent_samples_is_told_right() {
        let mut told = 0.0;
        let mut sampler = crate::sampling::Sampler::new(1, 2, 3);
        for _ in 0..64 {
            let mut tile = Tile::new(Window::of_size(16, 16), 0);
            for round in 0..2 {
                for pixel in &mut tile.pixels {
                    (0..16).for_each(|_| pixel.add(Vec3::splat(sampler.next_2d().x), None));
                }
                tile.range.end = 16 * (round + 1);
                tell_error(&mut tile, 0.0);
            }
            told += tile.earlier.error / 64.0;
        }
        let expected = (1.0 / 12.0 / 32.0_f64).sqrt() / 0.5;
        assert!((told / expected - 1.0).abs() < 0.05, "{told} for {expected}");
    }

    #[test]
    fn a_noisy_tile_keeps_its_neighbours() {
        let crop = Window { x0: 8, y0: 0, x1: 80, y1: 64 }; // five columns, four rows
        let mut tiles: Vec<Tile> =
            tile_windows(crop).into_iter().map(|window| Tile::new(window, 0)).collect();
        for (at, tile) in tiles.iter_mut().enumerate() {
            tile.earlier.error = if at == 6 { 0.5 } else { 0.0 };
        }
        let grid = Grid::new(crop, tiles.iter());
        let low: Vec<usize> = (0..20).filter(|&at| grid.is_low(at, 0.1)).collect();
        assert_eq!(low, [3, 4, 8, 9, 13, 14, 15, 16, 17, 18, 19]);
        assert_eq!(grid.reached(0.1), NoiseReached { largest: 0.5, share: 11.0 / 20.0 });
    }
}
