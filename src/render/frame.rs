//! A whole picture: tiles on threads, pass after pass.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::settings::{Aov, Settings};
use super::stream::{RayCounts, Stream};
use super::tile::{LostSample, PixelSums, SIDE, Tile, first_lost};
use crate::accel::Accel;
use crate::camera::Camera;
use crate::film::{Picture, Window};
use crate::integrator::PathTracer;
use crate::sampling::BLOCK;
use crate::scene::World;

/// How a render talks to its caller while it runs.
pub struct Control<'a> {
    /// Once true, the tiles under way are finished to the end of their block of samples, and what
    /// there is is the picture.
    pub cancel: &'a AtomicBool,
    /// Called from a thread of its own, some ten times a second and once at the end.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples taken, over all pixels.
    pub done: u64,
    /// Samples wanted.
    pub total: u64,
    /// Since it began.
    pub elapsed: Duration,
}

impl Progress {
    /// The time that it will still take at the pace so far; `None` at the start.
    pub fn left(&self) -> Option<Duration> {
        let share = self.done as f64 / self.total.max(1) as f64;
        (share > 0.0).then(|| self.elapsed.mul_f64(((1.0 - share) / share).max(0.0)))
    }
}

/// A picture and how it came about.
#[derive(Debug)]
pub struct Rendered {
    /// The layers: `R G B A`, and those of [`Settings::aovs`].
    pub picture: Picture,
    /// Rays that were shot.
    pub rays: RayCounts,
    /// Paths that were followed.
    pub paths: u64,
    /// Time for all but the preparations.
    pub elapsed: Duration,
    /// The fewest and the most samples a pixel has, lost ones included.
    pub samples: (u64, u64),
    /// Whether it was cancelled before all samples were taken.
    pub cancelled: bool,
    /// Samples that were not finite: how many.
    pub lost_count: u64,
    /// The first ten of them, by row, column and sample.
    pub lost: Vec<LostSample>,
}

/// Renders a picture, on the threads of the current rayon pool.
///
/// The result is a function of the world, the camera and the settings: neither `accel` nor the
/// number of threads changes a bit of it, but for the layer `cost`. All pixels take 16 samples, then
/// all of them 16 more, then 32, 64 and so on, so that a cancelled picture is whole, if noisier.
pub fn render(
    world: &World,
    camera: &Camera,
    accel: &dyn Accel,
    settings: &Settings,
    control: &Control<'_>,
) -> Rendered {
    let start = Instant::now();
    let tiles: Vec<Mutex<Tile>> = cut(settings.crop).into_iter().map(Mutex::new).collect();
    let passes = passes(settings.spp);
    let camera = camera.rays(settings.aspect());
    let total = settings.crop.area() as u64 * settings.spp;
    let (next_job, done) = (AtomicUsize::new(0), AtomicU64::new(0));
    let rays = Mutex::new(RayCounts::default());

    let work = || {
        let integrator = PathTracer::new(world, settings.transport);
        let mut stream = Stream::new(integrator, accel);
        loop {
            let job = next_job.fetch_add(1, Ordering::Relaxed);
            let Some(&end) = passes.get(job / tiles.len()) else { break };
            let mut tile = lock(&tiles[job % tiles.len()]);
            while tile.next < end && !control.cancel.load(Ordering::Relaxed) {
                let block_end = (tile.next + BLOCK).min(end);
                let samples = (block_end - tile.next) * tile.pixels.len() as u64;
                tile.advance(&mut stream, &camera, settings, block_end);
                done.fetch_add(samples, Ordering::Relaxed);
            }
        }
        *lock(&rays) += stream.counts();
    };
    let progress =
        || Progress { done: done.load(Ordering::Relaxed), total, elapsed: start.elapsed() };
    with_ticks(&|| (control.progress)(progress()), || {
        if !tiles.is_empty() {
            rayon::broadcast(|_| work());
        }
    });

    let elapsed = start.elapsed();
    let tiles: Vec<Tile> = tiles
        .into_iter()
        .map(|tile| tile.into_inner().unwrap_or_else(PoisonError::into_inner))
        .collect();
    let fewest = tiles.iter().map(|tile| tile.next).min().unwrap_or(0);
    Rendered {
        picture: picture(&tiles, settings),
        rays: rays.into_inner().unwrap_or_else(PoisonError::into_inner),
        paths: done.into_inner(),
        elapsed,
        samples: (fewest, tiles.iter().map(|tile| tile.next).max().unwrap_or(0)),
        cancelled: fewest < settings.spp,
        lost_count: tiles.iter().map(|tile| tile.lost_count).sum(),
        lost: first_lost(tiles.iter()),
    }
}

