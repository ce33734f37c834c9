//! Light from infinitely far away, out of all directions.

use std::f32::consts::{FRAC_1_PI, PI};

use super::Sun;
use crate::math::{DVec3, Vec2, Vec3};
use crate::sampling::{Distribution2d, warp};

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

/// A direction chosen by importance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentSample {
    /// Unit direction that the light comes from.
    pub direction: Vec3,
    /// What comes from there.
    pub radiance: Vec3,
    /// Density over solid angle.
    pub pdf: f32,
}

#[derive(Debug)]
enum Source {
    Constant(Vec3),
    Image(Image),
}

/// A latitude-longitude map, looked up bilinearly.
#[derive(Debug)]
struct Image {
    width: usize,
    height: usize,
    /// Rows from +Y down, the scale multiplied in.
    pixels: Vec<[f32; 3]>,
    /// Over the unit square of cells, see [`Image::locate`]; constant in each.
    distribution: Distribution2d,
    /// Cosine and sine of the rotation about +Y.
    rotation: (f32, f32),
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
        let cells = Cells { width, height, pixels: &pixels };
        let mean = cells.spherical_mean();
        let distribution = Distribution2d::new(width, cells.rows(), &cells.importance())
            .expect("weights are finite and not all zero");
        let radians = rotate_degrees.to_radians();
        let image = Image {
            width,
            height,
            distribution,
            pixels,
            rotation: (libm::cosf(radians), libm::sinf(radians)),
        };
        Self { source: Source::Image(image), mean, sun: None }
    }

    /// The same with a sun before it, whose light is added.
    pub fn with_sun(mut self, sun: Sun) -> Self {
        // Chosen by what it puts onto a surface that faces it, against that of all the rest; also
        // the dimmer of the two now and then.
        let brightness = |c: Vec3| c.x.max(0.0) + c.y.max(0.0) + c.z.max(0.0);
        let of_sun = brightness(sun.radiance()) * sun.solid_angle();
        let of_rest = brightness(self.mean) * PI;
        let share = if of_rest > 0.0 { (of_sun / (of_sun + of_rest)).clamp(0.1, 0.8) } else { 1.0 };
        self.mean += sun.radiance() * (sun.solid_angle() / (4.0 * PI));
        self.sun = Some((sun, share));
        self
    }

    /// The sun before it.
    pub fn sun(&self) -> Option<&Sun> {
        self.sun.as_ref().map(|(sun, _)| sun)
    }

    /// Whether the same comes from everywhere.
    pub fn is_constant(&self) -> bool {
        self.sun.is_none() && matches!(self.source, Source::Constant(_))
    }

    /// Rows of radiance from the top, the scale multiplied in; none if it is constant.
    pub fn pixels(&self) -> &[[f32; 3]] {
        match &self.source {
            Source::Constant(_) => &[],
            Source::Image(image) => &image.pixels,
        }
    }

    /// Mean radiance over all directions.
    pub fn mean(&self) -> Vec3 {
        self.mean
    }

    /// What comes from a unit direction.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        self.radiance_and_pdf(direction).0
    }

    /// The density over solid angle with which [`Environment::sample`] chooses a unit direction.
    pub fn pdf(&self, direction: Vec3) -> f32 {
        self.radiance_and_pdf(direction).1
    }

    /// Both for the price of one.
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let behind = self.behind_sun(direction);
        match &self.sun {
            Some((sun, share)) if sun.covers(direction) => joined(behind, sun, *share),
            Some((_, share)) => (behind.0, behind.1 * (1.0 - share)),
            None => behind,
        }
    }

    /// Both without the sun.
    fn behind_sun(&self, direction: Vec3) -> (Vec3, f32) {
        match &self.source {
            Source::Constant(radiance) => (*radiance, 0.25 * FRAC_1_PI),
            Source::Image(image) => {
                let (uv, sine) = image.locate(direction);
                (image.look_up(uv), solid_angle_pdf(image.distribution.pdf(uv), sine))
            }
        }
    }

    /// Chooses a direction from a uniform `u` in the unit square; `None` for the poles of an
    /// image, whose density over solid angle is not finite.
    pub fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let Some((sun, share)) = &self.sun else { return self.sample_behind_sun(u) };
        if u.x < *share {
            let direction = sun.sample(Vec2::new(u.x / share, u.y));
            let (radiance, pdf) = joined(self.behind_sun(direction), sun, *share);
            return Some(EnvironmentSample { direction, radiance, pdf });
        }
        let rest = ((u.x - share) / (1.0 - share)).min(1.0 - 0.5 * f32::EPSILON);
        let EnvironmentSample { direction, radiance, pdf } =
            self.sample_behind_sun(Vec2::new(rest, u.y))?;
        let (radiance, pdf) = if sun.covers(direction) {
            joined((radiance, pdf), sun, *share)
        } else {
            (radiance, pdf * (1.0 - share))
        };
        (pdf > 0.0).then_some(EnvironmentSample { direction, radiance, pdf })
    }

    fn sample_behind_sun(&self, u: Vec2) -> Option<EnvironmentSample> {
        match &self.source {
            Source::Constant(radiance) => Some(EnvironmentSample {
                direction: warp::sphere(u),
                radiance: *radiance,
                pdf: 0.25 * FRAC_1_PI,
            }),
            Source::Image(image) => {
                let (uv, density) = image.distribution.sample(u);
                let (direction, sine) = image.direction(uv);
                let pdf = solid_angle_pdf(density, sine);
                (pdf > 0.0).then(|| EnvironmentSample {
                    direction,
                    radiance: image.look_up(uv),
                    pdf,
                })
            }
        }
    }
}

