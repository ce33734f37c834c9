//! Lights that were sampled, in lanes.

use crate::simd::lanes::{Lanes, Mask, Vec3f};

/// A light chosen for each lane, and a direction to it; see [`super::super::LightSample`].
#[derive(Clone, Copy)]
pub struct LightSamples<L: Lanes> {
    /// Unit direction towards the light.
    pub direction: Vec3f<L>,
    /// Radiance that arrives if nothing is in between; irradiance where `delta`.
    pub radiance: Vec3f<L>,
    /// Density over solid angle, or the light's probability where `delta`; times one another.
    pub pdf: L::Float,
    /// Where the light has no extent, so that no other strategy could find it.
    pub delta: L::Mask,
    /// The end of the segment that must be free; its direction where the light is far.
    pub end: Vec3f<L>,
    /// Where the light is infinitely far.
    pub far: L::Mask,
    /// Where light may arrive.
    pub valid: L::Mask,
}

impl<L: Lanes> LightSamples<L> {
    /// `a` where the mask is true, else `b`.
    #[inline(always)]
    pub fn select(mask: L::Mask, a: &Self, b: &Self) -> Self {
        Self {
            direction: Vec3f::select(mask, a.direction, b.direction),
            radiance: Vec3f::select(mask, a.radiance, b.radiance),
            pdf: mask.select(a.pdf, b.pdf),
            delta: (mask & a.delta) | (!mask & b.delta),
            end: Vec3f::select(mask, a.end, b.end),
            far: (mask & a.far) | (!mask & b.far),
            valid: (mask & a.valid) | (!mask & b.valid),
        }
    }
}
