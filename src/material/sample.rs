//! Sampled directions, and what all BSDFs share in drawing them.

use crate::math::Vec3;

/// A direction sampled by [`super::Bsdf::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BsdfSample {
    /// Towards the light; unit, local.
    pub wi: Vec3,
    /// `f * |cos wi| / pdf`.
    pub weight: Vec3,
    /// Density per solid angle, over all lobes; for a delta lobe the probability of the lobe.
    pub pdf: f32,
    /// Whether a delta lobe was sampled, so that no light can be sampled in that direction.
    pub delta: bool,
    /// Index of refraction on the side of `wi` over that on the side of `wo`: 1 but for light that
    /// enters or leaves a solid. Russian roulette takes the radiance's scaling out with it.
    pub eta: f32,
}

impl BsdfSample {
    /// A sample of what is no delta lobe, from its value times the cosine and its density; `None`
    /// where the density is zero.
    #[inline(always)]
    pub fn from_value(wi: Vec3, value: Vec3, pdf: f32, eta: f32) -> Option<Self> {
        let sample = Self { wi, weight: value / pdf, pdf, delta: false, eta };
        (pdf > 0.0).then_some(sample)
    }
}

/// Whether a direction of that cosine scatters: not within 1e-7 of the tangent plane, where half
/// vectors lose all of their bits (the light so lost is some 1e-14 of a diffuse surface's), and
/// not if it is NaN.
#[inline]
pub fn is_above(cos: f32) -> bool {
    cos > 1e-7
}

/// The mean of the channels, by which lobes are weighed when one is sampled.
#[inline]
pub fn mean(color: Vec3) -> f32 {
    (color.x + color.y + color.z) * (1.0 / 3.0)
}
