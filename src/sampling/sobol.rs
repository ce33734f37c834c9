//! Owen-scrambled Sobol points, four-dimensional, in lanes.
//!
//! Burley, "Practical Hash-based Owen Scrambling", JCGT 2020, with Vegdahl's improved hash: the
//! points of the crate `sobol_burley`, which a test holds them to.

use super::lattice::{SALTS, unit_interval};
use super::scramble::{hash, owen_scramble};
use crate::simd::lanes::{Lanes, Uint};

/// The first four dimensions of the point whose number's bits, reversed, are `reversed`, under a
/// seed.
#[inline(always)]
pub(super) fn point<L: Lanes>(lanes: L, reversed: L::Uint, seed: L::Uint) -> [L::Float; 4] {
    let shuffled = owen_scramble::<L>(reversed, hash::<L>(seed ^ 0x79c6_8e4a));
    let [a, b, c, d] = reversed_point(lanes, shuffled);
    let seed = seed * 0x9c8f_2d3b;
    [
        scrambled::<L>(a, seed ^ SALTS[0]),
        scrambled::<L>(b, seed ^ SALTS[1]),
        scrambled::<L>(c, seed ^ SALTS[2]),
        scrambled::<L>(d, seed ^ SALTS[3]),
    ]
}

/// A coordinate whose bits are reversed, scrambled.
#[inline(always)]
fn scrambled<L: Lanes>(reversed: L::Uint, seed: L::Uint) -> L::Float {
    unit_interval::<L>(owen_scramble::<L>(reversed, hash::<L>(seed)).reverse_bits())
}

/// The coordinates of the point whose number has these bits reversed; of both, the upper 16 bits
/// count.
#[inline(always)]
fn reversed_point<L: Lanes>(lanes: L, shuffled: L::Uint) -> [L::Uint; 4] {
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

/// Direction numbers of the primitive polynomial of that degree and those inner coefficients,
/// grown from `initial`.
///
/// Joe and Kuo, "Constructing Sobol sequences with better two-dimensional projections", 2008.
const fn directions(degree: usize, coefficients: u32, initial: [u32; 3]) -> [u32; 16] {
    let mut v = [0; 16];
    let mut i = 0;
    while i < 16 {
        if i < degree {
            v[i] = initial[i] << (31 - i);
        } else {
            v[i] = v[i - degree] ^ (v[i - degree] >> degree);
            let mut k = 1;
            while k < degree {
                if coefficients >> (degree - 1 - k) & 1 == 1 {
                    v[i] ^= v[i - k];
                }
                k += 1;
            }
        }
        i += 1;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::super::scramble::mix32;
    use super::*;
    use crate::simd::lanes::Scalar;

    #[test]
    fn points_are_those_of_the_crate() {
        for i in 0..20_000_u32 {
            let (index, seed) = (mix32(i) >> 16, mix32(i ^ 0xabcd_ef01));
            let point = point(Scalar, index.reverse_bits().into(), seed.into());
            assert_eq!(point, sobol_burley::sample_4d(index, 0, seed));
        }
    }
}