/// A panic elsewhere ends the render anyway; it need not be reported twice.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The tiles of a window, row by row.
fn cut(crop: Window) -> Vec<Tile> {
    let (x0, y0, x1, y1) = (crop.x0 as u32, crop.y0 as u32, crop.x1 as u32, crop.y1 as u32);
    let rows = (y0..y1).step_by(SIDE as usize);
    rows.flat_map(|y| (x0..x1).step_by(SIDE as usize).map(move |x| (x, y)))
        .map(|(x, y)| Tile::new(x, y, SIDE.min(x1 - x), SIDE.min(y1 - y)))
        .collect()
}

/// The sample at which each pass ends: doubling, so that the sums of a pixel are few nodes.
fn passes(spp: u64) -> Vec<u64> {
    let mut ends = Vec::new();
    let mut end = BLOCK;
    while end < spp {
        ends.push(end);
        end *= 2;
    }
    ends.push(spp);
    ends
}

/// Runs `work` while another thread calls `tick` ten times a second, and once more at the end.
fn with_ticks(tick: &(dyn Fn() + Sync), work: impl FnOnce() + Send) {
    let (finished, wake) = (Mutex::new(false), Condvar::new());
    /// Says that the work is over, also when it panicked.
    struct Finish<'a>(&'a Mutex<bool>, &'a Condvar);
    impl Drop for Finish<'_> {
        fn drop(&mut self) {
            *lock(self.0) = true;
            self.1.notify_all();
        }
    }
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut over = lock(&finished);
            while !*over {
                let waited = wake.wait_timeout(over, Duration::from_millis(100));
                over = waited.unwrap_or_else(PoisonError::into_inner).0;
                tick();
            }
        });
        let _finish = Finish(&finished, &wake);
        work();
    });
}

/// The layers of what has been sampled.
fn picture(tiles: &[Tile], settings: &Settings) -> Picture {
    let frame = Window::of_size(settings.resolution.0 as usize, settings.resolution.1 as usize);
    let crop = settings.crop;
    let mut picture = Picture::new(frame, crop);
    let scalar = |of: &dyn Fn(&PixelSums) -> f32| {
        let mut values = vec![0.0; crop.area()];
        for (x, y, sums) in tiles.iter().flat_map(Tile::iter) {
            values[(y - crop.y0 as u32) as usize * crop.width() + (x - crop.x0 as u32) as usize] =
                of(sums);
        }
        values
    };
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        picture.set_channel(name, scalar(&|sums| sums.radiance.mean()[channel] as f32));
    }
    let transparent = settings.transport.transparent;
    let alpha = |sums: &PixelSums| if transparent { sums.radiance.mean()[3] as f32 } else { 1.0 };
    picture.set_channel("A", scalar(&alpha));
    for &aov in &settings.aovs {
        let name = |channel: &str| format!("{}.{channel}", aov.id());
        for axis in 0..3 {
            let (colour, space) = (["R", "G", "B"][axis], ["X", "Y", "Z"][axis]);
            match aov {
                Aov::Albedo => picture.set_channel(
                    name(colour),
                    scalar(&|sums| sums.first.albedo[axis] / sums.radiance.count().max(1) as f32),
                ),
                Aov::Normal => picture.set_channel(
                    name(space),
                    scalar(&|sums| sums.first.normal[axis] / sums.radiance.count().max(1) as f32),
                ),
                Aov::Position => picture.set_channel(
                    name(space),
                    scalar(&|sums| sums.first.position[axis] / sums.first.count.max(1.0)),
                ),
                Aov::Variance => picture.set_channel(
                    name(colour),
                    scalar(&|sums| sums.radiance.variance_of_mean()[axis] as f32),
                ),
                Aov::Depth | Aov::Samples | Aov::Cost => {}
            }
        }
        match aov {
            Aov::Depth => picture.set_channel(
                name("Z"),
                scalar(&|sums| sums.first.distance / sums.first.count.max(1.0)),
            ),
            Aov::Samples => {
                picture.set_channel(name("Y"), scalar(&|sums| sums.radiance.count() as f32));
            }
            Aov::Cost => picture.set_channel(
                name("Y"),
                scalar(&|sums| (sums.nanoseconds / sums.radiance.range().end.max(1) as f64) as f32),
            ),
            _ => {}
        }
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_double_and_end_at_the_last_sample() {
        assert_eq!(passes(1), [1]);
        assert_eq!(passes(16), [16]);
        assert_eq!(passes(100), [16, 32, 64, 100]);
    }

    #[test]
    fn tiles_cover_a_crop_once() {
        let crop = Window { x0: 5, y0: 3, x1: 40, y1: 20 };
        let mut seen = vec![0; crop.area()];
        for tile in cut(crop) {
            for (x, y, _) in tile.iter() {
                seen[(y as usize - 3) * crop.width() + x as usize - 5] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
    }
}
