//! Reflectances of smooth boundaries.

use crate::simd::lanes::{Float, Lanes, Mask, Scalar};

/// The weight of `f90` in Schlick's approximation, that of `f0` being one minus it.
///
/// Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994.
#[inline]
pub fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).max(0.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// The unpolarised reflectance of a dielectric boundary and the cosine of the refracted ray, for
/// light that meets it at `cos_i >= 0`; `eta` is the index behind over that before the boundary.
/// Total reflection is `(1, 0)`.
#[inline(always)]
pub fn dielectric_in_lanes<L: Lanes>(
    lanes: L,
    cos_i: L::Float,
    eta: L::Float,
) -> (L::Float, L::Float) {
    let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
    let sin2_t = (one - cos_i * cos_i) / (eta * eta);
    let cos_t = (one - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let reflectance = (parallel * parallel + perpendicular * perpendicular) * 0.5;
    let total = one.le(sin2_t);
    (total.select(one, reflectance), total.select(zero, cos_t))
}

/// The same, of one.
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> (f32, f32) {
    dielectric_in_lanes(Scalar, cos_i, eta)
}

/// The reflectance of a thin sheet, all reflections between its two faces summed, from that of one
/// face: `r + t^2 r / (1 - r^2)`.
#[inline(always)]
pub fn thin_sheet_in_lanes<L: Lanes>(face: L::Float) -> L::Float {
    face * 2.0 / (face + 1.0)
}

/// The same, of one.
#[inline]
pub fn thin_sheet(face: f32) -> f32 {
    thin_sheet_in_lanes::<Scalar>(face)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_at_known_angles() {
        assert!((dielectric(1.0, 1.5).0 - 0.04).abs() < 1e-6);
        assert!((dielectric(1.0, 1.0 / 1.5).0 - 0.04).abs() < 1e-6);
        // Brewster's angle, tan = eta: only the perpendicular part, ((1 - n²) / (1 + n²))² / 2.
        let brewster = 1.0 / (1.0 + 1.5_f32 * 1.5).sqrt();
        let expected = 0.5 * (1.25_f32 / 3.25) * (1.25 / 3.25);
        assert!((dielectric(brewster, 1.5).0 - expected).abs() < 1e-6);
        // Beyond the critical angle, whose sine is 1 / 1.5.
        assert_eq!(dielectric(0.74, 1.0 / 1.5), (1.0, 0.0));
        assert!(dielectric(0.75, 1.0 / 1.5).0 < 1.0);
        assert_eq!(dielectric(0.0, 1.0), (1.0, 0.0));
    }

    #[test]
    fn both_sides_reflect_alike() {
        for cos_i in [0.1, 0.4, 0.8, 0.99] {
            let (reflectance, cos_t) = dielectric(cos_i, 1.5);
            let (back, cos_back) = dielectric(cos_t, 1.0 / 1.5);
            assert!((reflectance - back).abs() < 1e-5);
            assert!((cos_back - cos_i).abs() < 1e-5);
        }
    }
}
