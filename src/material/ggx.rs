//! The GGX distribution of microfacets, with separable Smith shadowing.
//!
//! Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007. Directions
//! are above the surface.

use std::f32::consts::PI;

use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// The least alpha. GGX's alpha is the square of the roughness, but not below this.
pub const MIN_ALPHA: f32 = 1e-3;

/// The greatest alpha of what passes for a mirror: that of a roughness of 0.1. It spreads what is
/// seen in it by about a degree.
pub const MIRROR_ALPHA: f32 = 0.1 * 0.1;

/// The factors that the lobe's density and its value share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// `D(h) G1(wo) / (2 wo.z)`, where `D(h)` is the distribution of normals. Half of it is the
    /// density of the reflected direction, if normals come from [`sample_visible_normal`].
    pub visible: f32,
    /// The same times `G1(wi) / (2 wi.z)`, that is `D V` with glTF's separable visibility term V.
    pub reflected: f32,
}

impl Lobe {
    /// For the cosines of both directions (above zero) and their unit half vector.
    ///
    /// Finite at the horizon. Sines come from x and y of `h`: from `1 - z²` a peak of alpha 0.001
    /// would keep one digit.
    #[inline]
    pub fn new(h: Vec3, cos_o: f32, cos_i: f32, alpha: f32) -> Self {
        let alpha2 = alpha * alpha;
        let t = h.x * h.x + h.y * h.y + alpha2 * h.z * h.z;
        let towards = inverse_masking(cos_i, alpha2);
        // One division for D and both masking terms.
        let reflected = alpha2 / (PI * t * t * inverse_masking(cos_o, alpha2) * towards);
        Self { visible: reflected * towards, reflected }
    }
}

/// Twice the cosine over Smith's masking, `2 cos / G1(cos)`.
#[inline]
fn inverse_masking(cos: f32, alpha2: f32) -> f32 {
    cos + (alpha2 + (1.0 - alpha2) * cos * cos).sqrt()
}

/// Smith's masking `G1(cos)`.
#[inline]
pub fn masking(cos: f32, alpha2: f32) -> f32 {
    2.0 * cos / inverse_masking(cos, alpha2)
}

/// Samples a normal visible from `wo`, whose `z >= 0`: density `D(h) G1(wo) max(0, wo.h) / wo.z`.
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
                        let lobe = f64::from(Lobe::new(h, cos, cos, alpha).visible) * area;
                        let masked = f64::from(masking(cos, alpha * alpha) / (2.0 * cos));
                        flat += lobe / masked * f64::from(h.z);
                        seen += lobe * f64::from(2.0 * cos * h.dot(wo).max(0.0));
                    }
                }
                assert!((flat - 1.0).abs() < 2e-3, "{alpha} {flat}");
                assert!((seen - f64::from(cos)).abs() < 5e-3, "{alpha} {cos} {seen}");
            }
        }
    }
}
