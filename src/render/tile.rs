//! A tile of the frame: its pixels, and the sums of their samples.

use std::ops::Range;
use std::time::Instant;

use super::breakdown::Stage;
use super::earlier::Earlier;
use super::pixel::PixelSums;
use super::settings::Settings;
use super::start::Starts;
use super::stream::Stream;
use crate::camera::CameraRays;
use crate::film::Window;
#[cfg(test)]
use crate::integrator::FirstHit;
use crate::sampling::NotAdjacent;

/// Pixels along a side of a tile: with 16 samples each, some 4,000 paths. Tiles are the squares of
/// a grid over the frame, cut where the picture is.
pub(crate) const SIDE: u32 = 16;

/// How many lost samples are listed.
const LISTED: usize = 10;

/// A sample that was not finite, and so is no part of its pixel's mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LostSample {
    /// Row of the frame.
    pub y: u32,
    /// Column of the frame.
    pub x: u32,
    /// The sample's number in its pixel.
    pub sample: u64,
}

/// A tile's samples so far.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    /// Its part of the frame.
    pub window: Window,
    /// The first sample of every pixel, and the one that comes next.
    pub range: Range<u64>,
    /// Whether it takes no more samples, for the noise is low enough.
    pub finished: bool,
    /// What it remembers, under a target for the noise.
    pub earlier: Earlier,
    /// Row by row.
    pub(super) pixels: Vec<PixelSums>,
    /// The first few by place.
    pub lost: Vec<LostSample>,
    /// All of them.
    pub lost_count: u64,
}

impl Tile {
    /// A tile without samples; the first to come is number `first`, a multiple of a block.
    pub fn new(window: Window, first: u64) -> Self {
        let pixels = vec![PixelSums::starting_at(first); window.area()];
        let (earlier, lost, lost_count) = (Earlier::default(), Vec::new(), 0);
        Self { window, range: first..first, finished: false, earlier, pixels, lost, lost_count }
    }

    /// Columns and rows of the frame with the sums of each pixel.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, u32, &PixelSums)> {
        places(self.window).zip(&self.pixels).map(|((x, y), sums)| (x, y, sums))
    }

    /// Takes all pixels up to the sample `end`, exclusively.
    pub(super) fn advance(
        &mut self,
        stream: &mut Stream<'_>,
        camera: &CameraRays,
        settings: &Settings,
        end: u64,
    ) {
        let (first, count) = (self.range.end, (end - self.range.end) as u32);
        let window = self.window;
        stream.run(Starts {
            settings,
            camera,
            corner: (window.x0 as u32, window.y0 as u32),
            size: (window.width() as u32, window.height() as u32),
            first,
            count,
            keyed: false,
            timed: false,
        });
        let start = Instant::now();
        for (pixel, (x, y)) in places(window).enumerate() {
            let sums = &mut self.pixels[pixel];
            for sample in 0..count {
                let slot = pixel * count as usize + sample as usize;
                let result = &stream.samples()[slot];
                sums.nanoseconds += f64::from(stream.nanoseconds(slot));
                if !result.radiance.is_finite() {
                    sums.skip();
                    self.lost.push(LostSample { y, x, sample: first + u64::from(sample) });
                    self.lost_count += 1;
                    continue;
                }
                sums.add(result.radiance, result.first.as_ref());
            }
            sums.shrink();
        }
        stream.breakdown().add_since(Stage::Film, start);
        self.lost = first_lost(std::mem::take(&mut self.lost));
        self.range.end = end;
    }

    /// Joins the samples that follow, of the same pixels.
    ///
    /// # Errors
    /// If they do not follow.
    pub fn append(&mut self, later: &Self) -> Result<(), NotAdjacent> {
        for (sums, later) in self.pixels.iter_mut().zip(&later.pixels) {
            sums.append(later)?;
            sums.shrink();
        }
        self.lost.extend_from_slice(&later.lost);
        self.lost = first_lost(std::mem::take(&mut self.lost));
        self.lost_count += later.lost_count;
        self.range.end = later.range.end;
        self.finished = later.finished;
        self.earlier = later.earlier.clone();
        Ok(())
    }

    /// Passes over whole blocks of samples that are not there, up to one that starts at `next`.
    pub fn pass_over(&mut self, next: u64) {
        if next > self.range.end {
            self.pixels.iter_mut().for_each(|sums| sums.pass_over(next));
            self.range.end = next;
        }
    }

    /// A tile of a window from tiles of other rectangles in it. Where there is none, there are no
    /// samples.
    pub fn assemble(window: Window, tiles: Vec<Self>) -> Self {
        let start = tiles.iter().map(|tile| tile.range.start).min().unwrap_or(0);
        let mut whole = Self::new(window, start);
        whole.finished = !tiles.is_empty() && tiles.iter().all(|tile| tile.finished);
        for tile in tiles {
            whole.range.end = whole.range.end.max(tile.range.end);
            whole.lost_count += tile.lost_count;
            whole.lost.extend(tile.lost);
            for ((x, y), sums) in places(tile.window).zip(tile.pixels) {
                let (x, y) = (x as i32 - window.x0, y as i32 - window.y0);
                whole.pixels[y as usize * window.width() + x as usize] = sums;
            }
        }
        whole.lost = first_lost(whole.lost);
        whole
    }

    /// The place of the first pixel whose sums are not those of another tile of the same samples.
    pub fn find_difference(&self, other: &Self) -> Option<(u32, u32)> {
        let mut pairs = self.iter().zip(&other.pixels);
        pairs.find(|((_, _, sums), other)| !sums.has_same_sums(other)).map(|((x, y, _), _)| (x, y))
    }

    /// Words of 64 bits that a pixel's sums take; see [`Self::words`].
    pub fn words_of_pixel(range: Range<u64>) -> usize {
        PixelSums::words(range)
    }

    /// The sums of each pixel as words of 64 bits, of which each has as many.
    pub fn words(&self) -> impl Iterator<Item = impl Iterator<Item = u64> + '_> + '_ {
        self.pixels.iter().map(PixelSums::to_words)
    }

    /// A tile from the words of its pixels; none if no sums have such words.
    pub fn from_words(
        window: Window,
        range: Range<u64>,
        pixels: impl Iterator<Item = impl Iterator<Item = u64>>,
    ) -> Option<Self> {
        let pixels: Option<Vec<_>> =
            pixels.map(|mut words| PixelSums::from_words(range.clone(), &mut words)).collect();
        let pixels = pixels.filter(|pixels| pixels.len() == window.area())?;
        let (earlier, lost, lost_count) = (Earlier::default(), Vec::new(), 0);
        Some(Self { window, range, finished: false, earlier, pixels, lost, lost_count })
    }
}

