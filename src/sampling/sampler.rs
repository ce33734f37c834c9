//! The sampler: points of low discrepancy, without state.
//!
//! A value depends on pixel, sample, dimension and seed alone, so that any sample of any pixel can
//! be had at any time by any thread. Dimensions come in sets of four, each a shuffled copy of the
//! same four-dimensional points under a seed of its own ("padding"): stratified within,
//! independent between sets. Give the decisions whose effects are joint one set, and the most
//! important ones of two dimensions its lanes 0 and 1, or 2 and 3.
//!
//! The points are those of a [`super::lattice`], or [`super::sobol`]'s. A sequence ends after
//! 65,536 points; a sample beyond them is a point of another sequence, seeded by `sample >> 16`, so
//! that each run of 65,536 is stratified by itself.

use super::sampler_lanes::{SOBOL, SamplerLanes};
use super::scramble::mix32;
use crate::math::Vec2;
use crate::names::choices;
use crate::simd::lanes::Scalar;

/// The largest `f32` below one.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// How the samples of one pixel relate to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SamplePattern {
    /// A shifted and shuffled lattice: the least noise, but a variance estimated as if samples were
    /// independent is too high.
    #[default]
    Lattice,
    /// Owen-scrambled Sobol points: the same with a little more noise, and with nets of base two.
    Sobol,
    /// Independent samples: more noise, whose variance is estimated without bias. For statistics.
    Independent,
}

choices!(SamplePattern, "sampler", [
    Lattice => "lattice",
    Sobol => "sobol",
    Independent => "independent",
]);

impl SamplePattern {
    /// The stream of a sample, see [`Sampler::new`].
    #[inline(always)]
    pub fn sampler(self, pixel: u64, sample: u64, seed: u64) -> Sampler {
        match self {
            Self::Lattice => Sampler::new(pixel, sample, seed),
            Self::Sobol => Sampler::sobol(pixel, sample, seed),
            Self::Independent => Sampler::independent(pixel, sample, seed),
        }
    }
}

/// A stream of uniform numbers in `[0, 1)` for one sample of one pixel.
///
/// # Examples
/// ```
/// use dapple::sampling::Sampler;
///
/// let mut a = Sampler::new(7, 0, 0);
/// let first = a.next_1d();
/// let mut b = Sampler::new(7, 0, 0);
/// assert_eq!(b.next_1d(), first);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampler {
    /// The current set, valid while `dimension` is not at its start.
    values: [f32; 4],
    stream: StreamId,
    /// Of the next value.
    dimension: u32,
}

/// What tells a sample's stream from others: all that a path need keep of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamId {
    /// Hash of pixel, seed and the upper bits of the sample.
    pub key: u32,
    /// The number of its point: the lower 16 bits of the sample, and the highest bit if the points
    /// are Sobol's.
    pub index: u32,
}

impl StreamId {
    /// The stream from a dimension on. Multiples of four are free.
    #[inline(always)]
    pub fn at(self, dimension: u32) -> Sampler {
        let mut sampler = Sampler { values: [0.0; 4], stream: self, dimension: 0 };
        sampler.seek(dimension);
        sampler
    }
}

impl Sampler {
    /// The stream of `sample` of the pixel `y << 32 | x`, counted from the corner of the whole
    /// frame, so that a crop's pixels keep their values.
    #[inline(always)]
    pub fn new(pixel: u64, sample: u64, seed: u64) -> Self {
        Self::of_run(pixel, sample >> 16, seed, (sample & 0xffff) as u32)
    }

    /// As [`Sampler::new`], of [`SamplePattern::Sobol`].
    #[inline(always)]
    pub fn sobol(pixel: u64, sample: u64, seed: u64) -> Self {
        let mut sampler = Self::new(pixel, sample, seed);
        sampler.stream.index |= SOBOL;
        sampler
    }

