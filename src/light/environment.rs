//! Light from infinitely far away, out of all directions.

use std::f32::consts::{FRAC_1_PI, PI};

use crate::math::{Vec2, Vec3};
use crate::sampling::{Distribution2d, warp};

/// Radiance that arrives from each direction where nothing is in the way.
///
/// An image is a map of latitude and longitude: its centre column looks towards -Z, +X is to the
/// right of it and +Y is up.
#[derive(Debug)]
pub struct Environment {
    source: Source,
    /// Mean over the sphere.
    mean: Vec3,
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
    /// Over the unit square of the image; piecewise constant over texels.
    distribution: Distribution2d,
    /// Cosine and sine of the rotation about +Y.
    rotation: (f32, f32),
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(radiance: Vec3) -> Self {
        Self { source: Source::Constant(radiance), mean: radiance }
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
        let sines: Vec<f32> =
            (0..height).map(|y| libm::sinf(PI * (y as f32 + 0.5) / height as f32)).collect();
        let mean = spherical_mean(width, &pixels, &sines);
        let weights = importance(width, height, &pixels, &sines);
        let radians = rotate_degrees.to_radians();
        let image = Image {
            width,
            height,
            distribution: Distribution2d::new(width, height, &weights)
                .expect("weights are finite and not all zero"),
            pixels,
            rotation: (libm::cosf(radians), libm::sinf(radians)),
        };
        Self { source: Source::Image(image), mean }
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

impl Image {
    /// Where a direction lies in the unit square of the image, and the sine of its polar angle.
    fn locate(&self, direction: Vec3) -> (Vec2, f32) {
        let (cos, sin) = self.rotation;
        let (x, z) = (direction.x * cos - direction.z * sin, direction.x * sin + direction.z * cos);
        let sine = (x * x + z * z).sqrt();
        let u = 0.5 + libm::atan2f(x, -z) * (0.5 * FRAC_1_PI);
        let v = libm::atan2f(sine, direction.y) * FRAC_1_PI;
        (Vec2::new(u, v), sine)
    }

    /// The direction of a point of the unit square, and the sine of its polar angle.
    fn direction(&self, uv: Vec2) -> (Vec3, f32) {
        let (sine, cosine) = libm::sincosf(uv.y * PI);
        let (s, c) = libm::sincosf((uv.x - 0.5) * (2.0 * PI));
        let (x, z) = (sine * s, -sine * c);
        let (cos, sin) = self.rotation;
        (Vec3::new(x * cos + z * sin, cosine, z * cos - x * sin), sine)
    }

    /// Bilinear between the centres of texels; repeats sideways, ends at the poles.
    fn look_up(&self, uv: Vec2) -> Vec3 {
        let (x, y) = (uv.x * self.width as f32 - 0.5, uv.y * self.height as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (across, down) = (x - left, y - top);
        let column = |i: i64| i.rem_euclid(self.width as i64) as usize;
        let row = |i: i64| i.clamp(0, self.height as i64 - 1) as usize;
        let texel = |i: i64, j: i64| Vec3::from(self.pixels[row(j) * self.width + column(i)]);
        let (i, j) = (left as i64, top as i64);
        let upper = texel(i, j) * (1.0 - across) + texel(i + 1, j) * across;
        let lower = texel(i, j + 1) * (1.0 - across) + texel(i + 1, j + 1) * across;
        upper * (1.0 - down) + lower * down
    }
}

/// From a density over the unit square to one over solid angle: the square maps to 2 pi by pi, and
/// that to the sphere with the sine of the polar angle.
fn solid_angle_pdf(density: f32, sine: f32) -> f32 {
    if sine > 0.0 { density / (2.0 * PI * PI * sine) } else { 0.0 }
}

/// Mean radiance over the sphere; rows count by the sine of their polar angle.
fn spherical_mean(width: usize, pixels: &[[f32; 3]], sines: &[f32]) -> Vec3 {
    let (mut sum, mut weight) = ([0.0_f64; 3], 0.0_f64);
    for (row, &sine) in pixels.chunks_exact(width).zip(sines) {
        for (sum, channel) in sum.iter_mut().zip(0..3) {
            *sum +=
                row.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() * f64::from(sine);
        }
        weight += f64::from(sine) * width as f64;
    }
    Vec3::from(sum.map(|sum| (sum / weight) as f32))
}

/// A weight for each texel: the mean of the bilinear interpolant over it, so that the rim of a
/// bright texel, which reaches halfway into its neighbours, is chosen as often as it deserves.
/// (The mean of a bilinear interpolant over a texel weighs texels by 1, 6, 1 over 8 on each axis.)
fn importance(width: usize, height: usize, pixels: &[[f32; 3]], sines: &[f32]) -> Vec<f32> {
    let brightness: Vec<f32> = pixels
        .iter()
        .map(|&[r, g, b]| (r.max(0.0) + g.max(0.0) + b.max(0.0)) / 3.0)
        // NaN has become zero by now; infinity counts as much as leaves room to add.
        .map(|value| value.min(f32::MAX / 64.0))
        .collect();
    let mean_of = |before: f32, here: f32, after: f32| 0.125 * (before + 6.0 * here + after);
    let mut sideways = vec![0.0; brightness.len()];
    for (row, out) in brightness.chunks_exact(width).zip(sideways.chunks_exact_mut(width)) {
        for x in 0..width {
            out[x] = mean_of(row[(x + width - 1) % width], row[x], row[(x + 1) % width]);
        }
    }
    let mut weights = Vec::with_capacity(sideways.len());
    for (y, sine) in (0..height).zip(sines) {
        let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
        weights.extend((0..width).map(|x| {
            let at = |row: usize| sideways[row * width + x];
            mean_of(at(above), at(y), at(below)) * sine
        }));
    }
    if weights.iter().all(|&weight| weight == 0.0) {
        return vec![1.0; weights.len()]; // black: any density will do
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red towards -Z, green towards +X, blue above the rest; a bright sun somewhere.
    fn image(rotate: f32) -> Environment {
        let (width, height) = (32, 16);
        let mut pixels = vec![[0.1, 0.1, 0.2]; width * height];
        for y in 6..10 {
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
                // On the border of two texels, rounding may find the other one's density.
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
    fn a_black_image_can_be_sampled() {
        let black = Environment::image(2, 1, vec![[0.0; 3]; 2], 1.0, 0.0);
        let sample = black.sample(Vec2::splat(0.3)).expect("some direction");
        assert_eq!((sample.radiance, black.mean()), (Vec3::ZERO, Vec3::ZERO));
        assert!(sample.pdf > 0.0);
    }
}
