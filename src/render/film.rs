//! The film: the tiles of a picture, and the samples that they take.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, RwLock};
use std::time::{Duration, Instant};

use super::aov::assemble_picture;
use super::breakdown::Breakdown;
use super::fair_mutex::FairMutex;
use super::noise::{Grid, dark_level, tell_error};
use super::noise_target::NoiseTarget;
use super::passes::{Growth, pass_ends, spread};
use super::preview::assemble_preview;
use super::progress::Progress;
use super::rendered::Rendered;
use super::settings::Settings;
use super::stream::{RayCounts, Stream};
use super::tile::{Tile, first_lost, tile_windows};
use crate::accel::Accel;
use crate::camera::CameraRays;
use crate::camera::moving::MovingCamera;
use crate::film::Picture;
use crate::integrator::PathTracer;
use crate::sampling::BLOCK;
use crate::world::World;

/// Adds up the samples of a picture, or some of them. The scene may be posed anew from one part of
/// them to the next. While samples are taken, what there is can be looked at and saved.
pub struct Film {
    settings: Settings,
    range: Range<u64>,
    tiles: Vec<FairMutex<Tile>>,
    /// The order in which tiles are taken.
    order: Vec<usize>,
    /// Held while tiles are told to stop, so that no one sees some that were and some that were
    /// not.
    decision: RwLock<()>,
    /// When the first sample was taken.
    start: OnceLock<Instant>,
    /// When the samples that are being taken were begun.
    running: Mutex<Option<Instant>>,
    /// Samples that were there at the start, those taken since, and all that are wanted; and the
    /// time that the first took.
    restored: u64,
    restored_time: Duration,
    taken: AtomicU64,
    wanted: AtomicU64,
    counted: Mutex<Counted>,
}

/// What workers count.
#[derive(Clone, Copy, Default)]
struct Counted {
    rays: RayCounts,
    breakdown: Breakdown,
    elapsed: Duration,
}

impl Film {
    /// A film without samples, which is to take all that the settings ask for.
    pub fn new(settings: Settings) -> Self {
        let all = 0..settings.spp;
        Self::of_samples(settings, all)
    }

    /// A film that is to take the samples of a range of each pixel. The first is a multiple of
    /// [`BLOCK`].
    pub fn of_samples(settings: Settings, range: Range<u64>) -> Self {
        let windows = tile_windows(settings.crop);
        let order = spread(windows.iter().copied());
        let new = |window| FairMutex::new(Tile::new(window, range.start));
        let wanted = settings.crop.area() as u64 * (range.end - range.start);
        Self {
            tiles: windows.into_iter().map(new).collect(),
            order,
            decision: RwLock::new(()),
            start: OnceLock::new(),
            running: Mutex::default(),
            restored: 0,
            restored_time: Duration::ZERO,
            taken: AtomicU64::new(0),
            wanted: AtomicU64::new(wanted),
            counted: Mutex::default(),
            settings,
            range,
        }
    }

    /// Takes over the samples of a film of the same settings that was saved, and the time that they
    /// took. The tiles are those of the crop, in their order.
    pub(crate) fn restore(&mut self, tiles: Vec<Tile>, elapsed: Duration) {
        let samples = |tile: &Tile| (tile.range.end - tile.range.start) * tile.window.area() as u64;
        self.restored = tiles.iter().map(samples).sum();
        self.tiles = tiles.into_iter().map(FairMutex::new).collect();
        self.restored_time = elapsed;
    }

    /// The samples that it is to take.
    pub fn range(&self) -> Range<u64> {
        self.range.clone()
    }

    /// What it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The sample that comes next in the tile that has the fewest and still takes some; the end of
    /// the range if there is none.
    pub fn next_sample(&self) -> u64 {
        let open = self.tiles.iter().map(FairMutex::lock).filter(|tile| !tile.finished);
        open.map(|tile| tile.range.end).min().unwrap_or(self.range.end)
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        Progress {
            before: self.restored,
            done: self.restored + self.taken.load(Ordering::Relaxed),
            total: self.wanted.load(Ordering::Relaxed),
            elapsed: self.start.get().map_or(Duration::ZERO, Instant::elapsed),
        }
    }