    /// As [`Sampler::new`], but each sample is a point of a sequence of its own.
    #[inline(always)]
    pub fn independent(pixel: u64, sample: u64, seed: u64) -> Self {
        Self::of_run(pixel, !sample, seed, 0)
    }

    #[inline(always)]
    fn of_run(pixel: u64, run: u64, seed: u64, index: u32) -> Self {
        let salt = mix64(mix64(seed ^ 0x9e37_79b9_7f4a_7c15).wrapping_add(run));
        // One-to-one for frames of up to 65,536 pixels a side: no two pixels share a key.
        let place = (pixel as u32) ^ ((pixel >> 32) as u32).rotate_left(16);
        let key = mix32(mix32(place.wrapping_add(salt as u32)) ^ (salt >> 32) as u32);
        StreamId { key, index }.at(0)
    }

    /// The stream of the same pixel's next sample, not of [`SamplePattern::Independent`]; `None`
    /// where another sequence begins.
    #[inline(always)]
    pub fn next_sample(&self) -> Option<Self> {
        let StreamId { key, index } = self.stream;
        let next = StreamId { key, index: index + 1 };
        (next.index & 0xffff != 0).then(|| next.at(0))
    }

    /// Makes `dimension` the next value's. Multiples of four are free.
    #[inline(always)]
    pub fn seek(&mut self, dimension: u32) {
        self.dimension = dimension;
        if dimension & 3 != 0 {
            self.fill();
        }
    }

    /// The next dimension.
    #[inline(always)]
    pub fn next_1d(&mut self) -> f32 {
        let lane = self.dimension & 3;
        if lane == 0 {
            self.fill();
        }
        self.dimension = self.dimension.wrapping_add(1);
        self.values[lane as usize]
    }

    /// The next two dimensions; skips one where they would straddle two sets, because a pair from
    /// two sets is not stratified.
    #[inline(always)]
    pub fn next_2d(&mut self) -> Vec2 {
        if self.dimension & 3 == 3 {
            self.dimension = self.dimension.wrapping_add(1);
        }
        let x = self.next_1d();
        Vec2::new(x, self.next_1d())
    }

    /// What tells it from others.
    #[inline(always)]
    pub fn stream(&self) -> StreamId {
        self.stream
    }

    #[inline(always)]
    fn fill(&mut self) {
        let StreamId { key, index } = self.stream;
        let lanes = SamplerLanes::<Scalar>::new(key.into(), index.into());
        self.values = lanes.set(Scalar, self.dimension & !3);
    }
}

