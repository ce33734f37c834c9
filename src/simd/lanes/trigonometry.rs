//! Sine, cosine and arcus tangent in lanes, by the polynomials of Cephes.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use super::traits::{Float, Lanes, Mask, Uint};

/// Sine and cosine of an angle within ±π/4, to 1e-7.
#[inline(always)]
pub fn sin_cos_eighth<L: Lanes>(angle: L::Float) -> (L::Float, L::Float) {
    let z = angle * angle;
    let sin = ((z * -1.951_529_6e-4 + 8.332_161e-3) * z - 1.666_665_5e-1) * z * angle + angle;
    let cos = (z * 2.443_315_7e-5 - 1.388_731_6e-3) * z + 4.166_664_6e-2;
    (sin, cos * z * z - z * 0.5 + 1.0)
}

/// Cosine and sine at `turns` of a full turn, to 1.5e-7; for turns within ±1000.
///
/// The quadrant is exact in `turns`, and so is what remains: near the axes, the coordinate that
/// vanishes there is exact to a few units in its last place.
#[inline(always)]
pub fn unit_circle<L: Lanes>(turns: L::Float) -> (L::Float, L::Float) {
    let quarters = turns * 4.0;
    let nearest = (quarters + 0.5).floor();
    let (sin, cos) = sin_cos_eighth::<L>((quarters - nearest) * FRAC_PI_2);
    let quadrant = nearest.to_int();
    let even = (quadrant & 1).eq(0);
    let (x, y) = (even.select(cos, sin), even.select(sin, cos));
    (x.flip((quadrant + 1) << 30), y.flip(quadrant << 30))
}

/// The angle of the point (`x`, `y`) from the axis of `x`, within ±π, to 3e-7. The angle of the
/// origin is 0.
#[inline(always)]
pub fn atan2<L: Lanes>(lanes: L, y: L::Float, x: L::Float) -> L::Float {
    let (across, up) = (x.abs(), y.abs());
    let steep = up.gt(across);
    let (least, most) = (steep.select(across, up), steep.select(up, across));
    // The floor keeps the origin off 0 / 0; 2^-126 is the least normal number.
    let slope = least / most.most(lanes.float(f32::MIN_POSITIVE));
    let beyond = slope.gt(lanes.float(0.414_213_57)); // tan(π/8)
    let t = beyond.select((slope - 1.0) / (slope + 1.0), slope);
    let z = t * t;
    let p = ((z * 8.053_744_5e-2 - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1;
    let angle = p * z * t + t;
    let angle = beyond.select(angle + FRAC_PI_4, angle);
    let angle = steep.select(lanes.float(FRAC_PI_2) - angle, angle);
    let angle = x.lt(lanes.float(0.0)).select(lanes.float(PI) - angle, angle);
    angle.copysign(y)
}