    /// Calls `each` with what `look` makes of every tile, in their order, while others may go on.
    /// A tile is locked while it is looked at.
    ///
    /// # Errors
    /// The first of `each`.
    pub(crate) fn try_for_each_tile<T, E>(
        &self,
        look: impl Fn(&Tile) -> T,
        mut each: impl FnMut(T) -> Result<(), E>,
    ) -> Result<(), E> {
        let _none_stops = self.decision.read().unwrap_or_else(PoisonError::into_inner);
        self.tiles.iter().try_for_each(|tile| {
            let seen = look(&tile.lock());
            each(seen)
        })
    }

    /// The time that rendering took so far, that of the film that was restored included.
    pub fn elapsed(&self) -> Duration {
        let running = lock(&self.running).map_or(Duration::ZERO, |start| start.elapsed());
        self.restored_time + lock(&self.counted).elapsed + running
    }

    /// Rays that were shot, as far as workers have told: they do at the end of their passes.
    pub fn rays(&self) -> RayCounts {
        lock(&self.counted).rays
    }

    /// The colours of the samples so far, to look at: tiles without any are filled with what is
    /// nearest.
    pub fn preview(&self) -> Picture {
        assemble_preview(self.tiles.iter().map(FairMutex::lock), &self.settings)
    }

    /// Takes the samples of every pixel up to `end`, exclusively, on the threads of the current
    /// rayon pool; see [`super::render`]. With a target for the noise, tiles stop once it is
    /// reached. Once `cancel` is true, tiles under way finish their block of samples.
    pub fn accumulate(
        &self,
        world: &World,
        camera: &MovingCamera,
        accel: &dyn Accel,
        end: u64,
        cancel: &AtomicBool,
    ) {
        self.start.get_or_init(Instant::now);
        *lock(&self.running) = Some(Instant::now());
        let pixels = self.settings.crop.area() as u64;
        let in_tiles = world.scene.textures.iter().any(|texture| texture.image().is_tiled());
        // The noise is looked at wherever samples have doubled.
        let is_fast = in_tiles && self.settings.noise.is_none();
        let growth = if is_fast { Growth::Fast } else { Growth::Usual };
        let passes = pass_ends(self.range.start..end, self.next_sample(), pixels, growth);
        let shoot = Shoot { film: self, world, camera, accel, cancel };
        match self.settings.noise {
            None => shoot.take(&passes),
            Some(target) => self.take_until_low(target, &passes, &shoot),
        }
        let running = lock(&self.running).take();
        lock(&self.counted).elapsed += running.map_or(Duration::ZERO, |start| start.elapsed());
    }

    /// Takes passes until the noise is low.
    fn take_until_low(&self, target: NoiseTarget, passes: &[u64], shoot: &Shoot<'_>) {
        let mut low = self.stop_where_low(target);
        for &pass in passes {
            if low || shoot.is_cancelled() {
                break;
            }
            shoot.take(&[pass]);
            low = self.stop_where_low(target);
        }
    }

    /// At a doubling of the samples: tells the tiles to stop whose noise is low enough. Returns
    /// whether none goes on.
    fn stop_where_low(&self, target: NoiseTarget) -> bool {
        let _no_one_looks = self.decision.write().unwrap_or_else(PoisonError::into_inner);
        let mut tiles: Vec<_> = self.tiles.iter().map(FairMutex::lock).collect();
        let mut open = tiles.iter().filter(|tile| !tile.finished);
        let Some(first) = open.next() else { return true };
        let samples = first.range.end;
        let is_doubling = samples.is_multiple_of(BLOCK) && (samples / BLOCK).is_power_of_two();
        // It has been decided already, before the film was saved.
        let is_decided = first.earlier.samples == samples;
        if is_decided || !is_doubling || open.any(|other| other.range.end != samples) {
            return false;
        }
        let dark = dark_level(tiles.iter().map(|tile| &**tile));
        for tile in tiles.iter_mut().filter(|tile| !tile.finished) {
            tell_error(tile, dark);
        }
        let grid = Grid::new(self.settings.crop, tiles.iter().map(|tile| &**tile));
        let error = f64::from(target.error);
        let mut wanted = 0;
        for (at, tile) in tiles.iter_mut().enumerate() {
            let is_low = samples >= target.min_spp && grid.is_low(at, error);
            tile.finished = tile.finished || is_low;
            wanted += self.expect_samples(tile, error) * tile.window.area() as u64;
        }
        self.wanted.store(wanted, Ordering::Relaxed);
        tiles.iter().all(|tile| tile.finished)
    }

