//! Light from infinitely far away, out of all directions.

use std::f32::consts::{FRAC_1_PI, PI};

use super::environment_image::{EnvironmentImage, EnvironmentSample};
use super::sun::Sun;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Radiance that arrives from each direction where nothing is in the way.
///
/// An image is a map of latitude and longitude: its centre looks towards -Z, +X is to the right of
/// it and +Y is up. The first row lies on the pole +Y and the last on -Y; columns lie half a column
/// inside the image's edges, which meet towards +Z (Mitsuba has them so).
#[derive(Debug)]
pub struct Environment {
    source: Source,
    /// Mean over the sphere.
    mean: Vec3,
    /// In front of it, and how often it is chosen.
    sun: Option<(Sun, f32)>,
}

#[derive(Debug)]
enum Source {
    Constant(Vec3),
    Image(EnvironmentImage),
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: Vec3) -> Self {
        Self { source: Source::Constant(radiance), mean: radiance, sun: None }
    }

    /// An image of linear radiance, rows from the top, times `scale`, turned about +Y by
    /// `rotate_degrees` (counter-clockwise seen from above: at 90 the centre looks towards -X).
    ///
    /// Negative and infinite values and NaN do not disturb the choice of directions; they arrive
    /// in the picture as they are.
    ///
    /// # Panics
    /// If `pixels` is not `width * height` long, or empty.
    pub fn image(
        width: usize,
        height: usize,
        mut pixels: Vec<[f32; 3]>,
        scale: f32,
        rotate_degrees: f32,
    ) -> Self {
        assert!(width > 0 && height > 0 && pixels.len() == width * height, "an image with pixels");
        for value in pixels.iter_mut().flatten() {
            *value *= scale;
        }
        let (image, mean) = EnvironmentImage::new(width, height, pixels, rotate_degrees);
        Self { source: Source::Image(image), mean, sun: None }
    }

    /// The same with a sun in front, whose light is added.
    pub fn with_sun(mut self, sun: Sun) -> Self {
        // The sun is sampled by its irradiance against that of the rest, with a probability from
        // 0.1 to 0.8.
        let brightness = |c: Vec3| c.x.max(0.0) + c.y.max(0.0) + c.z.max(0.0);
        let of_sun = brightness(sun.radiance()) * sun.solid_angle();
        let of_rest = brightness(self.mean) * PI;
        let share = if of_rest > 0.0 { (of_sun / (of_sun + of_rest)).clamp(0.1, 0.8) } else { 1.0 };
        self.mean += sun.radiance() * (sun.solid_angle() / (4.0 * PI));
        self.sun = Some((sun, share));
        self
    }

    /// The sun in front.
    pub fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref().map(|(sun, _)| sun)
    }

    /// Whether the radiance is the same from everywhere.
    pub fn is_constant(&self) -> bool {
        self.sun.is_none() && matches!(self.source, Source::Constant(_))
    }

    /// Rows of radiance from the top, the scale multiplied in; none if it is constant.
    pub fn pixels(&self) -> &[[f32; 3]] {
        match &self.source {
            Source::Constant(_) => &[],
            Source::Image(image) => image.pixels(),
        }
    }

    /// Mean radiance over all directions.
    pub fn mean(&self) -> Vec3 {
        self.mean
    }

    /// The radiance from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.radiance_and_pdf(direction).0
    }

    /// The density over solid angle with which [`Environment::sample`] returns a unit direction.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.radiance_and_pdf(direction).1
    }

    /// Radiance and density at the cost of one of them.
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let behind = self.radiance_and_pdf_without_sun(direction);
        match &self.sun {
            Some((sun, share)) if sun.covers(direction) => combine_with_sun(behind, sun, *share),
            Some((_, share)) => (behind.0, behind.1 * (1.0 - share)),
            None => behind,
        }
    }

    /// The same without the sun.
    fn radiance_and_pdf_without_sun(&self, direction: Vec3) -> (Vec3, f32) {
        match &self.source {
            Source::Constant(radiance) => (*radiance, 0.25 * FRAC_1_PI),
            Source::Image(image) => image.radiance_and_pdf(direction),
        }
    }

    /// Samples a direction by a uniform `u` in the unit square; `None` at the poles of an image,
    /// where the density over solid angle is not finite.
    pub fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let Some((sun, share)) = &self.sun else { return self.sample_without_sun(u) };
        if u.x < *share {
            let direction = sun.sample(Vec2::new(u.x / share, u.y));
            let (radiance, pdf) =
                combine_with_sun(self.radiance_and_pdf_without_sun(direction), sun, *share);
            return Some(EnvironmentSample { direction, radiance, pdf });
        }
        let rest = ((u.x - share) / (1.0 - share)).min(1.0 - 0.5 * f32::EPSILON);
        let EnvironmentSample { direction, radiance, pdf } =
            self.sample_without_sun(Vec2::new(rest, u.y))?;
        let (radiance, pdf) = if sun.covers(direction) {
            combine_with_sun((radiance, pdf), sun, *share)
        } else {
            (radiance, pdf * (1.0 - share))
        };
        (pdf > 0.0).then_some(EnvironmentSample { direction, radiance, pdf })
    }

    fn sample_without_sun(&self, u: Vec2) -> Option<EnvironmentSample> {
        match &self.source {
            Source::Constant(radiance) => Some(EnvironmentSample {
                direction: warp::sphere(u),
                radiance: *radiance,
                pdf: 0.25 * FRAC_1_PI,
            }),
            Source::Image(image) => image.sample(u),
        }
    }
}

