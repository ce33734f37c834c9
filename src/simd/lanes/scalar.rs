//! A single lane: plain numbers.

use std::ops::{Add, BitAnd, BitOr, BitXor, Mul, Shl, Shr, Sub};

use super::traits::{Float, Lanes, MAX_LANES, Mask, Rows, Uint};

/// One number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalar;

/// An integer that wraps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wrapping(pub u32);

impl From<u32> for Wrapping {
    #[inline(always)]
    fn from(x: u32) -> Self {
        Self(x)
    }
}

impl Lanes for Scalar {
    const WIDTH: usize = 1;
    type Float = f32;
    type Uint = Wrapping;
    type Mask = bool;

    #[inline(always)]
    fn float(self, x: f32) -> f32 {
        x
    }

    #[inline(always)]
    fn uint(self, x: u32) -> Wrapping {
        Wrapping(x)
    }

    #[inline(always)]
    fn load(self, x: &[f32; MAX_LANES]) -> f32 {
        x[0]
    }

    #[inline(always)]
    fn mask(self, bits: u32) -> bool {
        bits & 1 != 0
    }

    #[inline(always)]
    fn columns(self, rows: &Rows) -> [f32; 4] {
        rows[0]
    }

    #[inline(always)]
    fn gather(self, place: Wrapping, row: impl Fn(usize) -> [f32; 4]) -> [f32; 4] {
        row(place.0 as usize)
    }

    #[inline(always)]
    fn rows(self, columns: [f32; 4], rows: &mut Rows) {
        rows[0] = columns;
    }
}

impl Float<Scalar> for f32 {
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        f32::floor(self)
    }

    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }

    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }

    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn most(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn to_bits(self) -> Wrapping {
        Wrapping(f32::to_bits(self))
    }

    #[inline(always)]
    fn to_int(self) -> Wrapping {
        Wrapping(self as i32 as u32)
    }
}

impl Uint<Scalar> for Wrapping {
    #[inline(always)]
    fn to_float(self) -> f32 {
        self.0 as i32 as f32
    }

    #[inline(always)]
    fn to_float_bits(self) -> f32 {
        f32::from_bits(self.0)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(Ord::min(self.0, other.0))
    }

    #[inline(always)]
    fn eq(self, other: u32) -> bool {
        self.0 == other
    }

    #[inline(always)]
    fn reverse_bits(self) -> Self {
        Self(self.0.reverse_bits())
    }

    #[inline(always)]
    fn store(self, to: &mut [u32; MAX_LANES]) {
        to[0] = self.0;
    }
}

impl Mask<Scalar> for bool {
    #[inline(always)]
    fn select(self, a: f32, b: f32) -> f32 {
        if self { a } else { b }
    }

    #[inline(always)]
    fn select_uint(self, a: Wrapping, b: Wrapping) -> Wrapping {
        if self { a } else { b }
    }

    #[inline(always)]
    fn to_bits(self) -> u32 {
        u32::from(self)
    }
}

macro_rules! wrapping {
    ($($trait:ident $method:ident ($a:ident, $b:ident) $value:expr;)*) => { $(
        impl $trait for Wrapping {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.$method(other.0)
            }
        }

        impl $trait<u32> for Wrapping {
            type Output = Self;

            #[inline(always)]
            fn $method(self, $b: u32) -> Self {
                let $a = self.0;
                Self($value)
            }
        }
    )* };
}

wrapping! {
    Add add (a, b) a.wrapping_add(b);
    Sub sub (a, b) a.wrapping_sub(b);
    Mul mul (a, b) a.wrapping_mul(b);
    BitXor bitxor (a, b) a ^ b;
    BitAnd bitand (a, b) a & b;
    BitOr bitor (a, b) a | b;
    Shl shl (a, b) a << (b & 31);
    Shr shr (a, b) a >> (b & 31);
}
