//! From the colour that a medium seems to have to that of one scattering.

use crate::math::Vec3;

/// The albedo of a single scattering in a dense medium that returns the share `color` of all light
/// after any number of them, by colour; `anisotropy` is the mean cosine of a scattering.
///
/// Kulla and Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 course: a
/// fit for isotropic scattering, and by similarity for any other.
pub fn single_scattering_albedo(color: Vec3, anisotropy: f32) -> Vec3 {
    color.map(|color| {
        let color = if color > 0.0 { color.min(1.0) } else { return 0.0 };
        let root = (9.59217 + 41.6808 * color + 17.7126 * color * color).sqrt();
        let s = 4.09712 + 4.20863 * color - root;
        let square = s * s;
        ((1.0 - square) / (1.0 - anisotropy * square)).clamp(0.0, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_is_black_and_white_scatters_all() {
        for g in [-0.9, 0.0, 0.9] {
            assert_eq!(single_scattering_albedo(Vec3::ZERO, g), Vec3::ZERO);
            assert!(single_scattering_albedo(Vec3::ONE, g).min_element() > 0.9999);
            let [dark, middle, bright] =
                single_scattering_albedo(Vec3::new(0.2, 0.5, 0.8), g).to_array();
            assert!(0.2 < dark && dark < middle && middle < bright && bright < 1.0, "{g}");
        }
    }

    /// What a half-space returns of light that falls on it evenly from all sides, by a quadrature
    /// of Chandrasekhar's H-function ("Radiative Transfer", 1950): the fit is good to .005.
    #[test]
    fn the_fit_is_the_albedo_of_a_half_space() {
        for (single, returned) in [
            (0.5, 0.146_544),
            (0.8, 0.341_867),
            (0.9, 0.478_024),
            (0.95, 0.596_669),
            (0.99, 0.794_564),
        ] {
            let found = single_scattering_albedo(Vec3::splat(returned), 0.0).x;
            assert!((found - single).abs() < 0.005, "{found} {single}");
        }
    }
}