    /// How many samples a tile will take, as its error tells.
    fn expect_samples(&self, tile: &Tile, target: f64) -> u64 {
        let excess = tile.earlier.error / target;
        let more = match tile.finished {
            true => 1.0,
            false if excess.is_finite() => (excess * excess).max(2.0),
            false => 4.0,
        };
        (tile.range.end as f64 * more).min(self.settings.spp as f64) as u64
    }

    /// Whether all samples are there, or the noise of all tiles is low enough.
    pub fn is_whole(&self) -> bool {
        let end = self.range.end;
        self.tiles.iter().map(FairMutex::lock).all(|tile| tile.finished || tile.range.end >= end)
    }

    /// Whether no samples are there.
    pub fn is_blank(&self) -> bool {
        self.tiles.iter().map(FairMutex::lock).all(|tile| tile.range.is_empty())
    }

    /// Makes the picture of the samples so far.
    pub fn finish(&self) -> Rendered {
        let tiles: Vec<_> = self.tiles.iter().map(FairMutex::lock).collect();
        let tiles = || tiles.iter().map(|tile| &**tile);
        let counted = *lock(&self.counted);
        let counts = || tiles().map(|tile| tile.range.end - tile.range.start);
        let without = tiles().filter(|tile| tile.range.is_empty());
        let reached = self
            .settings
            .noise
            .map(|target| Grid::new(self.settings.crop, tiles()).reached(f64::from(target.error)));
        Rendered {
            picture: assemble_picture(tiles(), &self.settings),
            rays: counted.rays,
            breakdown: counted.breakdown,
            paths: self.taken.load(Ordering::Relaxed),
            elapsed: counted.elapsed,
            before: self.restored_time,
            samples: (counts().min().unwrap_or(0), counts().max().unwrap_or(0)),
            without_samples: without.map(|tile| tile.window.area() as u64).sum(),
            cancelled: tiles().any(|tile| !tile.finished && tile.range.end < self.range.end),
            reached,
            lost_count: tiles().map(|tile| tile.lost_count).sum(),
            lost: first_lost(tiles().flat_map(|tile| tile.lost.iter().copied()).collect()),
        }
    }
}

/// What a film's samples are taken of, and how.
struct Shoot<'a> {
    film: &'a Film,
    world: &'a World,
    camera: &'a MovingCamera,
    accel: &'a dyn Accel,
    cancel: &'a AtomicBool,
}

impl Shoot<'_> {
    /// Takes all tiles that go on up to the end of each pass, one pass after the other, on all
    /// threads.
    fn take(&self, passes: &[u64]) {
        let Self { film, world, camera, accel, .. } = *self;
        let camera = camera.rays(film.settings.aspect());
        let region = camera.region();
        let next_job = AtomicUsize::new(0);
        let work = |_: rayon::BroadcastContext<'_>| {
            let integrator = PathTracer::new(world, film.settings.transport);
            let mut stream = Stream::new(integrator, accel, region.as_ref());
            loop {
                let job = next_job.fetch_add(1, Ordering::Relaxed);
                let Some(&end) = passes.get(job / film.order.len()) else { break };
                let tile = &film.tiles[film.order[job % film.order.len()]];
                // The lock is let go after each block: saving never waits long.
                while self.take_block(&mut tile.lock(), &camera, &mut stream, end) {}
            }
            let counted = &mut *lock(&film.counted);
            counted.rays += stream.counts();
            counted.breakdown += *stream.breakdown();
        };
        if !film.order.is_empty() {
            rayon::broadcast(work);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Takes a tile up to the end of its block, or to `end` if that comes first; returns whether
    /// there was anything to take.
    fn take_block(
        &self,
        tile: &mut Tile,
        camera: &CameraRays,
        stream: &mut Stream<'_>,
        end: u64,
    ) -> bool {
        let next = tile.range.end;
        if next >= end || tile.finished || self.is_cancelled() {
            return false;
        }
        let block_end = ((next / BLOCK + 1) * BLOCK).min(end);
        tile.advance(stream, camera, &self.film.settings, block_end);
        let samples = (block_end - next) * tile.window.area() as u64;
        self.film.taken.fetch_add(samples, Ordering::Relaxed);
        true
    }
}

/// A panic elsewhere ends the render anyway; it need not be reported twice.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::accel::build;
    use crate::camera::Camera;
    use crate::geom::{Triangle, TriangleList, TriangleSource};
    use crate::math::Vec3;
    use crate::simd::Isa;

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
}
