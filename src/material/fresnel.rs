//! Reflectances of smooth boundaries.

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
#[inline]
pub fn dielectric(cos_i: f32, eta: f32) -> (f32, f32) {
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    (0.5 * (parallel * parallel + perpendicular * perpendicular), cos_t)
}

/// The reflectance of a thin sheet, all reflections between its two faces summed, from that of one
/// face: `r + t^2 r / (1 - r^2)`.
#[inline]
pub fn thin_sheet(face: f32) -> f32 {
    2.0 * face / (1.0 + face)
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
