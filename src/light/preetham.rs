//! Daylight after A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for
//! Daylight", SIGGRAPH 1999: the clear sky's luminance and chromaticity by its turbidity, and what
//! the air leaves of the sun.
//!
//! Differences: the sun's spectrum is that of a black body at 5778 K, integrated with the
//! multi-lobe fit to the CIE 1931 observer of C. Wyman, P.-P. Sloan and P. Shirley (JCGT 2013), and
//! of what the air takes from it only Rayleigh scattering and aerosols are counted: ozone, mixed
//! gases and water vapour, which need tables, would take some 5 % more of the visible light at the
//! zenith.

use std::f64::consts::PI;

use crate::math::{DVec3, Vec3};

/// The formula of Perez that all three quantities of the sky follow.
#[derive(Clone, Copy, Debug)]
struct Perez {
    /// A to E.
    coefficients: [f64; 5],
    /// The quantity at the zenith over the formula's value there.
    scale: f64,
}

impl Perez {
    fn new(coefficients: [f64; 5], zenith: f64, sun_angle: f64) -> Self {
        let mut perez = Self { coefficients, scale: 1.0 };
        perez.scale = zenith / perez.at(1.0, sun_angle);
        perez
    }

    /// In a direction with that cosine of the angle to the zenith, at that angle from the sun.
    fn at(&self, cosine: f64, gamma: f64) -> f64 {
        let [a, b, c, d, e] = self.coefficients;
        let near_sun = libm::cos(gamma);
        self.scale
            * (1.0 + a * libm::exp(b / cosine))
            * (1.0 + c * libm::exp(d * gamma) + e * near_sun * near_sun)
    }
}

/// A clear sky under a sun above the horizon.
#[derive(Clone, Copy, Debug)]
pub struct Preetham {
    /// Unit direction to the sun.
    sun: DVec3,
    turbidity: f64,
    /// Of luminance in kcd/m², then of the chromaticities x and y.
    perez: [Perez; 3],
}

impl Preetham {
    /// Turbidities for which the model was fitted: 2 is a clear day in the mountains, 10 haze.
    pub const TURBIDITY: std::ops::RangeInclusive<f32> = 2.0..=10.0;

    /// The sky of a `turbidity` under a sun in a unit direction, +Y up, that does not lead down.
    pub fn new(turbidity: f32, sun: Vec3) -> Self {
        let (t, sun) = (f64::from(turbidity), sun.as_dvec3().normalize());
        let angle = libm::acos(sun.y.clamp(0.0, 1.0));
        let of = |slopes: [f64; 5], offsets: [f64; 5], zenith: f64| {
            let coefficients = std::array::from_fn(|i| slopes[i] * t + offsets[i]);
            Perez::new(coefficients, zenith, angle)
        };
        let (x, y) = zenith_chromaticity(t, angle);
        let perez = [
            of(
                [0.1787, -0.3554, -0.0227, 0.1206, -0.0670],
                [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703],
                zenith_luminance(t, angle),
            ),
            of(
                [-0.0193, -0.0665, -0.0004, -0.0641, -0.0033],
                [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452],
                x,
            ),
            of(
                [-0.0167, -0.0950, -0.0079, -0.0441, -0.0109],
                [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529],
                y,
            ),
        ];
        Self { sun, turbidity: t, perez }
    }

