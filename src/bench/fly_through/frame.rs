//! A picture of a flight: its rays, tile by tile, and how they are handed over.

use std::ops::Range;
use std::time::Instant;

use crate::accel::{Accel, Batch, ClosestHit, Counts, PoolUse, Tracer};
use crate::bench::measure::Answers;
use crate::camera::flight::Pose;
use crate::geom::Shaft;
use crate::math::{Ray, Vec2};

/// The rays of a picture through the middles of its pixels, in the order of its tiles.
pub struct Frame {
    /// Tile by tile, each row by row.
    pub rays: Vec<Ray>,
    tiles: Vec<Tile>,
    /// The region that the camera sees.
    screen: Option<Shaft>,
}

/// A rectangle of pixels.
struct Tile {
    rays: Range<usize>,
    width: u32,
    height: u32,
}

/// What one pass has done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Counted events.
    pub counts: Counts,
    /// Of the pool.
    pub pool: PoolUse,
}

impl Frame {
    /// The picture that a camera takes, of so many pixels, in `across` by `across` tiles at most.
    pub fn new(pose: &Pose, resolution: (u32, u32), across: u32) -> Self {
        let (width, height) = resolution;
        let camera = pose.camera().rays(width as f32 / height as f32);
        let film = |x: f32, y: f32| Vec2::new(x / width as f32, y / height as f32);
        let mut rays = Vec::with_capacity(width as usize * height as usize);
        let mut tiles = Vec::new();
        for rows in parts(height, across) {
            for columns in parts(width, across) {
                let first = rays.len();
                for y in rows.clone() {
                    let middle = |x: u32| film(x as f32 + 0.5, y as f32 + 0.5);
                    rays.extend(columns.clone().map(|x| camera.ray(middle(x), Vec2::ZERO)));
                }
                let (width, height) = (columns.len() as u32, rows.len() as u32);
                tiles.push(Tile { rays: first..rays.len(), width, height });
            }
        }
        Self { rays, tiles, screen: camera.region() }
    }

    /// Where each tile's rays are, and its width in pixels.
    pub fn tiles(&self) -> impl Iterator<Item = (Range<usize>, u32)> {
        self.tiles.iter().map(|tile| (tile.rays.clone(), tile.width))
    }

    fn slices(&self) -> impl Iterator<Item = (Range<usize>, Batch<'_>)> {
        self.tiles.iter().map(|tile| {
            let batch = Batch::new(&self.rays[tile.rays.clone()]);
            (tile.rays.clone(), batch.with_grid(tile.width, tile.height))
        })
    }

    /// Within the screen's region, a slice a tile.
    fn shoot(&self, tracer: &mut dyn Tracer, hits: &mut [ClosestHit]) {
        in_region(tracer, self.screen.as_ref(), |tracer| {
            for (at, batch) in self.slices() {
                tracer.closest_hits(&batch, &mut hits[at]);
            }
        });
    }

    fn allocate_answers(&self) -> Vec<ClosestHit> {
        vec![ClosestHit::MISS; self.rays.len()]
    }

    /// The nearest hits.
    pub fn trace_hits(&self, accel: &dyn Accel) -> Vec<ClosestHit> {
        let mut hits = self.allocate_answers();
        self.shoot(&mut *accel.tracer(), &mut hits);
        hits
    }

    /// The same, to be compared.
    pub fn trace(&self, accel: &dyn Accel) -> Answers {
        Answers::Closest(self.trace_hits(accel))
    }

    /// Seconds for a pass, on this thread.
    pub fn time(&self, tracer: &mut dyn Tracer) -> f64 {
        let mut hits = self.allocate_answers();
        let start = Instant::now();
        self.shoot(tracer, &mut hits);
        start.elapsed().as_secs_f64()
    }

    /// The work of a pass.
    pub fn count_work(&self, accel: &dyn Accel) -> Work {
        let mut tracer = accel.counting_tracer();
        self.shoot(&mut *tracer, &mut self.allocate_answers());
        Work { counts: tracer.counts(), pool: take_pool_use(&mut *tracer) }
    }

    /// Seconds in which the regions of the screen and of all tiles are entered, and left again.
    pub fn time_entering(&self, tracer: &mut dyn Tracer) -> f64 {
        let simd = crate::simd::baseline();
        let shafts: Vec<_> = (self.tiles.iter())
            .map(|tile| Shaft::of_rays(simd, &self.rays[tile.rays.clone()], tile.width as usize))
            .collect();
        let start = Instant::now();
        let Some(mut regions) = tracer.regions() else { return 0.0 };
        if let Some(screen) = &self.screen {
            regions.enter(screen);
        }
        for shaft in shafts.iter().flatten() {
            regions.enter(shaft);
            regions.leave();
        }
        if self.screen.is_some() {
            regions.leave();
        }
        start.elapsed().as_secs_f64()
    }
}

/// Runs something while a tracer is narrowed to a region, if there is one and it gains by that.
pub fn in_region(
    tracer: &mut dyn Tracer,
    region: Option<&Shaft>,
    run: impl FnOnce(&mut dyn Tracer),
) {
    let Some(region) = region else { return run(tracer) };
    if let Some(mut regions) = tracer.regions() {
        regions.enter(region);
    }
    run(tracer);
    if let Some(mut regions) = tracer.regions() {
        regions.leave();
    }
}

/// The memory of what a tracer has derived for regions.
pub fn take_pool_use(tracer: &mut dyn Tracer) -> PoolUse {
    tracer.regions().map_or_else(PoolUse::default, |mut regions| regions.take_pool_use())
}

/// Pixels along a side, in as many equal parts.
fn parts(size: u32, across: u32) -> impl Iterator<Item = Range<u32>> + Clone {
    let side = size.div_ceil(across.max(1)).max(1);
    (0..size.div_ceil(side)).map(move |i| i * side..((i + 1) * side).min(size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn tiles_have_each_pixel_once_and_the_screen_holds_them() {
        let pose = Pose::new(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, 50.0);
        for (resolution, across, tiles) in [((64, 64), 8, 64), ((37, 21), 8, 56), ((3, 2), 8, 6)] {
            let frame = Frame::new(&pose, resolution, across);
            assert_eq!(frame.tiles.len(), tiles);
            let pixels: u32 = frame.tiles.iter().map(|tile| tile.width * tile.height).sum();
            assert_eq!((pixels, frame.rays.len()), (resolution.0 * resolution.1, pixels as usize));
            let screen = frame.screen.as_ref().expect("a pyramid");
            assert!(frame.rays.iter().all(|ray| screen.holds(ray)));
            // Of tiles within, without asking each ray; one at the screen's edge is a rectangle in
            // its own frame, and may reach beyond in the screen's.
            let mut known = 0;
            for (at, width) in frame.tiles() {
                let simd = crate::simd::baseline();
                let tile = Shaft::of_rays(simd, &frame.rays[at], width as usize);
                known += usize::from(tile.is_some_and(|tile| screen.contains(&tile)));
            }
            assert!(2 * known >= tiles, "{known} of {tiles}");
            let mut directions: Vec<_> =
                frame.rays.iter().map(|ray| ray.direction().to_array().map(f32::to_bits)).collect();
            directions.sort_unstable();
            directions.dedup();
            assert_eq!(directions.len(), frame.rays.len());
        }
    }
}
