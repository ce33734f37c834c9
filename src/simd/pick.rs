//! Lanes picked out of a vector by numbers that are known at run time only.

use fearless_simd::{Simd, SimdBase, f32x8, u32x8};

/// Of each lane's number, modulo eight, the value in that lane.
#[inline(always)]
pub fn pick<S: Simd>(simd: S, values: f32x8<S>, lanes: u32x8<S>) -> f32x8<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        return x86::pick(simd, avx2, values, lanes);
    }
    let (values, lanes) = (values.to_array(), lanes.to_array());
    f32x8::from_fn(simd, |i| values[lanes[i] as usize % 8])
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use fearless_simd::{Avx2, Simd, SimdBase, SimdInto, f32x8, u32x8};

    #[inline(always)]
    pub fn pick<S: Simd>(simd: S, avx2: Avx2, values: f32x8<S>, lanes: u32x8<S>) -> f32x8<S> {
        // Vectors of one token become those of another by way of arrays, which costs nothing.
        let values = f32x8::load_array(avx2, values.to_array());
        let lanes = u32x8::load_array(avx2, lanes.to_array());
        let picked: f32x8<Avx2> = permute(avx2, values.into(), lanes.into()).simd_into(avx2);
        f32x8::load_array(simd, picked.to_array())
    }

    fearless_simd::kernel!(
        #[inline(always)]
        fn permute(avx2: Avx2, values: __m256, lanes: __m256i) -> __m256 {
            _mm256_permutevar8x32_ps(values, lanes)
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Isa, vectorized};

    #[test]
    fn lanes_are_taken_modulo_eight() {
        for isa in Isa::available() {
            let level = isa.level().expect("available");
            let picked = vectorized!(level, simd => {
                let values = f32x8::from_fn(simd, |lane| lane as f32);
                pick(simd, values, u32x8::from_fn(simd, |i| [7, 0, 3, 11, 5, 8, 1, 0xffff_fff2][i]))
                    .to_array()
            });
            assert_eq!(picked, [7.0, 0.0, 3.0, 3.0, 5.0, 0.0, 1.0, 2.0], "{isa}");
        }
    }
}
