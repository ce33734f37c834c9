//! Sampled directions, and what all BSDFs share in drawing them.

use crate::math::Vec3;

/// A direction drawn by [`Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Towards the light; unit, local.
    pub wi: Vec3,
    /// `f * |cos wi| / pdf`.
    pub weight: Vec3,
    /// Density per solid angle, over all lobes; for a delta lobe the probability of choosing it.
    pub pdf: f32,
    /// Whether the direction was the only one that it could be, so that no light can be sampled
    /// towards it.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 but for light that
    /// enters or leaves a solid. Russian roulette takes the radiance's scaling out with it.
    pub eta: f32,
}

/// Whether a direction of that cosine scatters: not within 1e-7 of the tangent plane, where half
/// vectors lose all of their bits (the light so lost is some 1e-14 of a diffuse surface's), and
/// not if it is NaN.
#[inline]
pub fn is_above(cos: f32) -> bool {
    cos > 1e-7
}

/// The mean of the channels: what lobes are chosen by.
#[inline]
pub fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}
