//! A rectangle of pixels and the sums of their samples.

use super::settings::Settings;
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
    /// Which of the pixel's samples.
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
    /// Radiance and the share of camera rays that hit something.
    pub radiance: BlockSums<4>,
    pub first: FirstSums,
    pub nanoseconds: f64,
}

/// Sums over those samples whose camera ray hit something.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FirstSums {
    pub albedo: Vec3,
    pub normal: Vec3,
    pub position: Vec3,
    pub distance: f32,
    pub count: f32,
}

impl FirstSums {
    fn add(&mut self, hit: &FirstHit) {
        self.albedo += hit.albedo;
        self.normal += hit.normal;
        self.position += hit.position;
        self.distance += hit.distance;
        self.count += 1.0;
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
        let slots = 0..self.width * self.height * count;
        stream.run(slots.map(|slot| {
            let (x, y) = place(slot / count);
            settings.start(camera, x, y, first + u64::from(slot % count), slot)
        }));
        for pixel in 0..self.width * self.height {
            let (x, y) = place(pixel);
            let sums = &mut self.pixels[pixel as usize];
            for sample in 0..count {
                let slot = (pixel * count + sample) as usize;
                let result = &stream.samples()[slot];
                sums.nanoseconds += f64::from(stream.nanoseconds(slot));
                if !result.radiance.is_finite() {
                    sums.radiance.skip();
                    self.lost.push(LostSample { y, x, sample: first + u64::from(sample) });
                    self.lost_count += 1;
                    continue;
                }
                let [r, g, b] = result.radiance.to_array();
                sums.radiance.add([r, g, b, f32::from(result.first.is_some())]);
                if let Some(hit) = &result.first {
                    sums.first.add(hit);
                }
            }
            sums.radiance.shrink(); // there are millions of them
        }
        self.lost.sort_unstable();
        self.lost.truncate(LISTED);
        self.next = end;
    }
}

/// The first few of the lost samples of all tiles.
pub(super) fn first_lost<'a>(tiles: impl Iterator<Item = &'a Tile>) -> Vec<LostSample> {
    let mut lost: Vec<LostSample> = tiles.flat_map(|tile| tile.lost.iter().copied()).collect();
    lost.sort_unstable();
    lost.truncate(LISTED);
    lost
}
