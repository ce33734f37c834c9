//! What a count of lanes is, and what can be done with its numbers.

use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Shl, Shr, Sub};

/// The most lanes that there are.
pub const MAX_LANES: usize = 16;

/// Four numbers of each lane.
pub type Rows = [[f32; 4]; MAX_LANES];

/// A count of numbers that are computed with side by side.
pub trait Lanes: Copy {
    /// How many.
    const WIDTH: usize;
    /// A number a lane.
    type Float: Float<Self>;
    /// An integer of 32 bits a lane, which wraps.
    type Uint: Uint<Self>;
    /// A truth a lane.
    type Mask: Mask<Self>;

    /// The same number in all lanes.
    fn float(self, x: f32) -> Self::Float;

    /// The same integer in all lanes.
    fn uint(self, x: u32) -> Self::Uint;

    /// The first numbers of a slice, one a lane.
    fn load(self, x: &[f32; MAX_LANES]) -> Self::Float;

    /// True where the lane's bit is set, the first lane's lowest.
    fn mask(self, bits: u32) -> Self::Mask;

    /// The lanes before lane number `count`.
    #[inline(always)]
    fn first(self, count: usize) -> Self::Mask {
        self.mask(((1_u64 << count) - 1) as u32)
    }

    /// Rows of four a lane, as four columns.
    fn columns(self, rows: &Rows) -> [Self::Float; 4];

    /// The row at each lane's place, as four columns: a plain load a lane costs less than gathering
    /// number by number.
    #[inline(always)]
    fn gather(self, places: Self::Uint, row: impl Fn(usize) -> [f32; 4]) -> [Self::Float; 4] {
        let (mut at, mut rows) = ([0; MAX_LANES], Rows::default());
        places.store(&mut at);
        for lane in 0..Self::WIDTH {
            rows[lane] = row(at[lane] as usize);
        }
        self.columns(&rows)
    }

    /// Four columns, as a row of four a lane; the inverse of [`Lanes::columns`].
    fn rows(self, columns: [Self::Float; 4], rows: &mut Rows);
}

/// Numbers of [`Lanes`].
pub trait Float<L: Lanes>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f32, Output = Self>
    + Sub<f32, Output = Self>
    + Mul<f32, Output = Self>
    + Div<f32, Output = Self>
{
    /// The square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Without its sign.
    fn abs(self) -> Self;
    /// The largest whole number that is not above it.
    fn floor(self) -> Self;
    /// Whether it is below `other`.
    fn lt(self, other: Self) -> L::Mask;
    /// Whether it is not above `other`.
    fn le(self, other: Self) -> L::Mask;
    /// Whether both are equal.
    fn eq(self, other: Self) -> L::Mask;
    /// This if it is below `other`, else `other`: also where either is NaN.
    fn least(self, other: Self) -> Self;
    /// This if it is above `other`, else `other`: also where either is NaN.
    fn most(self, other: Self) -> Self;
    /// Its bits.
    fn to_bits(self) -> L::Uint;
    /// Its whole part, towards zero; within the range of i32.
    fn to_int(self) -> L::Uint;

    /// Whether it is above `other`.
    #[inline(always)]
    fn gt(self, other: Self) -> L::Mask {
        other.lt(self)
    }

    /// This, with its sign turned where the highest bit of `sign` is set.
    #[inline(always)]
    fn flip(self, sign: L::Uint) -> L::Float {
        (self.to_bits() ^ (sign & SIGN)).to_float_bits()
    }

    /// The magnitude of this and the sign of `other`.
    #[inline(always)]
    fn copysign(self, other: Self) -> L::Float {
        (self.abs().to_bits() | (other.to_bits() & SIGN)).to_float_bits()
    }
}

/// The bit of a number that holds its sign.
pub const SIGN: u32 = 0x8000_0000;

/// Integers of [`Lanes`].
pub trait Uint<L: Lanes>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitXor<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + Add<u32, Output = Self>
    + Mul<u32, Output = Self>
    + BitXor<u32, Output = Self>
    + BitAnd<u32, Output = Self>
    + BitOr<u32, Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// The number, taken as an i32.
    fn to_float(self) -> L::Float;
    /// The number whose bits these are.
    fn to_float_bits(self) -> L::Float;
    /// The lesser of two.
    fn min(self, other: Self) -> Self;
    /// Whether it is `other`.
    fn eq(self, other: u32) -> L::Mask;
    /// The bits in reverse.
    fn reverse_bits(self) -> Self;
    /// One integer a lane, into the first places.
    fn store(self, to: &mut [u32; MAX_LANES]);
}

/// Truths of [`Lanes`].
pub trait Mask<L: Lanes>:
    Copy + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// `a` where it is true, else `b`.
    fn select(self, a: L::Float, b: L::Float) -> L::Float;
    /// The same of integers.
    fn select_uint(self, a: L::Uint, b: L::Uint) -> L::Uint;
    /// A bit a lane, the first lane lowest.
    fn to_bits(self) -> u32;
}
