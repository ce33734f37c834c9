//! The GGX distribution of two alphas, with separable Smith shadowing; [`super::ggx`] has the
//! isotropic one. Directions are above the surface.

use std::f32::consts::PI;

use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// The lobe of two alphas. X is the tangent.
#[derive(Clone, Copy, Debug)]
pub struct Lobe {
    /// Alpha along X.
    pub along: f32,
    /// Alpha along Y.
    pub across: f32,
}

impl Lobe {
    /// `D(h) G1(wo) / (2 wo.z)` and `D V`, as [`super::ggx::Lobe`] has them.
    pub fn eval(&self, h: Vec3, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let (product, ratio) = (self.along * self.across, self.along / self.across);
        let t = h.x * h.x / ratio + h.y * h.y * ratio + product * h.z * h.z;
        let towards = self.inverse_masking(wi);
        let reflected = product / (PI * t * t * self.inverse_masking(wo) * towards);
        (reflected * towards, reflected)
    }

    /// Twice the cosine over Smith's masking.
    fn inverse_masking(&self, w: Vec3) -> f32 {
        let (x, y) = (w.x * self.along, w.y * self.across);
        w.z + (x * x + y * y + w.z * w.z).sqrt()
    }

    /// Smith's masking.
    pub fn masking(&self, w: Vec3) -> f32 {
        2.0 * w.z / self.inverse_masking(w)
    }

    /// Samples a normal visible from `wo` (Dupuy and Benyoub 2023).
    pub fn sample_visible_normal(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let stretched = Vec3::new(wo.x * self.along, wo.y * self.across, wo.z).normalize();
        let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
        let ring = warp::unit_circle(u.x) * (1.0 - z * z).max(0.0).sqrt();
        let h = Vec3::new(ring.x, ring.y, z) + stretched;
        Vec3::new(h.x * self.along, h.y * self.across, h.z.max(1e-12)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::super::ggx;
    use super::*;

    #[test]
    fn of_equal_alphas_it_is_the_isotropic_one() {
        let lobe = Lobe { along: 0.3, across: 0.3 };
        let (wo, wi) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.36, 0.48, 0.8));
        let h = (wo + wi).normalize();
        let (visible, reflected) = lobe.eval(h, wo, wi);
        let expected = ggx::Lobe::new(h, wo.z, wi.z, 0.3);
        assert!((visible / expected.visible - 1.0).abs() < 1e-5);
        assert!((reflected / expected.reflected - 1.0).abs() < 1e-5);
        let u = Vec2::new(0.3, 0.7);
        let normal = ggx::sample_visible_normal(wo, 0.3, u);
        assert!(lobe.sample_visible_normal(wo, u).distance(normal) < 1e-6);
    }
}