    /// Linear Rec. 709 of the sky without its sun in a unit direction above the horizon, kcd/m²;
    /// what that gamut does not hold is cut off.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let direction = direction.as_dvec3();
        // The horizon itself is where the formula ends.
        let cosine = direction.y.max(1e-4);
        let gamma = libm::acos(direction.dot(self.sun).clamp(-1.0, 1.0));
        let [luminance, x, y] = self.perez.map(|perez| perez.at(cosine, gamma));
        let luminance = luminance.max(0.0);
        rec_709(DVec3::new(x, y, 1.0 - x - y) * (luminance / y))
    }

    /// Linear Rec. 709 of what the sun puts onto a surface that faces it, klx.
    pub fn sun_irradiance(&self) -> Vec3 {
        let air = air_mass(self.sun.y);
        // Ångström's turbidity coefficient, and his exponent.
        let beta = 0.04608 * self.turbidity - 0.04586;
        let mut xyz = DVec3::ZERO;
        for nanometres in (380..=780).step_by(STEP) {
            let micrometres = f64::from(nanometres) * 1e-3;
            let rayleigh = 0.008735 * libm::pow(micrometres, -4.08);
            let aerosols = beta * libm::pow(micrometres, -1.3);
            let left = libm::exp(-(rayleigh + aerosols) * air);
            xyz += observer(f64::from(nanometres)) * (black_body(micrometres) * left);
        }
        // 683 lm/W; the sun's solid angle; from nanometres and lux to klx.
        rec_709(xyz * (683.0 * SUN_SOLID_ANGLE * STEP as f64 * 1e-3))
    }
}

/// Of the integral over wavelengths, nanometres.
const STEP: usize = 5;
const SUN_SOLID_ANGLE: f64 = 6.796e-5;

/// Luminance at the zenith, kcd/m²; `angle` is the sun's from there, radians.
fn zenith_luminance(turbidity: f64, angle: f64) -> f64 {
    let chi = (4.0 / 9.0 - turbidity / 120.0) * (PI - 2.0 * angle);
    let luminance = (4.0453 * turbidity - 4.9710) * libm::tan(chi) - 0.2155 * turbidity + 2.4192;
    luminance.max(0.0)
}

/// x and y of the CIE 1931 observer at the zenith.
fn zenith_chromaticity(turbidity: f64, angle: f64) -> (f64, f64) {
    let cubic = |[a, b, c, d]: [f64; 4]| ((a * angle + b) * angle + c) * angle + d;
    let of = |rows: [[f64; 4]; 3]| {
        let [square, linear, constant] = rows.map(cubic);
        (square * turbidity + linear) * turbidity + constant
    };
    let x = of([
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]);
    let y = of([
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]);
    (x, y)
}

/// How much more air there is on the way than straight up; of the sine of the sun's elevation.
fn air_mass(sine: f64) -> f64 {
    let degrees = libm::acos(sine.clamp(0.0, 1.0)).to_degrees();
    1.0 / (sine.max(0.0) + 0.15 * libm::pow(93.885 - degrees, -1.253))
}

/// Radiance of a black body at the sun's temperature, W/(m² sr nm).
fn black_body(micrometres: f64) -> f64 {
    const KELVIN: f64 = 5778.0;
    let over = libm::exp(14387.77 / (micrometres * KELVIN)) - 1.0;
    1.191043e8 / (libm::pow(micrometres, 5.0) * over) * 1e-3
}

/// The CIE 1931 2° observer's three responses.
fn observer(nanometres: f64) -> DVec3 {
    let lobe = |height: f64, middle: f64, below: f64, above: f64| {
        let over = nanometres - middle;
        let t = over * if over < 0.0 { below } else { above };
        height * libm::exp(-0.5 * t * t)
    };
    DVec3::new(
        lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(1.056, 599.8, 0.0264, 0.0323)
            - lobe(0.065, 501.1, 0.0490, 0.0382),
        lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
        lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
    )
}

