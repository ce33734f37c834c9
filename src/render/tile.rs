//! A rectangle of pixels and the sums of their samples.

use std::time::Instant;

use super::breakdown::Stage;
use super::settings::Settings;
use super::start::Starts;
use super::stream::Stream;
use crate::camera::CameraRays;
use crate::integrator::FirstHit;
use crate::math::Vec3;
use crate::sampling::BlockSums;

/// Pixels along a side of a tile: with 16 samples each, some 4,000 paths.
pub(super) const SIDE: u32 = 16;

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
#[derive(Debug)]
pub(super) struct Tile {
    x0: u32,
    y0: u32,
    width: u32,
    height: u32,
    /// The sample that every pixel takes next.
    pub next: u64,
    /// Row by row.
    pub pixels: Vec<PixelSums>,
    /// The first few by place.
    pub lost: Vec<LostSample>,
    /// All of them.
    pub lost_count: u64,
}

/// The sums of one pixel.
#[derive(Clone, Debug, Default)]
pub(super) struct PixelSums {
    /// By [`channel`]; those of the first surface add nothing where a camera ray hits none.
    sums: BlockSums<{ channel::COUNT }, 3>,
    nanoseconds: f64,
}

/// The first of each quantity's channels among those that are summed.
mod channel {
    pub const RADIANCE: usize = 0;
    /// One where the camera ray hit something, else zero: its sum counts hits, exactly.
    pub const HIT: usize = 3;
    pub const ALBEDO: usize = 4;
    pub const NORMAL: usize = 7;
    pub const POSITION: usize = 10;
    pub const DISTANCE: usize = 13;
    pub const COUNT: usize = 14;
}

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Means {
    pub radiance: [f64; 3],
    /// Estimated, of the mean.
    pub variance: [f64; 3],
    /// The share of camera rays that hit something.
    pub alpha: f64,
    pub albedo: [f64; 3],
    pub normal: [f64; 3],
    /// This and the distance: over those samples that hit something.
    pub position: [f64; 3],
    pub distance: f64,
    /// Samples in the mean.
    pub count: u64,
    /// Nanoseconds per sample.
    pub cost: f64,
}

impl PixelSums {
    fn add(&mut self, radiance: Vec3, first: Option<&FirstHit>) {
        let mut sample = [0.0; channel::COUNT];
        let mut put =
            |at: usize, value: Vec3| sample[at..at + 3].copy_from_slice(&value.to_array());
        put(channel::RADIANCE, radiance);
        if let Some(hit) = first {
            put(channel::ALBEDO, hit.albedo);
            put(channel::NORMAL, hit.normal);
            put(channel::POSITION, hit.position);
            sample[channel::DISTANCE] = hit.distance;
            sample[channel::HIT] = 1.0;
        }
        self.sums.add(sample);
    }

    /// What the samples so far come to.
    pub fn means(&self) -> Means {
        let (sum, count) = (self.sums.sum(), self.sums.count());
        let (all, hits) = (count.max(1) as f64, sum[channel::HIT].max(1.0));
        let three = |at: usize, by: f64| [sum[at] / by, sum[at + 1] / by, sum[at + 2] / by];
        Means {
            radiance: three(channel::RADIANCE, all),
            variance: self.sums.variance_of_mean(),
            alpha: sum[channel::HIT] / all,
            albedo: three(channel::ALBEDO, all),
            normal: three(channel::NORMAL, all),
            position: three(channel::POSITION, hits),
            distance: sum[channel::DISTANCE] / hits,
            count,
            cost: self.nanoseconds / self.sums.range().end.max(1) as f64,
        }
    }

    /// Bytes that a pixel takes with some number of samples.
    pub const fn bytes(samples: u64) -> u64 {
        let sums = BlockSums::<{ channel::COUNT }, 3>::bytes(samples);
        sums + size_of::<Self>() as u64 - BlockSums::<{ channel::COUNT }, 3>::bytes(0)
    }
}

impl Tile {
    /// The tile whose first pixel is at column `x0`, row `y0` of the frame.
    pub fn new(x0: u32, y0: u32, width: u32, height: u32) -> Self {
        let pixels = vec![PixelSums::default(); (width * height) as usize];
        Self { x0, y0, width, height, next: 0, pixels, lost: Vec::new(), lost_count: 0 }
    }

    /// Columns and rows of the frame with the sums of each pixel.
    pub fn iter(&self) -> impl Iterator<Item = (u32, u32, &PixelSums)> {
        let places = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        places.zip(&self.pixels).map(|((x, y), sums)| (self.x0 + x, self.y0 + y, sums))
    }

    /// Takes all pixels up to the sample `end`, exclusively.
    pub fn advance(
        &mut self,
        stream: &mut Stream<'_>,
        camera: &CameraRays,
        settings: &Settings,
        end: u64,
    ) {
        let (first, count) = (self.next, (end - self.next) as u32);
        let place = |pixel: u32| (self.x0 + pixel % self.width, self.y0 + pixel / self.width);
        stream.run(Starts {
            settings,
            camera,
            corner: (self.x0, self.y0),
            size: (self.width, self.height),
            first,
            count,
            keyed: false,
        });
        let start = Instant::now();
        for pixel in 0..self.width * self.height {
            let (x, y) = place(pixel);
            let sums = &mut self.pixels[pixel as usize];
            for sample in 0..count {
                let slot = (pixel * count + sample) as usize;
                let result = &stream.samples()[slot];
                sums.nanoseconds += f64::from(stream.nanoseconds(slot));
                if !result.radiance.is_finite() {
                    sums.sums.skip();
                    self.lost.push(LostSample { y, x, sample: first + u64::from(sample) });
                    self.lost_count += 1;
                    continue;
                }
                sums.add(result.radiance, result.first.as_ref());
            }
            sums.sums.shrink(); // there are millions of them
        }
        stream.breakdown().add_since(Stage::Film, start);
        self.lost.sort_unstable();
        self.lost.truncate(LISTED);
        self.next = end;
    }
}

/// The first few of the lost samples of all tiles.
pub(super) fn find_first_lost<'a>(tiles: impl Iterator<Item = &'a Tile>) -> Vec<LostSample> {
    let mut lost: Vec<LostSample> = tiles.flat_map(|tile| tile.lost.iter().copied()).collect();
    lost.sort_unstable();
    lost.truncate(LISTED);
    lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_of_the_first_surface_are_exact_over_many_samples() {
        // Two positions 2^24 apart a million times: running f32 sums would lose their last bits,
        // and a f32 count would end at 2^24.
        let hit = |x: f32| FirstHit {
            albedo: Vec3::splat(0.1),
            normal: Vec3::Y,
            position: Vec3::new(x, 0.0, 0.0),
            distance: x,
            goes_on: false,
        };
        let mut sums = PixelSums::default();
        assert_eq!((sums.means().count, sums.means().position), (0, [0.0; 3]));
        for _ in 0..500_000 {
            sums.add(Vec3::ONE, Some(&hit(1.0)));
            sums.add(Vec3::ONE, Some(&hit(16_777_215.0)));
            sums.add(Vec3::ZERO, None);
        }
        let means = sums.means();
        assert_eq!((means.position[0], means.distance), (8_388_608.0, 8_388_608.0));
        assert_eq!((means.normal[1], means.alpha), (2.0 / 3.0, 2.0 / 3.0));
        assert!((means.albedo[0] - f64::from(0.1_f32) * 2.0 / 3.0).abs() < 1e-12);
        assert_eq!((means.count, means.radiance), (1_500_000, [2.0 / 3.0; 3]));
    }
}