#[cfg(test)]
impl Tile {
    /// Adds samples that `sample` gives, of a column, a row and a number; none is lost.
    pub fn add_for_test(
        &mut self,
        samples: Range<u64>,
        sample: impl Fn(u32, u32, u64) -> Option<(crate::math::Vec3, Option<FirstHit>)>,
    ) {
        for (pixel, (x, y)) in places(self.window).enumerate() {
            for number in samples.clone() {
                if let Some((radiance, first)) = sample(x, y, number) {
                    self.pixels[pixel].add(radiance, first.as_ref());
                } else {
                    self.pixels[pixel].skip();
                    self.lost.push(LostSample { y, x, sample: number });
                    self.lost_count += 1;
                }
            }
        }
        self.lost = first_lost(std::mem::take(&mut self.lost));
        self.range.end = samples.end;
    }

    /// Takes over a pixel of another tile.
    pub fn set_pixel_for_test(&mut self, at: usize, other: &Self) {
        self.pixels[at] = other.pixels[at].clone();
    }
}

/// The windows of the tiles of a part of the frame, row by row.
pub(crate) fn tile_windows(crop: Window) -> Vec<Window> {
    let side = SIDE as i32;
    let cuts = |first: i32, end: i32| {
        let inner = (first / side + 1..).map(move |cell| cell * side);
        let starts = std::iter::once(first).chain(inner).take_while(move |&start| start < end);
        starts.map(move |start| (start, ((start / side + 1) * side).min(end)))
    };
    cuts(crop.y0, crop.y1)
        .flat_map(|(y0, y1)| cuts(crop.x0, crop.x1).map(move |(x0, x1)| Window { x0, y0, x1, y1 }))
        .collect()
}

/// The pixels of a window, row by row: columns and rows of the frame.
fn places(window: Window) -> impl Iterator<Item = (u32, u32)> {
    let columns = window.x0 as u32..window.x1 as u32;
    (window.y0 as u32..window.y1 as u32).flat_map(move |y| columns.clone().map(move |x| (x, y)))
}

/// The first few of some lost samples, by row, column and sample.
pub(crate) fn first_lost(mut lost: Vec<LostSample>) -> Vec<LostSample> {
    lost.sort_unstable();
    lost.truncate(LISTED);
    lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_a_crop_once_and_lie_in_the_squares_of_the_frame() {
        for crop in [
            Window { x0: 5, y0: 3, x1: 40, y1: 20 },
            Window { x0: 16, y0: 0, x1: 32, y1: 17 },
            Window { x0: 17, y0: 33, x1: 18, y1: 34 },
        ] {
            let mut seen = vec![0; crop.area()];
            for window in tile_windows(crop) {
                assert_eq!(window.x0 / 16, (window.x1 - 1) / 16);
                assert_eq!(window.y0 / 16, (window.y1 - 1) / 16);
                for (x, y) in places(window) {
                    let (x, y) = (x as i32 - crop.x0, y as i32 - crop.y0);
                    seen[y as usize * crop.width() + x as usize] += 1;
                }
            }
            assert!(seen.iter().all(|&times| times == 1), "{crop}");
        }
    }
}
