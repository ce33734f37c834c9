//! The sums of one pixel's samples, and what they show.

use std::ops::Range;

use crate::integrator::FirstHit;
use crate::math::Vec3;
use crate::sampling::{BlockSums, NotAdjacent};

/// The sums of one pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PixelSums {
    /// By [`channel`]; those of the first surface add nothing where a camera ray hits none.
    sums: Sums,
    /// The time that they took.
    pub nanoseconds: f64,
}

type Sums = BlockSums<{ channel::COUNT }, 3>;

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
    /// No samples yet; the first to come is number `first`, a multiple of the block's size.
    pub fn starting_at(first: u64) -> Self {
        let sums = Sums::starting_at_block(first / crate::sampling::BLOCK);
        Self { sums, nanoseconds: 0.0 }
    }

    /// Takes the next sample.
    pub fn add(&mut self, radiance: Vec3, first: Option<&FirstHit>) {
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

    /// Passes over the next sample.
    pub fn skip(&mut self) {
        self.sums.skip();
    }

    /// Frees memory that is not needed; there are millions of them.
    pub fn shrink(&mut self) {
        self.sums.shrink();
    }

    /// Joins the samples that follow.
    ///
    /// # Errors
    /// If they do not follow.
    pub fn append(&mut self, later: &Self) -> Result<(), NotAdjacent> {
        self.sums.append(&later.sums)?;
        self.nanoseconds += later.nanoseconds;
        Ok(())
    }

    /// Passes over whole blocks of samples that are not there, up to one that starts at `next`.
    pub fn pass_over(&mut self, next: u64) {
        self.sums.pass_over(next);
    }

    /// What the samples so far come to.
    pub fn means(&self) -> Means {
        let (sum, count) = (self.sums.sum(), self.sums.count());
        let (all, hits) = (count.max(1) as f64, sum[channel::HIT].max(1.0));
        let three = |at: usize, by: f64| [sum[at] / by, sum[at + 1] / by, sum[at + 2] / by];
        let range = self.sums.range();
        Means {
            radiance: three(channel::RADIANCE, all),
            variance: self.sums.variance_of_mean(),
            alpha: sum[channel::HIT] / all,
            albedo: three(channel::ALBEDO, all),
            normal: three(channel::NORMAL, all),
            position: three(channel::POSITION, hits),
            distance: sum[channel::DISTANCE] / hits,
            count,
            cost: self.nanoseconds / (range.end - range.start).max(1) as f64,
        }
    }

    /// The mean radiance.
    pub fn radiance(&self) -> [f64; 3] {
        let (sum, count) = (self.sums.sum(), self.sums.count().max(1) as f64);
        std::array::from_fn(|c| sum[channel::RADIANCE + c] / count)
    }

    /// Whether the samples have the same sums, whatever time they took.
    pub fn has_same_sums(&self, other: &Self) -> bool {
        self.sums == other.sums
    }

    /// Words of 64 bits that the sums of a run of samples take.
    pub fn words(range: Range<u64>) -> usize {
        1 + Sums::NODE_WORDS * Sums::node_count(range)
    }

    /// The sums as words: first the time, then those of [`BlockSums::to_words`].
    pub fn to_words(&self) -> impl Iterator<Item = u64> + '_ {
        std::iter::once(self.nanoseconds.to_bits()).chain(self.sums.to_words())
    }

    /// The sums of a run of samples from their words; none if no sums have such words.
    pub fn from_words(range: Range<u64>, words: &mut impl Iterator<Item = u64>) -> Option<Self> {
        let nanoseconds = f64::from_bits(words.next()?);
        let sums = Sums::from_words(range, words)?;
        nanoseconds.is_finite().then_some(Self { sums, nanoseconds })
    }

    /// Bytes that a pixel takes with some number of samples.
    pub const fn bytes(samples: u64) -> u64 {
        Sums::bytes(samples) + size_of::<Self>() as u64 - Sums::bytes(0)
    }
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
        let mut sums = PixelSums::starting_at(0);
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
