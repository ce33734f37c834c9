//! Light from infinitely far away, out of all directions.

use std::f32::consts::{FRAC_1_PI, PI};

use super::environment_image::{EnvironmentImage, EnvironmentSamples};
use super::sun::Sun;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Mask, Scalar, Vec3f};

/// A direction sampled by importance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit direction that the light comes from.
    pub direction: Vec3,
    /// Radiance from there.
    pub radiance: Vec3,
    /// Density over solid angle.
    pub pdf: f32,
}

/// Radiance that arrives from each direction where nothing is in the way.
///
/// An image is a map of latitude and longitude: its centre looks towards -Z, +X is to the right of
/// it and +Y is up. The first row lies on the pole +Y and the last on -Y; columns lie half a column
/// inside the image's edges, which meet towards +Z (Mitsuba has them so).
#[derive(Clone, Debug)]
pub struct Environment {
    source: Source,
    /// Mean over the sphere.
    mean: Vec3,
    /// In front of it, and how often it is chosen.
    sun: Option<(Sun, f32)>,
}

#[derive(Clone, Debug)]
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
        let (image, mean) = EnvironmentImage::new(width, height, &pixels, rotate_degrees);
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
    pub fn pixels(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        let image = match &self.source {
            Source::Constant(_) => None,
            Source::Image(image) => Some(image),
        };
        image.into_iter().flat_map(EnvironmentImage::pixels)
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
    /// Parts of an image that are darker than its mean may have none.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.radiance_and_pdf(direction).1
    }

    /// Radiance and density at the cost of one of them.
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let (radiance, pdf) = self.radiance_and_pdf_in_lanes(Scalar, direction.into());
        (radiance.into(), pdf)
    }

    /// Samples a direction by a uniform `u` in the unit square; `None` at the poles of an image,
    /// where the density over solid angle is not finite.
    pub fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let EnvironmentSamples { direction, radiance, pdf } =
            self.sample_in_lanes(Scalar, u.to_array());
        let (direction, radiance) = (direction.into(), radiance.into());
        (pdf > 0.0).then_some(EnvironmentSample { direction, radiance, pdf })
    }

    /// [`Environment::radiance_and_pdf`] in lanes.
    #[inline(always)]
    pub fn radiance_and_pdf_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        direction: Vec3f<L>,
    ) -> (Vec3f<L>, L::Float) {
        let behind = self.behind_sun(lanes, direction);
        match &self.sun {
            Some((sun, share)) => add_sun(lanes, behind, direction, sun, *share),
            None => behind,
        }
    }

    /// [`Environment::sample`] in lanes; the density is zero where there is no sample.
    #[inline(always)]
    pub fn sample_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        [x, y]: [L::Float; 2],
    ) -> EnvironmentSamples<L> {
        let Some((sun, share)) = &self.sun else { return self.sample_behind_sun(lanes, [x, y]) };
        let of_sun = x.lt(lanes.float(*share));
        let below_one = lanes.float(1.0 - 0.5 * f32::EPSILON);
        let rest = ((x - *share) / (1.0 - share)).least(below_one);
        let to_sun = sun.sample_in_lanes(lanes, [x / *share, y]);
        // What no lane asks for is left out.
        let nothing = (constant(lanes, Vec3::ZERO), lanes.float(0.0));
        let any_of_sun = of_sun.to_bits() != 0;
        let at_sun = if any_of_sun { self.behind_sun(lanes, to_sun) } else { nothing };
        let behind = if (!of_sun).to_bits() != 0 {
            self.sample_behind_sun(lanes, [rest, y])
        } else {
            EnvironmentSamples { direction: to_sun, radiance: nothing.0, pdf: nothing.1 }
        };
        let direction = Vec3f::select(of_sun, to_sun, behind.direction);
        let radiance = Vec3f::select(of_sun, at_sun.0, behind.radiance);
        let pdf = of_sun.select(at_sun.1, behind.pdf);
        let (radiance, pdf) = add_sun(lanes, (radiance, pdf), direction, sun, *share);
        // No sample behind it stays none, also where the sun stands at an image's pole.
        let none = lanes.float(0.0);
        let any = of_sun | behind.pdf.gt(none);
        EnvironmentSamples { direction, radiance, pdf: any.select(pdf, none) }
    }

    /// Radiance and density without the sun.
    #[inline(always)]
    fn behind_sun<L: Lanes>(&self, lanes: L, direction: Vec3f<L>) -> (Vec3f<L>, L::Float) {
        match &self.source {
            Source::Constant(radiance) => {
                (constant(lanes, *radiance), lanes.float(0.25 * FRAC_1_PI))
            }
            Source::Image(image) => image.radiance_and_pdf_in_lanes(lanes, direction),
        }
    }

    /// Samples directions without the sun.
    #[inline(always)]
    fn sample_behind_sun<L: Lanes>(&self, lanes: L, u: [L::Float; 2]) -> EnvironmentSamples<L> {
        match &self.source {
            Source::Constant(radiance) => EnvironmentSamples {
                direction: warp::sphere_in_lanes(lanes, u),
                radiance: constant(lanes, *radiance),
                pdf: lanes.float(0.25 * FRAC_1_PI),
            },
            Source::Image(image) => image.sample_in_lanes(lanes, u),
        }
    }
}

/// The same vector in all lanes.
#[inline(always)]
fn constant<L: Lanes>(lanes: L, v: Vec3) -> Vec3f<L> {
    Vec3f::new(lanes.float(v.x), lanes.float(v.y), lanes.float(v.z))
}

/// Radiance and density of what is behind with a sun in front, which is sampled with probability
/// `share`.
#[inline(always)]
fn add_sun<L: Lanes>(
    lanes: L,
    (radiance, pdf): (Vec3f<L>, L::Float),
    direction: Vec3f<L>,
    sun: &Sun,
    share: f32,
) -> (Vec3f<L>, L::Float) {
    let covers = sun.covers_in_lanes(lanes, direction);
    let pdf = pdf * (1.0 - share);
    let with_sun = radiance + constant(lanes, sun.radiance());
    let radiance = Vec3f::select(covers, with_sun, radiance);
    (radiance, covers.select(pdf + share * sun.pdf(), pdf))
}
