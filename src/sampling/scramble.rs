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
