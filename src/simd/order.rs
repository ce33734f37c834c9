//! Sorting the children that a ray enters, farthest first, without branches.
//!
//! A key is the distance's bits with the lane in the lowest four, plus sixteen; zero is a lane that
//! was missed. As distances are not negative, keys compare as distances do, and a key rounds its
//! distance down. Sorted keys are stored at the top of a stack with the links of their lanes; the
//! nearest comes to lie on top.

use fearless_simd::Simd;

/// The lane is in these bits of a key.
pub const LANE: u32 = 15;
/// The distance is in these: without its sign, which is that of a zero if it is set.
pub const DISTANCE: u32 = 0x7fff_ffff & !LANE;
/// Added to a key, so that none is zero but that of a miss.
pub const BIAS: u32 = 16;

/// The largest key whose distance, rounded down, is not above `t_max`.
#[inline(always)]
pub fn key_limit(t_max: f32) -> u32 {
    (t_max.to_bits() | LANE).saturating_add(BIAS)
}

/// Sorts keys in descending order and stores them and the links of their lanes; unless `SORTED`,
/// any order will do.
///
/// `hits` has a bit for each lane whose key is not zero. What is stored beyond their number has no
/// meaning.
#[inline(always)]
pub fn store_keys<const SORTED: bool, S: Simd, const W: usize>(
    simd: S,
    keys: [u32; W],
    hits: u32,
    links: &[u32; W],
    to_keys: &mut [u32; W],
    to_links: &mut [u32; W],
) {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        return x86::store_keys::<SORTED, W>(avx2, keys, hits, links, to_keys, to_links);
    }
    let _ = simd;
    let mut lanes = hits;
    let mut count = 0;
    while lanes != 0 {
        let key = keys[lanes.trailing_zeros() as usize % W];
        lanes &= lanes - 1;
        insert(to_keys, count, key);
        count += 1;
    }
    for (link, key) in to_links.iter_mut().zip(&to_keys[..count]) {
        *link = links[(key & LANE) as usize % W];
    }
}

/// Stores the keys of `hits`, and the links of their lanes, in the order of a list of all lanes: a
/// nibble each, the first one lowest. What is stored beyond their number has no meaning.
#[inline(always)]
pub fn store_listed<S: Simd, const W: usize>(
    simd: S,
    keys: [u32; W],
    list: u64,
    links: &[u32; W],
    to_keys: &mut [u32; W],
    to_links: &mut [u32; W],
) {
    #[cfg(target_arch = "x86_64")]
    if let (8, Some(avx2)) = (W, simd.level().as_avx2()) {
        return x86::store_listed(avx2, &keys, list as u32, links, to_keys, to_links);
    }
    let _ = simd;
    let mut count = 0;
    for place in 0..W {
        let lane = (list >> (4 * place)) as usize % W;
        // Overwritten by the next one if this lane was missed.
        (to_keys[count], to_links[count]) = (keys[lane], links[lane]);
        count = (count + usize::from(keys[lane] != 0)).min(W - 1);
    }
}