/// Radiance and density in the disc of a sun that is chosen with probability `share`.
fn joined((radiance, pdf): (Vec3, f32), sun: &Sun, share: f32) -> (Vec3, f32) {
    (radiance + sun.radiance(), pdf * (1.0 - share) + share * sun.pdf())
}

impl Image {
    /// Where a direction lies in the unit square of cells, and the sine of its polar angle. A cell
    /// is what lies between four texels; the first column of cells starts at the first texels.
    fn locate(&self, direction: Vec3) -> (Vec2, f32) {
        let (cos, sin) = self.rotation;
        let (x, z) = (direction.x * cos - direction.z * sin, direction.x * sin + direction.z * cos);
        let sine = (x * x + z * z).sqrt();
        let u = self.first_column() + libm::atan2f(x, -z) * (0.5 * FRAC_1_PI);
        let v = libm::atan2f(sine, direction.y) * FRAC_1_PI;
        (Vec2::new(u - u.floor(), v), sine)
    }

    /// The direction of a point of the unit square of cells, and the sine of its polar angle.
    fn direction(&self, uv: Vec2) -> (Vec3, f32) {
        let (sine, cosine) = libm::sincosf(uv.y * PI);
        let (s, c) = libm::sincosf((uv.x - self.first_column()) * (2.0 * PI));
        let (x, z) = (sine * s, -sine * c);
        let (cos, sin) = self.rotation;
        (Vec3::new(x * cos + z * sin, cosine, z * cos - x * sin), sine)
    }

    /// The share of the circle from the first column to the image's centre.
    fn first_column(&self) -> f32 {
        0.5 - 0.5 / self.width as f32
    }

    /// Bilinear in the cell of a point.
    fn look_up(&self, uv: Vec2) -> Vec3 {
        let cells = Cells { width: self.width, height: self.height, pixels: &self.pixels };
        let (x, y) = (uv.x * self.width as f32, uv.y * cells.rows() as f32);
        let (column, row) = ((x as usize).min(self.width - 1), (y as usize).min(cells.rows() - 1));
        let (across, down) = (x - column as f32, y - row as f32);
        let [a, b, c, d] = cells.corners(column, row);
        let upper = a * (1.0 - across) + b * across;
        let lower = c * (1.0 - across) + d * across;
        upper * (1.0 - down) + lower * down
    }
}

/// From a density over the unit square to one over solid angle: the square maps to 2 pi by pi, and
/// that to the sphere with the sine of the polar angle.
fn solid_angle_pdf(density: f32, sine: f32) -> f32 {
    if sine > 0.0 { density / (2.0 * PI * PI * sine) } else { 0.0 }
}

/// The cells between an image's texels: as many columns, since the image closes into a ring, and
/// one row less.
struct Cells<'a> {
    width: usize,
    height: usize,
    pixels: &'a [[f32; 3]],
}

impl Cells<'_> {
    /// At least one, also for an image of a single row.
    fn rows(&self) -> usize {
        (self.height - 1).max(1)
    }

    /// The texels around a cell: upper left and right, lower left and right.
    fn corners(&self, column: usize, row: usize) -> [Vec3; 4] {
        let right = if column + 1 == self.width { 0 } else { column + 1 };
        let below = (row + 1).min(self.height - 1);
        let texel = |x: usize, y: usize| Vec3::from(self.pixels[y * self.width + x]);
        [texel(column, row), texel(right, row), texel(column, below), texel(right, below)]
    }

    /// The sine of the polar angle in the middle of a row.
    fn sine(&self, row: usize) -> f32 {
        libm::sinf(PI * (row as f32 + 0.5) / self.rows() as f32)
    }

    /// Mean radiance over the sphere; a cell counts by the sine of its polar angle.
    fn spherical_mean(&self) -> Vec3 {
        let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
        for row in 0..self.rows() {
            let of_row: DVec3 = (0..self.width)
                .map(|column| self.corners(column, row).iter().map(|c| c.as_dvec3()).sum::<DVec3>())
                .sum();
            let sine = f64::from(self.sine(row));
            sum += of_row * (0.25 * sine);
            weight += sine * self.width as f64;
        }
        (sum / weight).as_vec3()
    }

    /// A weight for each cell: the mean of the bilinear interpolant over it, which is that of its
    /// corners. So the slopes around a bright texel are chosen as often as they deserve.
    fn importance(&self) -> Vec<f32> {
        let brightness = |c: Vec3| {
            // NaN counts as nothing, infinity as much as leaves room to add.
            ((c.x.max(0.0) + c.y.max(0.0) + c.z.max(0.0)) / 3.0).min(f32::MAX / 64.0)
        };
        let mut weights = Vec::with_capacity(self.width * self.rows());
        for row in 0..self.rows() {
            let sine = self.sine(row);
            weights.extend((0..self.width).map(|column| {
                let corners = self.corners(column, row);
                0.25 * sine * corners.into_iter().map(brightness).sum::<f32>()
            }));
        }
        if weights.iter().all(|&weight| weight == 0.0) {
            return vec![1.0; weights.len()]; // black: any density will do
        }
        weights
    }
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