/// From CIE XYZ; not below zero.
fn rec_709(xyz: DVec3) -> Vec3 {
    DVec3::new(
        DVec3::new(3.2404542, -1.5371385, -0.4985314).dot(xyz),
        DVec3::new(-0.9692660, 1.8760108, 0.0415560).dot(xyz),
        DVec3::new(0.0556434, -0.2040259, 1.0572252).dot(xyz),
    )
    .max(DVec3::ZERO)
    .as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sun(elevation: f32) -> Vec3 {
        let (s, c) = libm::sincosf(elevation.to_radians());
        Vec3::new(0.0, s, -c)
    }

    fn luminance(c: Vec3) -> f64 {
        f64::from(0.2126729 * c.x + 0.7151522 * c.y + 0.0721750 * c.z)
    }

    #[test]
    fn the_zenith_is_the_papers() {
        // The paper's appendix A.2, worked out by hand for T = 3 and a sun at 45°:
        // chi = (4/9 - 3/120) pi/2 = 0.65886, tan chi = 0.77428.
        let angle = PI / 4.0;
        assert!((zenith_luminance(3.0, angle) - 7.3204).abs() < 2e-3);
        let (x, y) = zenith_chromaticity(2.0, 0.0);
        // With the sun at the zenith only the constants are left: 2 * 0.00394 + 0.25886 and
        // 2 * 0.00516 + 0.26688.
        assert!((x - 0.26674).abs() < 1e-9 && (y - 0.27720).abs() < 1e-9, "{x} {y}");
        // And the sky as a whole has that luminance there.
        let sky = Preetham::new(3.0, sun(45.0));
        assert!((luminance(sky.radiance(Vec3::Y)) / 7.3204 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_clear_sky_is_at_most_twice_as_bright_as_measured_ones() {
        // Illuminance of the ground by the sky alone. The IESNA Lighting Handbook gives for a clear
        // sky 0.8 + 15.5 sqrt(sin elevation) klx: 13.8 at 45°. That the model is brighter than
        // measured skies is known (G. Zotti et al., A Critical Review of the Preetham Skylight
        // Model, WSCG 2007).
        let sky = Preetham::new(2.5, sun(45.0));
        let mut sum = 0.0;
        let (rings, around) = (90, 180);
        for i in 0..rings {
            let height = (f64::from(i) + 0.5) / f64::from(rings);
            for j in 0..around {
                let turn = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(around);
                let across = (1.0 - height * height).sqrt();
                let direction =
                    DVec3::new(across * libm::sin(turn), height, across * libm::cos(turn));
                sum += luminance(sky.radiance(direction.as_vec3())) * height;
            }
        }
        let klx = sum * 2.0 * PI / f64::from(rings * around);
        assert!((13.0..28.0).contains(&klx), "{klx}");
    }

    #[test]
    fn the_suns_light_is_what_the_air_leaves_of_it() {
        // Without air 128 to 134 klx; the same handbook's 127.5 klx exp(-0.21 air mass) is for a
        // clear day: 103 klx from the zenith, 84 at an air mass of 2.
        for (elevation, handbook) in [(90.0, 103.4), (30.0, 83.8)] {
            let found = luminance(Preetham::new(2.0, sun(elevation)).sun_irradiance());
            assert!((found / handbook - 1.0).abs() < 0.12, "{elevation}: {found}");
        }
        let low = Preetham::new(3.0, sun(3.0)).sun_irradiance();
        assert!(low.x > 2.0 * low.y && low.y > 3.0 * low.z, "the sun sets red: {low}");
    }

    #[test]
    fn the_zenith_is_blue_and_the_horizon_under_the_sun_bright() {
        let sky = Preetham::new(3.0, sun(30.0));
        let zenith = sky.radiance(Vec3::Y);
        assert!(zenith.z > zenith.y && zenith.y > zenith.x, "{zenith}");
        let under = sky.radiance(Vec3::new(0.0, 0.1, -1.0).normalize());
        assert!(luminance(under) > 3.0 * luminance(zenith));
        for turbidity in [2.0, 6.0, 10.0] {
            for elevation in [0.0, 1.0, 90.0] {
                let sky = Preetham::new(turbidity, sun(elevation));
                for direction in [Vec3::X, Vec3::Y, sun(elevation)] {
                    let radiance = sky.radiance(direction);
                    assert!(radiance.is_finite() && radiance.min_element() >= 0.0, "{radiance}");
                }
                assert!(sky.sun_irradiance().is_finite());
            }
        }
    }
}
