//! Rays in lanes, checked before they are made.

use crate::math::Ray;
use crate::simd::lanes::{Float, Lanes, Vec3f};

/// Where rays can be traced; see [`Ray::new`].
#[inline(always)]
pub fn are_usable<L: Lanes>(lanes: L, origin: Vec3f<L>, direction: Vec3f<L>) -> L::Mask {
    let Vec3f { x, y, z } = direction.abs();
    let longest = x.most(y).most(z);
    let [least, most] = Ray::DIRECTION_RANGE;
    origin.is_finite(lanes)
        & direction.is_finite(lanes)
        & lanes.float(least).le(longest)
        & longest.le(lanes.float(most))
}
