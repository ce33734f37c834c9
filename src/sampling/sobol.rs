//! The points of [`super::Sampler`] in lanes: one sample's set of four dimensions a lane.

use super::sampler::{directions, mix32};
use crate::simd::lanes::{Lanes, Uint};

/// The streams of [`super::Sampler`], one a lane.
#[derive(Clone, Copy)]
pub struct SamplerLanes<L: Lanes> {
    key: L::Uint,
    /// The number of the point, its bits reversed.
    reversed: L::Uint,
}

impl<L: Lanes> SamplerLanes<L> {
    /// Streams by what [`super::Sampler::parts`] tells of them.
    #[inline(always)]
    pub fn new(key: L::Uint, index: L::Uint) -> Self {
        Self { key, reversed: index.reverse_bits() }
    }

    /// The four dimensions from `dimension` on, a multiple of four.
    #[inline(always)]
    pub fn set(&self, lanes: L, dimension: u32) -> [L::Float; 4] {
        let set = (dimension >> 2).wrapping_mul(0x9e37_79b9).wrapping_add(0x85eb_ca6b);
        let seed = mix_in_lanes::<L>(self.key ^ mix32(set));
        let shuffled = owen_scramble::<L>(self.reversed, hash::<L>(seed ^ 0x79c6_8e4a));
        let [a, b, c, d] = sobol_reversed(lanes, shuffled);
        let base = seed * 0x9c8f_2d3b;
        [
            scramble::<L>(a, base ^ 0x912f_69ba),
            scramble::<L>(b, base ^ 0x174f_18ab),
            scramble::<L>(c, base ^ 0x691e_72ca),
            scramble::<L>(d, base ^ 0xb40c_c1b8),
        ]
    }
}

/// A number in `[0, 1)` of a coordinate, its bits reversed, scrambled by a seed.
#[inline(always)]
fn scramble<L: Lanes>(reversed: L::Uint, seed: L::Uint) -> L::Float {
    let bits = owen_scramble::<L>(reversed, hash::<L>(seed)).reverse_bits();
    ((bits >> 9) | 0x3f80_0000).to_float_bits() - 1.0
}

/// The first four coordinates of the point whose number has these bits reversed; of both, the
/// upper 16 bits count.
#[inline(always)]
fn sobol_reversed<L: Lanes>(lanes: L, shuffled: L::Uint) -> [L::Uint; 4] {
    let zero = lanes.uint(0);
    let mut point = [zero; 3];
    for bit in 0..16 {
        // All bits where this one is set.
        let set = zero - ((shuffled >> (31 - bit)) & 1);
        for (coordinate, directions) in point.iter_mut().zip(&DIRECTIONS) {
            *coordinate = *coordinate ^ (set & directions[bit as usize]);
        }
    }
    // Van der Corput's coordinate is the number itself.
    [(shuffled & 0xffff_0000).reverse_bits(), point[0], point[1], point[2]]
}

/// The second to fourth coordinates' direction numbers, their bits reversed.
const DIRECTIONS: [[u32; 16]; 3] = [
    reversed(directions(1, 0, [1, 0, 0])),
    reversed(directions(2, 1, [1, 3, 0])),
    reversed(directions(3, 1, [1, 3, 1])),
];

const fn reversed(mut numbers: [u32; 16]) -> [u32; 16] {
    let mut i = 0;
    while i < 16 {
        numbers[i] = numbers[i].reverse_bits();
        i += 1;
    }
    numbers
}

/// [`mix32`] in lanes.
#[inline(always)]
fn mix_in_lanes<L: Lanes>(x: L::Uint) -> L::Uint {
    let x = (x ^ (x >> 16)) * 0x7feb_352d;
    let x = (x ^ (x >> 15)) * 0x846c_a68b;
    x ^ (x >> 16)
}

/// The hash of the crate `sobol_burley`.
#[inline(always)]
fn hash<L: Lanes>(x: L::Uint) -> L::Uint {
    mix_in_lanes::<L>(x ^ 0xe6fe_3beb)
}

/// Owen scrambling of reversed bits: Vegdahl's hash, as the crate `sobol_burley` has it.
#[inline(always)]
fn owen_scramble<L: Lanes>(x: L::Uint, scramble: L::Uint) -> L::Uint {
    let x = x ^ (x * 0x3d20_adea);
    let x = (x + scramble) * ((scramble >> 16) | 1);
    let x = x ^ (x * 0x0552_6c56);
    x ^ (x * 0x53a2_2864)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use crate::simd::lanes::{Lanes4, Lanes8, Lanes16, MAX_LANES};
    use crate::simd::{Isa, vectorized};

    #[inline(always)]
    fn agree<L: Lanes>(lanes: L, first: u64) {
        use crate::simd::lanes::Float;
        let samplers: [Sampler; MAX_LANES] = std::array::from_fn(|lane| {
            let number = first * 16 + lane as u64;
            Sampler::new(number << 32 | number % 97, number * 2_531 % 65_536, first)
        });
        let part = |which: usize| {
            let values = samplers.map(|sampler| f32::from_bits(sampler.parts()[which]));
            lanes.load(&values).to_bits()
        };
        let streams = SamplerLanes::<L>::new(part(0), part(1));
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
        for first in 0..50 {
            agree(crate::simd::lanes::Scalar, first);
            for isa in Isa::available() {
                vectorized!(isa.level().expect("available"), simd => {
                    agree(Lanes4(simd), first);
                    agree(Lanes8(simd), first);
                    agree(Lanes16(simd), first);
                });
            }
        }
    }
}