/// A one-to-one hash of 64 bits (the finaliser of `SplitMix64`).
#[inline]
const fn mix64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::chi_squared::assert_fits;

    fn pixel(x: u64, y: u64) -> u64 {
        y << 32 | x
    }

    #[test]
    fn it_is_small_and_pure() {
        assert!(size_of::<Sampler>() <= 28);
        let mut in_order = Sampler::new(pixel(3, 5), 9, 1);
        let values: Vec<f32> = (0..16).map(|_| in_order.next_1d()).collect();
        for dimension in [7_u32, 0, 15, 4, 8, 2] {
            let mut sampler = Sampler::new(pixel(3, 5), 9, 1);
            sampler.seek(dimension);
            assert_eq!(sampler.next_1d(), values[dimension as usize]);
        }
        assert!(values.iter().all(|v| (0.0..1.0).contains(v)));
    }

    #[test]
    fn a_pair_never_straddles_two_sets() {
        let mut sampler = Sampler::new(0, 0, 0);
        for _ in 0..3 {
            sampler.next_1d();
        }
        let pair = sampler.next_2d();
        let mut second_set = Sampler::new(0, 0, 0);
        second_set.seek(4);
        assert_eq!(pair, second_set.next_2d());
    }

    /// Of Sobol points, every power-of-two prefix of the first pair of any set puts one point into
    /// each elementary interval: the definition of a (0, m, 2)-net in base two.
    #[test]
    fn prefixes_are_nets() {
        for (place, set) in [(pixel(0, 0), 0), (pixel(17, 4), 3), (pixel(1919, 1079), 41)] {
            for run in [0_u64, 1, 5] {
                for log2_count in 0..9_u32 {
                    let count = 1_u64 << log2_count;
                    for log2_columns in 0..=log2_count {
                        let (columns, rows) = (1 << log2_columns, 1 << (log2_count - log2_columns));
                        let mut seen = vec![false; count as usize];
                        for sample in 0..count {
                            let mut sampler = Sampler::sobol(place, (run << 16) + sample, 7);
                            sampler.seek(set * 4);
                            let point = sampler.next_2d();
                            let column = (point.x * columns as f32) as usize;
                            let row = (point.y * rows as f32) as usize;
                            let cell = &mut seen[row * columns as usize + column];
                            assert!(!*cell, "two of {count} in cell {column}, {row} of {columns}");
                            *cell = true;
                        }
                    }
                }
            }
        }
    }

    /// Every lane alone is stratified too, also over the last points before a sequence ends.
    #[test]
    fn each_dimension_is_stratified() {
        for dimension in 0..8 {
            let mut seen = [false; 256];
            for sample in 65_536 - 256..65_536 {
                let mut sampler = Sampler::new(pixel(2, 2), sample, 3);
                sampler.seek(dimension);
                let cell = &mut seen[(sampler.next_1d() * 256.0) as usize];
                assert!(!std::mem::replace(cell, true));
            }
        }
    }

    /// Samples that shall be independent fill the square like dice, in each pair of dimensions and
    /// from one sample to the next.
    #[test]
    fn independent_samples_are() {
        const SIDE: usize = 16;
        let total = 40_000;
        let pairs: [(u32, u64, u32); 3] = [(0, 0, 1), (2, 0, 5), (0, 1, 0)];
        for (first, later, second) in pairs {
            let mut counts = vec![0_u64; SIDE * SIDE];
            for sample in 0..total {
                let value = |sample: u64, dimension: u32| {
                    let mut sampler = SamplePattern::Independent.sampler(pixel(3, 4), sample, 1);
                    sampler.seek(dimension);
                    (sampler.next_1d() * SIDE as f32) as usize
                };
                counts[value(sample, first) * SIDE + value(sample + later, second)] += 1;
            }
            let expected = vec![total as f64 / counts.len() as f64; counts.len()];
            assert_fits(&counts, &expected, 3, "independent");
        }
    }

    /// The same sample index of neighbouring pixels, of other sets, seeds and runs is independent.
    #[test]
    fn pixels_sets_seeds_and_runs_are_independent() {
        const SIDE: usize = 16;
        type Pair<'a> = &'a dyn Fn(u64) -> (Sampler, Sampler);
        let pairs: [(&str, Pair); 4] = [
            ("pixels", &|i| (Sampler::new(pixel(i, 0), 0, 0), Sampler::new(pixel(i + 1, 0), 0, 0))),
            ("seeds", &|i| (Sampler::new(pixel(i, 9), 1, 0), Sampler::new(pixel(i, 9), 1, 1))),
            ("runs", &|i| (Sampler::new(pixel(0, i), 2, 0), Sampler::new(pixel(0, i), 65_538, 0))),
            ("sets", &|i| {
                let mut other = Sampler::new(pixel(i, i), 0, 0);
                other.seek(8);
                (Sampler::new(pixel(i, i), 0, 0), other)
            }),
        ];
        for (name, pair) in pairs {
            let mut counts = vec![0_u64; SIDE * SIDE];
            let total = 40_000;
            for i in 0..total {
                let (mut a, mut b) = pair(i);
                let x = (a.next_1d() * SIDE as f32) as usize;
                let y = (b.next_1d() * SIDE as f32) as usize;
                counts[y * SIDE + x] += 1;
            }
            let expected = vec![total as f64 / counts.len() as f64; counts.len()];
            assert_fits(&counts, &expected, 4, name);
        }
    }
}
