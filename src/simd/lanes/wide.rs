//! Eight and sixteen lanes: vectors of an instruction set.

use fearless_simd::{
    Bytes, Select, Simd, SimdBase, SimdFloat, SimdInt, SimdMask, f32x8, f32x16, i32x8, i32x16,
    mask32x8, mask32x16, u32x8, u32x16,
};

use super::traits::{Float, Lanes, MAX_LANES, Mask, Rows, Uint};

// Closures bound by `let` are not inlined, and would make calls of the operations in them.

/// Exchanges the bits of `$low` with those `$by` places above.
macro_rules! swap {
    ($x:expr, $by:literal, $low:literal) => {
        (($x >> $by) & $low) | (($x & $low) << $by)
    };
}

/// Four vectors in a row.
macro_rules! load {
    ($float:ident $width:literal, $simd:expr, $flat:expr) => {{
        let flat = &$flat[..4 * $width];
        [
            $float::from_slice($simd, &flat[..$width]),
            $float::from_slice($simd, &flat[$width..2 * $width]),
            $float::from_slice($simd, &flat[2 * $width..3 * $width]),
            $float::from_slice($simd, &flat[3 * $width..]),
        ]
    }};
}

macro_rules! lanes {
    ($name:ident $width:literal $float:ident $int:ident $uint:ident $mask:ident) => {
        #[doc = concat!("The ", stringify!($width), " lanes of an instruction set.")]
        #[derive(Clone, Copy, Debug)]
        pub struct $name<S>(pub S);

        impl<S: Simd> Lanes for $name<S> {
            const WIDTH: usize = $width;
            type Float = $float<S>;
            type Uint = $uint<S>;
            type Mask = $mask<S>;

            #[inline(always)]
            fn float(self, x: f32) -> $float<S> {
                $float::splat(self.0, x)
            }

            #[inline(always)]
            fn uint(self, x: u32) -> $uint<S> {
                $uint::splat(self.0, x)
            }

            #[inline(always)]
            fn load(self, x: &[f32; MAX_LANES]) -> $float<S> {
                $float::from_slice(self.0, &x[..$width])
            }

            #[inline(always)]
            fn mask(self, bits: u32) -> $mask<S> {
                $mask::from_bitmask(self.0, u64::from(bits) & ((1 << $width) - 1))
            }

            #[inline(always)]
            fn columns(self, rows: &Rows) -> [$float<S>; 4] {
                let [a, b, c, d] = load!($float $width, self.0, rows.as_flattened());
                let (even, odd) = a.deinterleave(b);
                let (even_after, odd_after) = c.deinterleave(d);
                let (x, z) = even.deinterleave(even_after);
                let (y, w) = odd.deinterleave(odd_after);
                [x, y, z, w]
            }

            #[inline(always)]
            fn rows(self, [x, y, z, w]: [$float<S>; 4], rows: &mut Rows) {
                let (even, even_after) = x.interleave(z);
                let (odd, odd_after) = y.interleave(w);
                let (a, b) = even.interleave(odd);
                let (c, d) = even_after.interleave(odd_after);
                let flat = &mut rows.as_flattened_mut()[..4 * $width];
                a.store_slice(&mut flat[..$width]);
                b.store_slice(&mut flat[$width..2 * $width]);
                c.store_slice(&mut flat[2 * $width..3 * $width]);
                d.store_slice(&mut flat[3 * $width..]);
            }
        }

        impl<S: Simd> Float<$name<S>> for $float<S> {
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }

            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }

            #[inline(always)]
            fn lt(self, other: Self) -> $mask<S> {
                self.simd_lt(other)
            }

            #[inline(always)]
            fn le(self, other: Self) -> $mask<S> {
                self.simd_le(other)
            }

            #[inline(always)]
            fn eq(self, other: Self) -> $mask<S> {
                self.simd_eq(other)
            }

            #[inline(always)]
            fn least(self, other: Self) -> Self {
                Select::select(self.simd_lt(other), self, other)
            }

            #[inline(always)]
            fn most(self, other: Self) -> Self {
                Select::select(self.simd_gt(other), self, other)
            }

            #[inline(always)]
            fn to_bits(self) -> $uint<S> {
                SimdFloat::to_bits(self)
            }

            #[inline(always)]
            fn to_int(self) -> $uint<S> {
                let whole: $int<S> = SimdFloat::to_int(self);
                whole.bitcast()
            }
        }

        impl<S: Simd> Uint<$name<S>> for $uint<S> {
            #[inline(always)]
            fn to_float(self) -> $float<S> {
                let signed: $int<S> = self.bitcast();
                SimdInt::to_float(signed)
            }

            #[inline(always)]
            fn to_float_bits(self) -> $float<S> {
                self.bitcast()
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                SimdBase::min(self, other)
            }

            #[inline(always)]
            fn eq(self, other: u32) -> $mask<S> {
                self.simd_eq(other)
            }

            #[inline(always)]
            fn reverse_bits(self) -> Self {
                let x = swap!(self, 1, 0x5555_5555);
                let x = swap!(x, 2, 0x3333_3333);
                let x = swap!(x, 4, 0x0f0f_0f0f);
                let x = swap!(x, 8, 0x00ff_00ff);
                (x >> 16) | (x << 16)
            }

            #[inline(always)]
            fn store(self, to: &mut [u32; MAX_LANES]) {
                self.store_slice(&mut to[..$width]);
            }
        }

        impl<S: Simd> Mask<$name<S>> for $mask<S> {
            #[inline(always)]
            fn select(self, a: $float<S>, b: $float<S>) -> $float<S> {
                Select::select(self, a, b)
            }

            #[inline(always)]
            fn select_uint(self, a: $uint<S>, b: $uint<S>) -> $uint<S> {
                Select::select(self, a, b)
            }

            #[inline(always)]
            fn to_bits(self) -> u32 {
                self.to_bitmask() as u32
            }
        }
    };
}

lanes! { Lanes8 8 f32x8 i32x8 u32x8 mask32x8 }
lanes! { Lanes16 16 f32x16 i32x16 u32x16 mask32x16 }
