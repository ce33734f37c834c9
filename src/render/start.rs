//! The starts of a tile's paths: random numbers, places on the film, and camera rays, in lanes.

use super::settings::{Settings, hash_path};
use crate::camera::CameraRays;
use crate::geom::are_usable;
use crate::integrator::{LENS_DIMENSION, PIXEL_DIMENSION, Path, PathSample, TIME_DIMENSION};
use crate::math::{Ray, Vec3};
use crate::sampling::{SamplerLanes, StreamId};
use crate::simd::lanes::{Float, Lanes, MAX_LANES, Mask, Rows, Uint};

/// The samples of a rectangle of pixels: of each pixel some, one after the other. Slots count from
/// 0 in that order.
#[derive(Clone, Copy)]
pub(super) struct Starts<'a> {
    pub settings: &'a Settings,
    pub camera: &'a CameraRays,
    /// Column and row of the first pixel.
    pub corner: (u32, u32),
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// The first sample.
    pub first: u64,
    /// How many samples each pixel takes.
    pub count: u32,
    /// Whether paths need keys: where something is see-through.
    pub keyed: bool,
    /// Whether each path has a time of its own: where something moves.
    pub timed: bool,
}

/// Paths that started, and their results without light.
pub(super) struct Started<'a> {
    pub rays: &'a mut Vec<Ray>,
    pub paths: &'a mut Vec<Path>,
    pub samples: &'a mut Vec<PathSample>,
}

/// What the paths of a block begin with, one a lane. The paths themselves are made where they stay:
/// they are large.
struct Block {
    len: usize,
    /// Key and index of the stream, as bits, column and row.
    rows: Rows,
    seeds: [Seed; MAX_LANES],
}

/// What a path begins with, besides its ray.
#[derive(Clone, Copy)]
struct Seed {
    stream: StreamId,
    key: u64,
    slot: u32,
}

impl Started<'_> {
    fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
        self.samples.clear();
    }

    #[inline(always)]
    fn push(&mut self, ray: Ray, path: impl FnOnce() -> Path) {
        let mut sample = PathSample::default();
        if ray == Ray::MISS {
            sample.radiance = Vec3::NAN; // a camera that cannot see: counted, not hidden
        } else {
            self.rays.push(ray);
            self.paths.push(path());
        }
        self.samples.push(sample);
    }
}

impl Starts<'_> {
    /// Starts all paths. The bits are those of [`Settings::start`].
    #[inline(always)]
    pub fn start<L: Lanes>(&self, lanes: L, started: &mut Started<'_>) {
        started.clear();
        if !self.camera.has_lanes() {
            return self.start_one_by_one(started);
        }
        let unused = Seed { stream: StreamId { key: 0, index: 0 }, key: 0, slot: 0 };
        let mut block = Block { len: 0, rows: Rows::default(), seeds: [unused; MAX_LANES] };
        for (pixel, (x, y)) in self.pixels().enumerate() {
            let place = u64::from(y) << 32 | u64::from(x);
            let mut sampler = self.settings.pattern.sampler(place, self.first, self.settings.seed);
            for i in 0..self.count {
                let sample = self.first + u64::from(i);
                if i > 0 {
                    sampler = self.settings.next_sampler(sampler, place, sample);
                }
                let key = self.key(place, sample);
                let slot = pixel as u32 * self.count + i;
                block.push((x, y), Seed { stream: sampler.stream(), key, slot });
                if block.len == L::WIDTH {
                    self.start_block(lanes, &mut block, started);
                }
            }
        }
        self.start_block(lanes, &mut block, started);
    }

    /// How wide a pixel is.
    pub fn pixel_cone(&self) -> [f32; 2] {
        self.camera.pixel_cone(self.settings.resolution.1)
    }

    fn start_one_by_one(&self, started: &mut Started<'_>) {
        for (pixel, (x, y)) in self.pixels().enumerate() {
            for i in 0..self.count {
                let slot = pixel as u32 * self.count + i;
                let sample = self.first + u64::from(i);
                let (ray, path) =
                    self.settings.start(self.camera, (x, y), sample, slot, self.timed);
                started.push(ray, || path);
            }
        }
    }

    fn pixels(&self) -> impl Iterator<Item = (u32, u32)> {
        let ((x0, y0), (width, height)) = (self.corner, self.size);
        (y0..y0 + height).flat_map(move |y| (x0..x0 + width).map(move |x| (x, y)))
    }

    #[inline(always)]
    fn key(&self, pixel: u64, sample: u64) -> u64 {
        if self.keyed { hash_path(pixel, sample, self.settings.seed) } else { 0 }
    }

    /// Starts the paths of a block, and empties it.
    #[inline(always)]
    fn start_block<L: Lanes>(&self, lanes: L, block: &mut Block, started: &mut Started<'_>) {
        let [key, index, x, y] = lanes.columns(&block.rows);
        let sampler = SamplerLanes::<L>::new(key.to_bits(), index.to_bits());
        let u_filter = sampler.pair(lanes, PIXEL_DIMENSION);
        let [dx, dy] = self.settings.filter.sample_in_lanes(lanes, u_filter);
        let (width, height) = self.settings.resolution;
        let film = [(x + 0.5 + dx) / width as f32, (y + 0.5 + dy) / height as f32];
        let u_lens = sampler.pair(lanes, LENS_DIMENSION);
        let mut times = [0.0; MAX_LANES];
        if self.timed {
            let [time, _] = sampler.pair(lanes, TIME_DIMENSION);
            let mut bits = [0; MAX_LANES];
            time.to_bits().store(&mut bits);
            times = bits.map(f32::from_bits);
        }
        let stand = self.camera.stand(lanes, &times, block.len);
        let (origin, direction) = self.camera.ray_in_lanes(lanes, &stand, film, u_lens);
        let [mut origins, mut directions] = [Rows::default(); 2];
        lanes.rows(origin.columns(x), &mut origins);
        lanes.rows(direction.columns(y), &mut directions);
        let usable = are_usable(lanes, origin, direction).to_bits();
        for lane in 0..block.len {
            let ([ox, oy, oz, _], [dx, dy, dz, _]) = (origins[lane], directions[lane]);
            let ray = if usable >> lane & 1 == 1 {
                Ray::usable(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz), f32::INFINITY)
            } else {
                Ray::MISS
            };
            let Seed { stream, key, slot } = block.seeds[lane];
            started.push(
                ray,
                #[inline(always)]
                || Path::new(stream, key, slot).at(times[lane]),
            );
        }
        block.len = 0;
    }
}

impl Block {
    #[inline(always)]
    fn push(&mut self, (x, y): (u32, u32), seed: Seed) {
        let StreamId { key, index } = seed.stream;
        self.rows[self.len] = [f32::from_bits(key), f32::from_bits(index), x as f32, y as f32];
        self.seeds[self.len] = seed;
        self.len += 1;
    }
}
