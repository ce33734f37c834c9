//! A whole picture: tiles on threads, pass after pass.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::aov::assemble_picture;
use super::breakdown::Breakdown;
use super::settings::Settings;
use super::stream::{RayCounts, Stream};
use super::tile::{LostSample, SIDE, Tile, find_first_lost};
use crate::accel::Accel;
use crate::camera::Camera;
use crate::film::{Picture, Window};
use crate::integrator::PathTracer;
use crate::sampling::BLOCK;
use crate::world::World;

/// How a render talks to its caller while it runs.
pub struct Control<'a> {
    /// Once true, tiles under way finish their block of samples, and the picture is made of what
    /// there is.
    pub cancel: &'a AtomicBool,
    /// Called from a thread of its own, some ten times a second and once at the end.
    pub progress: &'a (dyn Fn(Progress) + Sync),
}

impl Default for Control<'static> {
    /// Reports nothing and never cancels.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { cancel: &NEVER, progress: &|_| {} }
    }
}

/// The progress of a render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples taken, over all pixels.
    pub done: u64,
    /// Samples wanted.
    pub total: u64,
    /// Time since it began.
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
    /// Where the time went, over all threads.
    pub breakdown: Breakdown,
    /// Paths that were followed.
    pub paths: u64,
    /// Time that rendering took, without loading and building.
    pub elapsed: Duration,
    /// The fewest and the most samples a pixel has, lost ones included.
    pub samples: (u64, u64),
    /// Pixels without any sample, which are black.
    pub without_samples: u64,
    /// Whether it was cancelled before all samples were taken.
    pub cancelled: bool,
    /// The number of samples that were not finite.
    pub lost_count: u64,
    /// The first ten of them, by row, column and sample.
    pub lost: Vec<LostSample>,
}

/// Renders a picture, on the threads of the current rayon pool.
///
/// The result is a function of the world, the camera and the settings: neither `accel` nor the
/// number of threads changes a bit of it, except for the layer `cost`. All pixels take 16 samples,
/// then all of them 16 more, then 32, 64 and so on, so that a cancelled picture is complete, only
/// noisier.
///
/// # Examples
/// ```
/// use dapple::{AccelSpec, BsdfForm, Control, Isa, Scene, Settings, World};
///
/// // An empty scene under the neutral sky: alpha is 1, and all that the camera sees is the sky.
/// let mut scene = Scene::default();
/// scene.add_defaults(1.0);
/// let camera = scene.cameras[0].camera;
/// let world = World::new(scene, BsdfForm::default())?;
/// let accel = dapple::build(&AccelSpec::default(), world.triangles.clone(), Isa::Auto)?;
/// let settings = Settings { spp: 1, ..Settings::new(4, 4) };
/// let rendered = dapple::render(&world, &camera, &*accel, &settings, &Control::default());
/// assert_eq!(rendered.picture.channel("A"), Some(&[1.0; 16][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn render(
    world: &World,
    camera: &Camera,
    accel: &dyn Accel,
    settings: &Settings,
    control: &Control<'_>,
) -> Rendered {
    let mut film = FilmAccumulator::new(settings);
    film.accumulate(world, camera, accel, settings.spp, control);
    film.finish()
}

/// Adds up the samples of a picture. The scene may be posed anew from one part of them to the next.
pub struct FilmAccumulator<'a> {
    settings: &'a Settings,
    tiles: Vec<Mutex<Tile>>,
    /// When the first sample was taken.
    start: Option<Instant>,
    /// Paths followed.
    done: AtomicU64,
    rays: RayCounts,
    breakdown: Breakdown,
    elapsed: Duration,
}

impl<'a> FilmAccumulator<'a> {
    /// A film without samples.
    pub fn new(settings: &'a Settings) -> Self {
        Self {
            settings,
            tiles: split_into_tiles(settings.crop).into_iter().map(Mutex::new).collect(),
            start: None,
            done: AtomicU64::new(0),
            rays: RayCounts::default(),
            breakdown: Breakdown::default(),
            elapsed: Duration::ZERO,
        }
    }