/// Inserts into the first `count` keys, which are in descending order.
#[inline(always)]
fn insert<const W: usize>(keys: &mut [u32; W], count: usize, key: u32) {
    let mut at = count;
    while at > 0 && keys[at - 1] < key {
        keys[at] = keys[at - 1];
        at -= 1;
    }
    keys[at] = key;
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::{Avx2, SimdBase, SimdInto, SimdMask, u32x4, u32x8};

    use super::{LANE, insert};

    /// For each set of lanes: them in ascending order, then the others, a byte each.
    static HITS_FIRST: [u64; 256] = {
        let mut table = [0; 256];
        let mut hits = 0;
        while hits < 256 {
            let (mut lane, mut first, mut last) = (0, 0, (hits as u32).count_ones());
            while lane < 8 {
                let place = if hits >> lane & 1 == 1 { &mut first } else { &mut last };
                table[hits] |= lane << (8 * *place);
                *place += 1;
                lane += 1;
            }
            hits += 1;
        }
        table
    };

    #[inline(always)]
    pub fn store_keys<const SORTED: bool, const W: usize>(
        avx2: Avx2,
        keys: [u32; W],
        hits: u32,
        links: &[u32; W],
        to_keys: &mut [u32; W],
        to_links: &mut [u32; W],
    ) {
        let (keys, links) = (&keys[..], &links[..]);
        let (to_keys, to_links) = (&mut to_keys[..], &mut to_links[..]);
        match W {
            4 => {
                let sorted = sort4(avx2, u32x4::from_slice(avx2, keys).into());
                let links = pick4(avx2, u32x4::from_slice(avx2, links).into(), sorted);
                let (sorted, links): (u32x4<_>, u32x4<_>) =
                    (sorted.simd_into(avx2), links.simd_into(avx2));
                sorted.store_slice(to_keys);
                links.store_slice(to_links);
            }
            8 => {
                let keys = move_hits_first(avx2, u32x8::from_slice(avx2, keys).into(), hits);
                let sorted = if SORTED { sort8(avx2, keys, hits) } else { keys };
                let links = pick8(avx2, u32x8::from_slice(avx2, links).into(), sorted);
                let (sorted, links): (u32x8<_>, u32x8<_>) =
                    (sorted.simd_into(avx2), links.simd_into(avx2));
                sorted.store_slice(to_keys);
                links.store_slice(to_links);
            }
            _ => sort16(avx2, keys, hits, links, to_keys, to_links),
        }
    }

    /// [`super::store_listed`] for eight lanes.
    #[inline(always)]
    pub fn store_listed(
        avx2: Avx2,
        keys: &[u32],
        list: u32,
        links: &[u32],
        to_keys: &mut [u32],
        to_links: &mut [u32],
    ) {
        let keys = u32x8::from_slice(avx2, keys).into();
        let listed: u32x8<_> = pick_listed(avx2, keys, list).simd_into(avx2);
        let hits = !listed.simd_eq(u32x8::splat(avx2, 0)).to_bitmask() as u32;
        let keys = move_hits_first(avx2, listed.into(), hits);
        let links = pick8(avx2, u32x8::from_slice(avx2, links).into(), keys);
        let (keys, links): (u32x8<_>, u32x8<_>) = (keys.simd_into(avx2), links.simd_into(avx2));
        keys.store_slice(to_keys);
        links.store_slice(to_links);
    }

    fearless_simd::kernel!(
        /// Lanes in the order of a list.
        #[inline(always)]
        fn pick_listed(avx2: Avx2, keys: __m256i, list: u32) -> __m256i {
            let shifts = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
            let lanes = _mm256_srlv_epi32(_mm256_set1_epi32(list as i32), shifts);
            // Of each the lowest three bits count.
            _mm256_permutevar8x32_epi32(keys, lanes)
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn pick4(avx2: Avx2, links: __m128i, keys: __m128i) -> __m128i {
            _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(links), keys))
        }
    );

    fearless_simd::kernel!(
        #[inline(always)]
        fn pick8(avx2: Avx2, links: __m256i, keys: __m256i) -> __m256i {
            _mm256_permutevar8x32_epi32(links, keys)
        }
    );

    fearless_simd::kernel!(
        /// A network of three layers.
        #[inline(always)]
        fn sort4(avx2: Avx2, keys: __m128i) -> __m128i {
            macro_rules! layer {
                ($keys:expr, $partner:literal, $lower:literal) => {{
                    let (keys, partner) = ($keys, _mm_shuffle_epi32::<$partner>($keys));
                    let (high, low) = (_mm_max_epu32(keys, partner), _mm_min_epu32(keys, partner));
                    _mm_blend_epi32::<$lower>(high, low)
                }};
            }
            let keys = layer!(keys, 0b10_11_00_01, 0b1010);
            let keys = layer!(keys, 0b01_00_11_10, 0b1100);
            layer!(keys, 0b11_01_10_00, 0b0100)
        }
    );

    fearless_simd::kernel!(
        /// Moves the hits to the front.
        #[inline(always)]
        fn move_hits_first(avx2: Avx2, keys: __m256i, hits: u32) -> __m256i {
            let order = HITS_FIRST[hits as usize & 255] as i64;
            let order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(order));
            _mm256_permutevar8x32_epi32(keys, order)
        }
    );

    fearless_simd::kernel!(
        /// Sorts keys whose hits are in front; most often four lanes are enough.
        #[inline(always)]
        fn sort8(avx2: Avx2, keys: __m256i, hits: u32) -> __m256i {
            macro_rules! layer {
                ($keys:expr, $partner:expr, $lower:literal) => {{
                    let (keys, partner) = ($keys, $partner);
                    let high = _mm256_max_epu32(keys, partner);
                    let low = _mm256_min_epu32(keys, partner);
                    _mm256_blend_epi32::<$lower>(high, low)
                }};
            }
            if hits.count_ones() <= 4 {
                let front = sort4(avx2, _mm256_castsi256_si128(keys));
                return _mm256_zextsi128_si256(front);
            }
            let keys = layer!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b1010_1010);
            let keys = layer!(keys, _mm256_shuffle_epi32::<0b00_01_10_11>(keys), 0b1100_1100);
            let keys = layer!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b1010_1010);
            let mirrored = _mm256_permute4x64_epi64::<0b00_01_10_11>(keys);
            let mirrored = _mm256_shuffle_epi32::<0b10_11_00_01>(mirrored);
            let keys = layer!(keys, mirrored, 0b1111_0000);
            let keys = layer!(keys, _mm256_shuffle_epi32::<0b01_00_11_10>(keys), 0b1100_1100);
            layer!(keys, _mm256_shuffle_epi32::<0b10_11_00_01>(keys), 0b1010_1010)
        }
    );

    /// Sixteen lanes: eight are enough most often.
    #[inline(always)]
    fn sort16(
        avx2: Avx2,
        keys: &[u32],
        hits: u32,
        links: &[u32],
        to_keys: &mut [u32],
        to_links: &mut [u32],
    ) {
        let mut front = [0_u32; 16];
        let (mut lanes, mut count) = (hits, 0);
        while lanes != 0 && count < 8 {
            front[count] = keys[lanes.trailing_zeros() as usize & 15];
            lanes &= lanes - 1;
            count += 1;
        }
        let sorted = sort8(avx2, u32x8::from_slice(avx2, &front[..8]).into(), (1 << count) - 1);
        let sorted: u32x8<_> = sorted.simd_into(avx2);
        sorted.store_slice(&mut front[..8]);
        while lanes != 0 {
            insert(&mut front, count, keys[lanes.trailing_zeros() as usize & 15]);
            lanes &= lanes - 1;
            count += 1;
        }
        to_keys.copy_from_slice(&front);
        for (link, key) in to_links.iter_mut().zip(&front[..count]) {
            *link = links[(key & LANE) as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simd::{Isa, vectorized};

    fn check<const W: usize>(isa: Isa, distances: &[Option<f32>]) {
        let mut keys = [0; W];
        let mut hits = 0;
        for (lane, distance) in distances.iter().take(W).enumerate() {
            if let Some(t) = distance {
                keys[lane] = (t.to_bits() & !LANE | lane as u32) + BIAS;
                hits |= 1 << lane;
            }
        }
        let links: [u32; W] = std::array::from_fn(|lane| 1000 + lane as u32);
        let (mut to_keys, mut to_links) = ([7; W], [7; W]);
        let level = isa.level().expect("available");
        vectorized!(level, simd => store_keys::<true, _, W>(
            simd, keys, hits, &links, &mut to_keys, &mut to_links
        ));
        let mut expected: Vec<u32> = keys.iter().copied().filter(|&key| key != 0).collect();
        expected.sort_unstable_by(|a, b| b.cmp(a));
        assert_eq!(to_keys[..expected.len()], expected, "{isa} {W}");
        for (key, link) in expected.iter().zip(to_links) {
            assert_eq!(link, 1000 + (key & LANE), "{isa} {W}");
        }
        vectorized!(level, simd => store_keys::<false, _, W>(
            simd, keys, hits, &links, &mut to_keys, &mut to_links
        ));
        for (key, link) in to_keys.iter().zip(to_links).take(expected.len()) {
            assert_eq!(link, 1000 + (key & LANE), "{isa} {W}");
        }
        to_keys[..expected.len()].sort_unstable_by(|a, b| b.cmp(a));
        assert_eq!(to_keys[..expected.len()], expected, "{isa} {W}");
        // From the last lane to the first.
        let list = (0..W).fold(0, |list, lane| list << 4 | lane as u64);
        vectorized!(level, simd => store_listed::<_, W>(
            simd, keys, list, &links, &mut to_keys, &mut to_links
        ));
        let expected: Vec<u32> = keys.iter().rev().copied().filter(|&key| key != 0).collect();
        assert_eq!(to_keys[..expected.len()], expected, "{isa} {W}");
        for (key, link) in expected.iter().zip(to_links) {
            assert_eq!(link, 1000 + (key & LANE), "{isa} {W}");
        }
    }

    proptest! {
        #[test]
        fn keys_come_out_farthest_first(
            distances in proptest::collection::vec(
                proptest::option::of(prop_oneof![Just(0.0_f32), Just(1.0), 0.0_f32..1e9]), 16)
        ) {
            for isa in Isa::available() {
                check::<4>(isa, &distances);
                check::<8>(isa, &distances);
                check::<16>(isa, &distances);
            }
        }
    }

    #[test]
    fn a_zero_with_a_sign_is_the_smallest_distance() {
        let key = |t: f32| (t.to_bits() & DISTANCE) + BIAS;
        assert_eq!(key(-0.0), key(0.0));
        assert!(key(-0.0) <= key_limit(0.0) && key(-0.0) != 0);
    }

    #[test]
    fn a_limit_passes_what_is_not_farther() {
        for t in [0.0_f32, 1e-30, 1.0, 1.0 + f32::EPSILON, 3e38, f32::INFINITY] {
            let key = (t.to_bits() & !LANE | LANE) + BIAS;
            assert!(key <= key_limit(t));
            assert!(
                (t * 1.001 + 1e-40).to_bits() & !LANE == t.to_bits() & !LANE
                    || ((t * 1.001 + 1e-30).to_bits() & !LANE) + BIAS > key_limit(t)
            );
        }
    }
}
