//! What a render gives.

use std::time::Duration;

use super::breakdown::Breakdown;
use super::noise_target::NoiseReached;
use super::stream::RayCounts;
use super::tile::LostSample;
use crate::film::Picture;

/// A picture and how it came about.
#[derive(Debug)]
pub struct Rendered {
    /// The layers: `R G B A`, and those of [`super::Settings::aovs`].
    pub picture: Picture,
    /// Rays that were shot.
    pub rays: RayCounts,
    /// Where the time went, over all threads.
    pub breakdown: Breakdown,
    /// Paths that were followed.
    pub paths: u64,
    /// Time that rendering took, without loading and building.
    pub elapsed: Duration,
    /// Time that the samples of a checkpoint took, from which it went on.
    pub before: Duration,
    /// The fewest and the most samples a pixel has, lost ones included.
    pub samples: (u64, u64),
    /// Pixels without any sample, which are black.
    pub without_samples: u64,
    /// Whether it was cancelled before all samples were taken.
    pub cancelled: bool,
    /// How good the picture is, if there was a target for the noise.
    pub reached: Option<NoiseReached>,
    /// The number of samples that were not finite.
    pub lost_count: u64,
    /// The first ten of them, by row, column and sample.
    pub lost: Vec<LostSample>,
}
