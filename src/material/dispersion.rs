//! Glass that bends blue light more than red (KHR_materials_dispersion).
//!
//! A path that meets such glass goes on with light of one wavelength. It is drawn from three
//! overlapping bands, one for each channel, and the channels are weighed by the share that their
//! bands have in the density of that wavelength: the mean over all wavelengths is white, no weight
//! is above 3, and each channel is the integral over its band.

use crate::math::Vec3;

/// Nanometres in vacuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wavelength(f32);

/// Where the triangular bands of red, green and blue are highest, and how far they reach, nm.
const CENTRES: [f32; 3] = [610.0, 550.0, 465.0];
const REACH: f32 = 90.0;

impl Wavelength {
    /// A wavelength, and the weights of the channels for it: non-negative, of sum 3.
    pub fn sample(u: f32) -> (Self, Vec3) {
        let place = u * 3.0;
        let band = (place as usize).min(2);
        let u = (place - band as f32).clamp(0.0, 1.0);
        let offset = if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() };
        let wavelength = CENTRES[band] + REACH * offset;
        let height = |centre: f32| (1.0 - (wavelength - centre).abs() / REACH).max(0.0);
        let heights = Vec3::from_array(CENTRES.map(height));
        let sum = heights.element_sum();
        // At the very ends of the bands all heights vanish, in one case of 2^24.
        let weights = if sum > 0.0 { heights * (3.0 / sum) } else { Vec3::ONE };
        (Self(wavelength), weights)
    }

    /// The index of refraction at this wavelength of glass whose index is `ior` at 587.6 nm, by
    /// the first two terms of Cauchy's equation; `dispersion` is 20 over the Abbe number.
    pub fn index(self, ior: f32, dispersion: f32) -> f32 {
        if ior == 0.0 {
            return ior; // infinite: a mirror to all of them
        }
        let spread = (ior - 1.0) * dispersion * (1.0 / 20.0);
        (ior + spread * (523_655.0 / (self.0 * self.0) - 1.5168)).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::chi_squared::assert_fits;

    #[test]
    fn the_mean_of_all_wavelengths_is_white() {
        const COUNT: usize = 30_000;
        let weights = (0..COUNT).map(|i| Wavelength::sample((i as f32 + 0.5) / COUNT as f32).1);
        let mean = weights.fold(Vec3::ZERO, |sum, weight| {
            assert!(weight.min_element() >= 0.0 && weight.max_element() < 3.000_01);
            sum + weight / COUNT as f32
        });
        assert!((mean - Vec3::ONE).abs().max_element() < 1e-3, "{mean}");
    }

    /// Drawn as often as the mean of the three triangles says.
    #[test]
    fn wavelengths_follow_the_bands() {
        const CELLS: usize = 64;
        let (from, width) = (370.0, 340.0 / CELLS as f32);
        let mut counts = vec![0; CELLS];
        for i in 0..40_000_u64 {
            let u = crate::sampling::Sampler::independent(i, 0, 4).next_1d();
            let (Wavelength(nm), _) = Wavelength::sample(u);
            counts[(((nm - from) / width) as usize).min(CELLS - 1)] += 1;
        }
        let density = |nm: f64| -> f64 {
            let height = |c: f32| (1.0 - (nm - f64::from(c)).abs() / f64::from(REACH)).max(0.0);
            CENTRES.map(height).iter().sum::<f64>() / (3.0 * f64::from(REACH))
        };
        let expected: Vec<f64> = (0..CELLS)
            .map(|cell| {
                let steps = (0..100).map(|s| cell as f64 + (f64::from(s) + 0.5) / 100.0);
                let mean = steps.map(|x| density(f64::from(from) + x * f64::from(width))).sum();
                40_000.0 * f64::from(width) * f64::min(mean, f64::INFINITY) / 100.0
            })
            .collect();
        assert_fits(&counts, &expected, 1, "wavelengths");
    }

    #[test]
    fn crown_glass_has_its_abbe_number() {
        let index = |nm| Wavelength(nm).index(1.517, 20.0 / 64.2);
        let abbe = (index(587.6) - 1.0) / (index(486.1) - index(656.3));
        assert!((abbe - 64.2).abs() < 0.2, "{abbe}");
        assert!((index(587.6) - 1.517).abs() < 1e-5);
        assert_eq!(Wavelength(400.0).index(1.5, 0.0), 1.5);
        assert_eq!(Wavelength(700.0).index(1.01, 1e6), 1.0);
    }
}
