//! Thin films: the colours of soap, oil and tempered steel (KHR_materials_iridescence).
//!
//! Belcour and Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying
//! Iridescence", SIGGRAPH 2017, in the form that the extension gives it: Schlick's reflectances at
//! both faces of the film, waves of the second order and above by Gaussians in Fourier space. What
//! the film does not reflect it lets through: it absorbs nothing.

use std::f32::consts::PI;

use super::fresnel;
use super::params::saturate;
use crate::math::Vec3;

/// A film in air over something that reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm {
    /// How much of the reflection is the film's, 0 to 1.
    strength: f32,
    ior: f32,
    /// Nanometres.
    thickness: f32,
}

/// Below this many nanometres a film fades into the air above it.
const FADING: f32 = 0.03;

impl ThinFilm {
    /// A film of some strength (taken to 0 to 1), index of refraction (at least 1) and thickness in
    /// nanometres (at least 0).
    pub fn new(strength: f32, ior: f32, thickness: f32) -> Self {
        // The approximations below would leave something of a film of no thickness.
        let strength = if thickness > 0.0 { saturate(strength) } else { 0.0 };
        Self { strength, ior: ior.max(1.0), thickness: thickness.max(0.0) }
    }

    /// What is reflected by colour, 0 to 1, of light that meets the film at that cosine: `base_f0`
    /// is the reflectance at normal incidence of what is below, in air; `plain` what would be
    /// reflected without the film.
    pub fn reflectance(&self, cos: f32, base_f0: Vec3, plain: Vec3) -> Vec3 {
        plain + (self.interference(cos.clamp(0.0, 1.0), base_f0) - plain) * self.strength
    }

    fn interference(&self, cos: f32, base_f0: Vec3) -> Vec3 {
        let t = (self.thickness / FADING).min(1.0);
        let ior = 1.0 + (self.ior - 1.0) * (t * t * (3.0 - 2.0 * t));
        let cos2_inside = 1.0 - (1.0 - cos * cos) / (ior * ior);
        if cos2_inside < 0.0 {
            return Vec3::ONE;
        }
        let cos_inside = cos2_inside.sqrt();
        let upper = schlick(normal_reflectance(ior, 1.0), cos);
        let through = 1.0 - upper;

        let root = base_f0.clamp(Vec3::ZERO, Vec3::splat(0.9999)).map(f32::sqrt);
        let base_ior = (Vec3::ONE + root) / (Vec3::ONE - root);
        let lower = base_ior.map(|base| schlick(normal_reflectance(base, ior), cos_inside));
        // A wave that meets something denser turns by half of its length.
        let turn = base_ior.map(|base| PI + if base < ior { PI } else { 0.0 });

        let path = 2.0 * ior * self.thickness * cos_inside;
        let both = (lower * upper).clamp(Vec3::splat(1e-5), Vec3::splat(0.9999));
        let again = lower * (through * through) / (Vec3::ONE - both);
        let mut reflected = again + upper;
        let mut amplitude = again - through;
        let step = both.map(f32::sqrt);
        for order in [1.0, 2.0] {
            amplitude *= step;
            reflected += amplitude * sensitivity(order * path, turn * order) * 2.0;
        }
        reflected.clamp(Vec3::ZERO, Vec3::ONE)
    }
}

fn normal_reflectance(beyond: f32, before: f32) -> f32 {
    let root = (beyond - before) / (beyond + before);
    root * root
}

fn schlick(f0: f32, cos: f32) -> f32 {
    f0 + (1.0 - f0) * fresnel::schlick_weight(cos)
}

/// The cosine of the phase of a path difference in nanometres, averaged over the sensitivities of
/// the eye and taken to linear Rec. 709; one where there is no difference and no shift.
fn sensitivity(path: f32, shift: Vec3) -> Vec3 {
    /// Of each Gaussian: height, place and width squared in Fourier space; for X, Y, Z and the
    /// second one of X (Belcour and Barla's fit).
    const GAUSSIANS: [[f32; 3]; 4] = [
        [5.4856e-13, 1.6810e6, 4.3278e9],
        [4.4201e-13, 1.7953e6, 9.3046e9],
        [5.2481e-13, 2.2084e6, 6.6121e9],
        [9.7470e-14, 2.2399e6, 4.5282e9],
    ];
    const WHITE: f32 = 1.0685e-7;
    let phase = 2.0 * PI * path * 1e-9;
    let of = |[height, place, width]: [f32; 3], shift: f32| {
        let decay = libm::expf(-width * phase * phase);
        height * (2.0 * PI * width).sqrt() * libm::cosf(place * phase + shift) * decay / WHITE
    };
    let [x, y, z, second] = GAUSSIANS;
    let (x, y, z) = (of(x, shift.x) + of(second, shift.x), of(y, shift.y), of(z, shift.z));
    Vec3::new(
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: Vec3 = Vec3::splat(0.04);

    #[test]
    fn without_thickness_there_is_no_film() {
        let film = ThinFilm::new(1.0, 1.8, 0.0);
        for cos in [1.0, 0.7, 0.2] {
            let plain = Vec3::splat(schlick(0.04, cos));
            assert_eq!(film.reflectance(cos, GLASS, plain), plain, "{cos}");
        }
    }

    #[test]
    fn strength_mixes() {
        let plain = Vec3::new(0.1, 0.2, 0.3);
        assert_eq!(ThinFilm::new(0.0, 1.3, 400.0).reflectance(0.8, GLASS, plain), plain);
        let whole = ThinFilm::new(1.0, 1.3, 400.0).reflectance(0.8, GLASS, plain);
        let half = ThinFilm::new(0.5, 1.3, 400.0).reflectance(0.8, GLASS, plain);
        assert!((half - (whole + plain) * 0.5).abs().max_element() < 1e-6);
    }

    /// A quarter of a wavelength of index sqrt(1.5) on glass is the classic anti-reflection coat:
    /// dark in green; a film twice as thick is not there for green.
    #[test]
    fn a_quarter_wave_extinguishes_its_colour() {
        let index = libm::sqrtf(1.5);
        let film = |thickness| ThinFilm::new(1.0, index, thickness);
        let green = |thickness| film(thickness).reflectance(1.0, GLASS, GLASS).y;
        let quarter = 550.0 / (4.0 * index);
        assert!(green(quarter) < 0.006, "{}", green(quarter));
        assert!(green(2.0 * quarter) > 0.03, "{}", green(2.0 * quarter));
    }

    #[test]
    fn a_white_mirror_stays_white_and_thick_films_lose_their_colour() {
        for cos in [1.0, 0.5, 0.1] {
            let mirror = ThinFilm::new(1.0, 1.5, 300.0).reflectance(cos, Vec3::ONE, Vec3::ONE);
            assert!((mirror - Vec3::ONE).abs().max_element() < 0.03, "{cos}: {mirror}");
            let thick = ThinFilm::new(1.0, 1.5, 50_000.0).reflectance(cos, GLASS, GLASS);
            assert!(thick.max_element() - thick.min_element() < 1e-3, "{cos}: {thick}");
        }
        let thin = ThinFilm::new(1.0, 1.33, 350.0).reflectance(1.0, GLASS, GLASS);
        assert!(thin.max_element() > 1.5 * thin.min_element(), "{thin}");
    }
}