/// Radiance and density in the disc of a sun that is sampled with probability `share`.
fn combine_with_sun((radiance, pdf): (Vec3, f32), sun: &Sun, share: f32) -> (Vec3, f32) {
    (radiance + sun.radiance(), pdf * (1.0 - share) + share * sun.pdf())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red towards -Z, green towards +X, blue above the rest; a bright sun somewhere.
    fn image(rotate: f32) -> Environment {
        let (width, height) = (32, 16);
        let mut pixels = vec![[0.1, 0.1, 0.2]; width * height];
        for y in 6..11 {
            for x in 15..17 {
                pixels[y * width + x] = [5.0, 0.0, 0.0];
                pixels[y * width + x + 8] = [0.0, 5.0, 0.0];
            }
        }
        pixels[3 * width + 5] = [1000.0, 1000.0, 1000.0];
        Environment::image(width, height, pixels, 2.0, rotate)
    }

    #[test]
    fn the_centre_looks_along_minus_z_with_plus_x_to_its_right() {
        let environment = image(0.0);
        assert_eq!(environment.radiance(Vec3::NEG_Z), Vec3::new(10.0, 0.0, 0.0));
        assert_eq!(environment.radiance(Vec3::X), Vec3::new(0.0, 10.0, 0.0));
        // Turned a quarter counter-clockwise seen from above, what was at +X stands at -Z.
        let turned = image(90.0);
        assert!(turned.radiance(Vec3::NEG_Z).distance(Vec3::new(0.0, 10.0, 0.0)) < 1e-3);
        assert!(turned.radiance(Vec3::NEG_X).distance(Vec3::new(10.0, 0.0, 0.0)) < 1e-3);
    }

    #[test]
    fn samples_agree_with_look_ups_and_integrate_to_the_mean() {
        let environment = image(37.0);
        let (mut sum, mut count, mut agreeing) = (Vec3::ZERO, 0.0, 0);
        for i in 0..128 {
            for j in 0..128 {
                let u = Vec2::new((i as f32 + 0.5) / 128.0, (j as f32 + 0.5) / 128.0);
                let sample = environment.sample(u).expect("no pole");
                let (radiance, pdf) = environment.radiance_and_pdf(sample.direction);
                // On the border of two cells, rounding may find the other one's density.
                agreeing += i32::from((pdf / sample.pdf - 1.0).abs() < 1e-3);
                assert!(radiance.distance(sample.radiance) < 0.01 * (1.0 + radiance.length()));
                sum += sample.radiance / sample.pdf;
                count += 1.0;
            }
        }
        assert!(agreeing > 16200, "{agreeing} of 16384");
        // The integral of the radiance, by importance, against that of the texels.
        let mean = sum / count / (4.0 * PI);
        assert!(mean.distance(environment.mean()) < 0.02 * mean.length(), "{mean}");
    }

    #[test]
    fn a_sun_adds_its_light_and_is_chosen_with_the_density_told() {
        let sun = Sun::new(Vec3::new(0.6, 0.8, 0.0), 5.0, Vec3::splat(20.0));
        for (environment, up) in [
            (image(37.0).with_sun(sun), None),
            (Environment::constant(Vec3::ZERO).with_sun(sun), Some(16.0)),
            (Environment::constant(Vec3::splat(0.5)).with_sun(sun), Some(16.0 + 0.5 * PI)),
        ] {
            let (mut mean, mut irradiance) = (Vec3::ZERO, 0.0);
            for i in 0..256 {
                for j in 0..256 {
                    let u = Vec2::new((i as f32 + 0.5) / 256.0, (j as f32 + 0.5) / 256.0);
                    let sample = environment.sample(u).expect("no pole");
                    mean += sample.radiance / (sample.pdf * 65536.0 * 4.0 * PI);
                    irradiance +=
                        sample.radiance.x * sample.direction.y.max(0.0) / (sample.pdf * 65536.0);
                }
            }
            assert!(mean.distance(environment.mean()) < 0.02 * mean.length(), "{mean}");
            if let Some(up) = up {
                assert!((irradiance / up - 1.0).abs() < 2e-3, "{irradiance} {up}");
            }
        }
        assert!(!Environment::constant(Vec3::ONE).with_sun(sun).is_constant());
    }

    #[test]
    fn a_black_image_can_be_sampled() {
        let black = Environment::image(2, 1, vec![[0.0; 3]; 2], 1.0, 0.0);
        let sample = black.sample(Vec2::splat(0.3)).expect("some direction");
        assert_eq!((sample.radiance, black.mean()), (Vec3::ZERO, Vec3::ZERO));
        assert!(sample.pdf > 0.0);
    }
}
