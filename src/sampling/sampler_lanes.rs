//! The streams of [`super::Sampler`], one a lane.

use super::scramble::{mix_in_lanes, mix32};
use super::{lattice, sobol};
use crate::simd::lanes::{Lanes, Mask, Uint};

/// In a stream's number of its point: whether the points are Sobol's.
pub(super) const SOBOL: u32 = 1 << 31;

/// The streams of [`super::Sampler`], one a lane.
#[derive(Clone, Copy)]
pub struct SamplerLanes<L: Lanes> {
    key: L::Uint,
    /// The number of the point, its bits reversed.
    reversed: L::Uint,
    /// Whether the points are Sobol's, in all lanes.
    is_sobol: bool,
}

impl<L: Lanes> SamplerLanes<L> {
    /// Streams of one pattern by keys and indices, see [`super::StreamId`].
    #[inline(always)]
    pub fn new(key: L::Uint, index: L::Uint) -> Self {
        let is_sobol = (index >> 31).eq(1).to_bits() & 1 == 1;
        Self { key, reversed: (index & !SOBOL).reverse_bits(), is_sobol }
    }

    /// The four dimensions from `dimension` on, a multiple of four.
    #[inline(always)]
    pub fn set(&self, lanes: L, dimension: u32) -> [L::Float; 4] {
        let set = (dimension >> 2).wrapping_mul(0x9e37_79b9).wrapping_add(0x85eb_ca6b);
        let seed = mix_in_lanes::<L>(self.key ^ mix32(set));
        if self.is_sobol {
            sobol::point(lanes, self.reversed, seed)
        } else {
            lattice::point::<L>(self.reversed, seed)
        }
    }

    /// The two dimensions from `dimension` on, an even number.
    #[inline(always)]
    pub fn pair(&self, lanes: L, dimension: u32) -> [L::Float; 2] {
        let [a, b, c, d] = self.set(lanes, dimension & !3);
        if dimension & 2 == 0 { [a, b] } else { [c, d] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{SamplePattern, Sampler, StreamId};
    use crate::simd::lanes::{Float, Lanes8, Lanes16, MAX_LANES, Scalar};
    use crate::simd::{Isa, vectorized};

    #[inline(always)]
    fn agree<L: Lanes>(lanes: L, pattern: SamplePattern, first: u64) {
        let samplers: [Sampler; MAX_LANES] = std::array::from_fn(|lane| {
            let number = first * 16 + lane as u64;
            pattern.sampler((number << 32) | (number % 97), number * 2_531 % 65_536, first)
        });
        let load = |part: fn(StreamId) -> u32| {
            let values = samplers.map(|sampler| f32::from_bits(part(sampler.stream())));
            lanes.load(&values).to_bits()
        };
        let streams = SamplerLanes::<L>::new(load(|it| it.key), load(|it| it.index));
        for dimension in [0, 4, 8, 244] {
            let set = streams.set(lanes, dimension);
            for (i, column) in set.into_iter().enumerate() {
                let mut bits = [0; MAX_LANES];
                column.to_bits().store(&mut bits);
                for lane in 0..L::WIDTH {
                    let mut sampler = samplers[lane];
                    sampler.seek(dimension + i as u32);
                    assert_eq!(sampler.next_1d().to_bits(), bits[lane]);
                }
            }
        }
    }

    #[test]
    fn lanes_have_the_samplers_numbers() {
        for (first, pattern) in (0..50).flat_map(|i| SamplePattern::ALL.map(|p| (i, p))) {
            agree(Scalar, pattern, first);
            for isa in Isa::available() {
                vectorized!(isa.level().expect("available"), simd => {
                    agree(Lanes8(simd), pattern, first);
                    agree(Lanes16(simd), pattern, first);
                });
            }
        }
    }
}
