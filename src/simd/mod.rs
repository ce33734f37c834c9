//! The instruction sets: the only place that names them.

pub mod lanes;
pub mod order;
mod pick;
mod prefetch;
mod vectors;

use fearless_simd::Level;

use crate::names::choices;

pub use pick::pick;
pub use prefetch::prefetch;
pub use vectors::{Vectors, Width};

/// An instruction set to compute with; never changes a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Isa {
    /// The best that the CPU has.
    #[default]
    Auto,
    /// What every CPU of the target has.
    Portable,
    /// 128 bits.
    Sse2,
    /// 128 bits.
    Sse42,
    /// 256 bits.
    Avx2,
    /// 512 bits.
    Avx512,
}

choices!(Isa, "instruction set", [
    Auto => "auto",
    Portable => "portable",
    Sse2 => "sse2",
    Sse42 => "sse4.2",
    Avx2 => "avx2",
    Avx512 => "avx512",
]);

impl Isa {
    /// The token that unlocks its instructions; `None` if this CPU lacks them.
    pub fn level(self) -> Option<Level> {
        let best = Level::new();
        match self {
            Self::Auto => Some(best),
            Self::Portable => Some(Level::fallback()),
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => best.as_sse2().map(Level::Sse2),
            #[cfg(target_arch = "x86_64")]
            Self::Sse42 => best.as_sse4_2().map(Level::Sse4_2),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => best.as_avx2().map(Level::Avx2),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => best.as_avx512().map(Level::Avx512),
            #[cfg(not(target_arch = "x86_64"))]
            _ => None,
        }
    }

    /// Those that this CPU has, `Auto` aside.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().skip(1).filter(|isa| isa.level().is_some())
    }
}

/// The token of what every CPU of the target has: SSE2 on x86-64. (Vectors emulated by plain code
/// would take the compiler many times as long.)
#[cfg(target_arch = "x86_64")]
#[inline(always)]
pub fn baseline() -> impl fearless_simd::Simd {
    Level::new().as_sse2().expect("x86-64 has SSE2")
}

/// The token of what every CPU of the target has: plain code.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
pub fn baseline() -> impl fearless_simd::Simd {
    match Level::fallback() {
        Level::Fallback(simd) => simd,
        _ => unreachable!("the fallback is the fallback"),
    }
}

/// Whether code for this token is worth a loop of its own: not for the [`baseline`].
#[inline(always)]
pub fn is_wide<S: fearless_simd::Simd>(simd: S) -> bool {
    match simd.level() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(_) | Level::Avx512(_) => true,
        #[cfg(target_arch = "aarch64")]
        Level::Neon(_) => true,
        _ => false,
    }
}

/// Runs `$op` compiled for the instruction set of `$level`, with `$simd` as its token.
///
/// Compiled three times only, since each time costs seconds of building and kilobytes of binary:
/// for AVX-512, for AVX2, and for the target's [`baseline`], which also stands in for the sets
/// between.
macro_rules! vectorized {
    ($level:expr, $simd:ident => $op:expr) => {{
        #[allow(unused_imports)]
        use fearless_simd::{Level, Simd};
        match $level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512($simd) => $simd.vectorize(
                #[inline(always)]
                || $op,
            ),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2($simd) => $simd.vectorize(
                #[inline(always)]
                || $op,
            ),
            #[cfg(target_arch = "aarch64")]
            Level::Neon($simd) => $simd.vectorize(
                #[inline(always)]
                || $op,
            ),
            _ => {
                let $simd = crate::simd::baseline();
                $op
            }
        }
    }};
}

/// Runs `$op` compiled for the instruction set of `$level`, with `$lanes` as the numbers that it
/// has side by side: as many as its vectors hold, or two vectors where those are shorter than 512
/// bits. Two hide each other's latency: shading is a sixth faster by them.
macro_rules! in_lanes {
    ($level:expr, $lanes:ident => $op:expr) => {{
        #[allow(unused_imports)]
        use fearless_simd::{Level, Simd};
        match $level {
            #[cfg(target_arch = "x86_64")]
            Level::Avx512(simd) => simd.vectorize(
                #[inline(always)]
                || {
                    let $lanes = crate::simd::lanes::Lanes16(simd);
                    $op
                },
            ),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2(simd) => simd.vectorize(
                #[inline(always)]
                || {
                    let $lanes = crate::simd::lanes::Lanes16(simd);
                    $op
                },
            ),
            #[cfg(target_arch = "aarch64")]
            Level::Neon(simd) => simd.vectorize(
                #[inline(always)]
                || {
                    let $lanes = crate::simd::lanes::Lanes8(simd);
                    $op
                },
            ),
            _ => {
                let $lanes = crate::simd::lanes::Lanes8(crate::simd::baseline());
                $op
            }
        }
    }};
}

pub(crate) use in_lanes;
pub(crate) use vectorized;