    /// Takes the samples of every pixel up to `end`, exclusively, on the threads of the current
    /// rayon pool; see [`render`].
    pub fn accumulate(
        &mut self,
        world: &World,
        camera: &Camera,
        accel: &dyn Accel,
        end: u64,
        control: &Control<'_>,
    ) {
        let start = Instant::now();
        let (settings, tiles, done) = (self.settings, &self.tiles, &self.done);
        let first = tiles.first().map_or(end, |tile| lock(tile).next);
        let passes = pass_ends(first, end);
        let camera = camera.rays(settings.aspect());
        let region = camera.region();
        let next_job = AtomicUsize::new(0);
        let counted = Mutex::new((RayCounts::default(), Breakdown::default()));

        let work = || {
            let integrator = PathTracer::new(world, settings.transport);
            let mut stream = Stream::new(integrator, accel, region.as_ref());
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
            let (rays, breakdown) = &mut *lock(&counted);
            *rays += stream.counts();
            *breakdown += *stream.breakdown();
        };
        let total = settings.crop.area() as u64 * settings.spp;
        let since = *self.start.get_or_insert(start);
        let progress =
            || Progress { done: done.load(Ordering::Relaxed), total, elapsed: since.elapsed() };
        with_ticks(&|| (control.progress)(progress()), || {
            if !tiles.is_empty() {
                rayon::broadcast(|_| work());
            }
        });
        let (rays, breakdown) = counted.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.rays += rays;
        self.breakdown += breakdown;
        self.elapsed += start.elapsed();
    }

    /// Makes the picture of the samples so far.
    pub fn finish(self) -> Rendered {
        let tiles: Vec<Tile> = self
            .tiles
            .into_iter()
            .map(|tile| tile.into_inner().unwrap_or_else(PoisonError::into_inner))
            .collect();
        let fewest = tiles.iter().map(|tile| tile.next).min().unwrap_or(0);
        Rendered {
            picture: assemble_picture(&tiles, self.settings),
            rays: self.rays,
            breakdown: self.breakdown,
            paths: self.done.into_inner(),
            elapsed: self.elapsed,
            samples: (fewest, tiles.iter().map(|tile| tile.next).max().unwrap_or(0)),
            without_samples: tiles
                .iter()
                .filter(|tile| tile.next == 0)
                .map(|tile| tile.pixels.len() as u64)
                .sum(),
            cancelled: fewest < self.settings.spp,
            lost_count: tiles.iter().map(|tile| tile.lost_count).sum(),
            lost: find_first_lost(tiles.iter()),
        }
    }
}

/// A panic elsewhere ends the render anyway; it need not be reported twice.
fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Splits a window into tiles, row by row.
fn split_into_tiles(crop: Window) -> Vec<Tile> {
    let (x0, y0, x1, y1) = (crop.x0 as u32, crop.y0 as u32, crop.x1 as u32, crop.y1 as u32);
    let rows = (y0..y1).step_by(SIDE as usize);
    rows.flat_map(|y| (x0..x1).step_by(SIDE as usize).map(move |x| (x, y)))
        .map(|(x, y)| Tile::new(x, y, SIDE.min(x1 - x), SIDE.min(y1 - y)))
        .collect()
}

/// The sample at which each pass ends: doubling, so that the sums of a pixel are few nodes.
fn pass_ends(first: u64, end: u64) -> Vec<u64> {
    let doubling = std::iter::successors(Some(BLOCK), |end| Some(end * 2));
    let within = doubling.skip_while(|&pass| pass <= first).take_while(|&pass| pass < end);
    within.chain([end]).collect()
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::accel::build;
    use crate::geom::{Triangle, TriangleList, TriangleSource};
    use crate::math::Vec3;
    use crate::simd::Isa;

    #[test]
    fn passes_double_and_end_at_the_last_sample() {
        assert_eq!(pass_ends(0, 1), [1]);
        assert_eq!(pass_ends(0, 16), [16]);
        assert_eq!(pass_ends(0, 100), [16, 32, 64, 100]);
        assert_eq!(pass_ends(16, 100), [32, 64, 100]);
        assert_eq!(pass_ends(20, 24), [24]);
    }

    #[test]
    fn structures_that_gain_by_it_are_narrowed_to_what_the_camera_sees() {
        let a = Vec3::new(0.0, 0.0, -5.0);
        let triangle = Triangle { a, b: a + Vec3::X, c: a + Vec3::Y };
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(vec![triangle; 9]));
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.8);
        let narrows = |id: &str, camera: Camera| {
            let spec = id.parse().expect("known");
            let accel = build(&spec, Arc::clone(&source), Isa::Auto).expect("it builds");
            camera.rays(1.0).region().is_some() && accel.tracer().regions().is_some()
        };
        assert!(narrows("bvh-path-compression", camera) && narrows("kd-entry-point", camera));
        assert!(!narrows("bvh2", camera));
        assert!(!narrows("bvh-path-compression", camera.with_panorama()));
    }

    #[test]
    fn tiles_cover_a_crop_once() {
        let crop = Window { x0: 5, y0: 3, x1: 40, y1: 20 };
        let mut seen = vec![0; crop.area()];
        for tile in split_into_tiles(crop) {
            for (x, y, _) in tile.iter() {
                seen[(y as usize - 3) * crop.width() + x as usize - 5] += 1;
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
    }
}
