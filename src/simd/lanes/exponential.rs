//! Exponential, logarithm and power in lanes, by the polynomials of Cephes.

use std::f32::consts::{LOG2_E, SQRT_2};

use super::traits::{Float, Lanes, Mask, Uint};

/// e to the power of `x`, to 2e-7 of itself where that is a normal number; 0 and infinity beyond
/// what f32 holds.
#[inline(always)]
pub fn exp<L: Lanes>(lanes: L, x: L::Float) -> L::Float {
    // NaN passes both comparisons. Beyond these bounds the result is 0 or infinity.
    let x = lanes.float(89.0).least(lanes.float(-105.0).most(x));
    let twos = (x * LOG2_E + 0.5).floor();
    // ln 2 in two parts, so that the first product is exact.
    let r = x - twos * 0.693_359_4 + twos * 2.121_944_4e-4;
    let p = (r * 1.987_569_2e-4 + 1.398_2e-3) * r + 8.333_452e-3;
    let p = ((p * r + 4.166_579_6e-2) * r + 1.666_666_5e-1) * r + 0.5;
    // The power of two in two factors, for results that have no implied digit.
    let twos = twos.to_int();
    let sign = lanes.uint(0) - (twos >> 31);
    let half = (twos >> 1) | (sign << 31);
    let power = |n: L::Uint| ((n + 127) << 23).to_float_bits();
    (p * r * r + r + 1.0) * power(half) * power(twos - half)
}

/// The natural logarithm, to 1e-7 of itself or 1e-7, whichever is more. That of 0 is minus
/// infinity, that of a negative number NaN.
#[inline(always)]
pub fn ln<L: Lanes>(lanes: L, x: L::Float) -> L::Float {
    // Numbers without an implied digit are taken 2^24 times as large.
    let small = x.lt(lanes.float(f32::MIN_POSITIVE));
    let scaled = small.select(x * 16_777_216.0, x).to_bits();
    let twos = (scaled >> 23).to_float() - small.select(lanes.float(150.0), lanes.float(126.0));
    let m = ((scaled & 0x007f_ffff) | 0x3f00_0000).to_float_bits(); // from 1/2 to 1
    let low = m.lt(lanes.float(0.5 * SQRT_2));
    let twos = low.select(twos - 1.0, twos);
    let m = low.select(m + m, m) - 1.0;
    let p = (m * 7.037_683_6e-2 - 1.151_461e-1) * m + 1.167_699_9e-1;
    let p = ((p * m - 1.242_014_1e-1) * m + 1.424_932_3e-1) * m - 1.666_805_8e-1;
    let p = ((p * m + 2.000_071_5e-1) * m - 2.499_999_4e-1) * m + 3.333_333e-1;
    let z = m * m;
    let tail = p * z * m - twos * 2.121_944_4e-4 - z * 0.5;
    let ln = m + tail + twos * 0.693_359_4;
    let zero = lanes.float(0.0);
    let ln = x.lt(lanes.float(f32::INFINITY)).select(ln, x); // infinity and NaN are their own
    let ln = x.eq(zero).select(lanes.float(f32::NEG_INFINITY), ln);
    x.lt(zero).select(lanes.float(f32::NAN), ln)
}

/// `x` to the power of `y`, for `x` not below 0; its error is that of [`exp`], and 1.5e-7 of itself
/// for each unit of its logarithm: less than 2e-5 of it in all. Anything to the
/// power of 0 is 1, and so is 1 to the power of anything.
#[inline(always)]
pub fn pow<L: Lanes>(lanes: L, x: L::Float, y: L::Float) -> L::Float {
    let power = exp(lanes, ln(lanes, x) * y);
    let one = lanes.float(1.0);
    (x.eq(one) | y.eq(lanes.float(0.0))).select(one, power)
}
