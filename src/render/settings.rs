//! What a picture is a function of, besides its scene and camera.

use super::noise_target::NoiseTarget;
use crate::camera::CameraRays;
use crate::film::{PixelFilter, Window};
use crate::integrator::{LENS_DIMENSION, Path, Transport};
use crate::math::{Ray, Vec2};
use crate::names::choices;
use crate::sampling::{SamplePattern, Sampler};

/// A layer of the picture besides its colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// The share of light that the first surface scatters; in mirrors and through what is clear,
    /// that of what is seen there.
    Albedo,
    /// Shading normal of the same surface, world space.
    Normal,
    /// Where the first surface is, world space.
    Position,
    /// How far away it is, metres.
    Depth,
    /// Estimated variance of each pixel's mean.
    Variance,
    /// The number of samples in each pixel's mean.
    Samples,
    /// Nanoseconds per sample. The only layer that differs from run to run.
    Cost,
}

choices!(Aov, "layer", [
    Albedo => "albedo",
    Normal => "normal",
    Position => "position",
    Depth => "depth",
    Variance => "variance",
    Samples => "samples",
    Cost => "cost",
]);

/// How to render.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Width and height of the whole frame, pixels, at least 1 each.
    pub resolution: (u32, u32),
    /// The part of it to render; inside the frame, not empty.
    pub crop: Window,
    /// Samples per pixel, at least 1; with a target for the noise, at most.
    pub spp: u64,
    /// Stops parts of the picture once their noise is so low.
    pub noise: Option<NoiseTarget>,
    /// Another number, another noise.
    pub seed: u64,
    /// How the samples of a pixel relate to each other.
    pub pattern: SamplePattern,
    /// Where in and around its pixel a sample falls.
    pub filter: PixelFilter,
    /// How light is followed.
    pub transport: Transport,
    /// The layers wanted.
    pub aovs: Vec<Aov>,
}

impl Settings {
    /// A frame of that many pixels with 64 samples each, and otherwise the defaults of
    /// `dapple render`.
    ///
    /// # Examples
    /// ```
    /// use dapple::Settings;
    ///
    /// let quick = Settings { spp: 4, ..Settings::new(320, 180) };
    /// assert_eq!(quick.crop.area(), 320 * 180);
    /// ```
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            resolution: (width, height),
            crop: Window::of_size(width as usize, height as usize),
            spp: 64,
            noise: None,
            seed: 0,
            pattern: SamplePattern::default(),
            filter: PixelFilter::BlackmanHarris,
            transport: Transport::default(),
            aovs: Aov::ALL.to_vec(),
        }
    }

    /// Width over height of the whole frame.
    pub fn aspect(&self) -> f32 {
        self.resolution.0 as f32 / self.resolution.1 as f32
    }

    /// The stream of a pixel's sample, from that of the sample before.
    #[inline(always)]
    pub(super) fn next_sampler(&self, before: Sampler, pixel: u64, sample: u64) -> Sampler {
        match (self.pattern, before.next_sample()) {
            (SamplePattern::Lattice | SamplePattern::Sobol, Some(next)) => next,
            _ => self.pattern.sampler(pixel, sample, self.seed),
        }
    }

    /// Starts the path of one sample of the pixel at column `x`, row `y` of the frame; `timed`:
    /// at a time of its own.
    #[inline(always)]
    pub(super) fn start(
        &self,
        camera: &CameraRays,
        (x, y): (u32, u32),
        sample: u64,
        slot: u32,
        timed: bool,
    ) -> (Ray, Path) {
        let pixel = u64::from(y) << 32 | u64::from(x);
        let mut sampler = self.pattern.sampler(pixel, sample, self.seed);
        let (width, height) = (self.resolution.0 as f32, self.resolution.1 as f32);
        let offset = self.filter.sample(sampler.next_2d());
        sampler.seek(LENS_DIMENSION);
        let lens = sampler.next_2d();
        let place = Vec2::new(x as f32, y as f32) + 0.5 + offset;
        let path = Path::new(sampler.stream(), hash_path(pixel, sample, self.seed), slot);
        let path = if timed { path.at_its_time() } else { path };
        (camera.ray_at(place / Vec2::new(width, height), lens, path.time), path)
    }
}

/// A hash of what makes a path differ from all others.
pub(super) fn hash_path(pixel: u64, sample: u64, seed: u64) -> u64 {
    let mix = |x: u64| {
        let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    };
    mix(mix(mix(seed.wrapping_add(0x9e37_79b9_7f4a_7c15)) ^ pixel).wrapping_add(sample))
}
