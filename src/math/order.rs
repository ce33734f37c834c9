//! The larger and the smaller of two numbers, neither of which is NaN.
//!
//! One instruction each, where `f32::max` and `f32::min` take three for what they promise about
//! NaN. Of two zeros of different sign either may come out.

/// The larger.
#[inline(always)]
pub fn larger<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// The smaller.
#[inline(always)]
pub fn smaller<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}
