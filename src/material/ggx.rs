//! The GGX distribution of microfacets, with separable Smith shadowing.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. Directions
//! are above the surface.

use std::f32::consts::FRAC_1_PI;

use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// The distribution of normals at the unit vector `h`, for `alpha2` = alpha squared.
///
/// Sines come from x and y: from `1 - z²` a peak of alpha 0.001 would keep one digit.
#[inline]
pub fn distribution(h: Vec3, alpha2: f32) -> f32 {
    let t = h.x * h.x + h.y * h.y + alpha2 * h.z * h.z;
    alpha2 * FRAC_1_PI / (t * t)
}

/// Smith's masking over twice the cosine: `G1(cos) / (2 cos)`, finite at the horizon. The product
/// for both directions is glTF's separable visibility term V.
#[inline]
pub fn half_masking(cos: f32, alpha2: f32) -> f32 {
    1.0 / (cos + (alpha2 + (1.0 - alpha2) * cos * cos).sqrt())
}

/// Smith's masking `G1(cos)`.
#[inline]
pub fn masking(cos: f32, alpha2: f32) -> f32 {
    2.0 * cos * half_masking(cos, alpha2)
}

/// A normal as seen from `wo`, whose `z >= 0`: density `D(h) G1(wo) max(0, wo.h) / wo.z`.
///
/// Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023.
#[inline]
pub fn sample_visible_normal(wo: Vec3, alpha: f32, u: Vec2) -> Vec3 {
    let stretched = Vec3::new(wo.x * alpha, wo.y * alpha, wo.z).normalize();
    // A point of the cap that reflects into the upper hemisphere of the stretched space.
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let ring = warp::unit_circle(u.x) * (1.0 - z * z).max(0.0).sqrt();
    let h = Vec3::new(ring.x, ring.y, z) + stretched;
    // The floor keeps the one point where both cancel off 0 / 0.
    Vec3::new(h.x * alpha, h.y * alpha, h.z.max(1e-12)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Projected onto any plane, the visible microfacets cover as much as the surface does.
    #[test]
    fn normals_project_to_the_surface() {
        for alpha in [0.05_f32, 0.3, 1.0] {
            for cos in [1.0_f32, 0.6, 0.2] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let (mut flat, mut seen) = (0.0_f64, 0.0_f64);
                let (rings, sectors) = (4000, 64);
                for ring in 0..rings {
                    // Squared, to put points where the peak is.
                    let t = (ring as f32 + 0.5) / rings as f32;
                    let (z, dz) = (1.0 - t * t * t, 3.0 * t * t / rings as f32);
                    for sector in 0..sectors {
                        let r = warp::unit_circle((sector as f32 + 0.5) / sectors as f32)
                            * (1.0 - z * z).max(0.0).sqrt();
                        let h = Vec3::new(r.x, r.y, z);
                        let area = f64::from(dz) * std::f64::consts::TAU / f64::from(sectors);
                        let d = f64::from(distribution(h, alpha * alpha)) * area;
                        flat += d * f64::from(h.z);
                        seen += d * f64::from(h.dot(wo).max(0.0) * masking(cos, alpha * alpha));
                    }
                }
                assert!((flat - 1.0).abs() < 2e-3, "{alpha} {flat}");
                assert!((seen - f64::from(cos)).abs() < 5e-3, "{alpha} {cos} {seen}");
            }
        }
    }
}
