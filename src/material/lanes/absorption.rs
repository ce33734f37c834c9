//! What the inside of a solid leaves of light, in lanes.

use crate::simd::lanes::{Lanes, Vec3f, pow};

/// What is left of white light after `distances`, of which one leaves `color` (Beer's law).
#[inline(always)]
pub fn transmittance<L: Lanes>(lanes: L, color: Vec3f<L>, distances: L::Float) -> Vec3f<L> {
    color.map(
        #[inline(always)]
        |color| pow(lanes, color, distances),
    )
}
