//! Hashes of 32 bits, and Owen scrambling by one.

use crate::simd::lanes::Lanes;

/// A one-to-one hash of 32 bits (Wellons, "lowbias32").
#[inline]
pub(super) const fn mix32(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Another number in `[0, 1)` from the bits of three: for a choice among so many that the 24 bits
/// of one do not reach. As good as random, so nothing of their stratification is left in it.
pub fn mix_uniforms(u: [f32; 3]) -> f32 {
    let mixed = u.iter().fold(0x9e37_79b9, |hash, u| mix32(hash ^ u.to_bits()).wrapping_mul(3));
    (mix32(mixed) >> 8) as f32 / (1 << 24) as f32
}

/// [`mix32`] in lanes.
#[inline(always)]
pub(super) fn mix_in_lanes<L: Lanes>(x: L::Uint) -> L::Uint {
    let x = (x ^ (x >> 16)) * 0x7feb_352d;
    let x = (x ^ (x >> 15)) * 0x846c_a68b;
    x ^ (x >> 16)
}

/// The same of other bits, as the crate `sobol_burley` has it.
#[inline(always)]
pub(super) fn hash<L: Lanes>(x: L::Uint) -> L::Uint {
    mix_in_lanes::<L>(x ^ 0xe6fe_3beb)
}

/// Owen scrambling of reversed bits: Vegdahl's hash, as the crate `sobol_burley` has it.
#[inline(always)]
pub(super) fn owen_scramble<L: Lanes>(x: L::Uint, scramble: L::Uint) -> L::Uint {
    let x = x ^ (x * 0x3d20_adea);
    let x = (x + scramble) * ((scramble >> 16) | 1);
    let x = x ^ (x * 0x0552_6c56);
    x ^ (x * 0x53a2_2864)
}
