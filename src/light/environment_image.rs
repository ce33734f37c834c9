//! An environment's image: a map of latitude and longitude, sampled by importance.

use std::f32::consts::{FRAC_1_PI, PI};

use crate::math::{DVec3, Vec2, Vec3};
use crate::sampling::Distribution2d;

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

/// A latitude-longitude map, looked up bilinearly.
#[derive(Debug)]
pub struct EnvironmentImage {
    width: usize,
    height: usize,
    /// Rows from +Y down, the scale multiplied in.
    pixels: Vec<[f32; 3]>,
    /// Over the unit square of cells, see [`EnvironmentImage::locate`]; constant in each.
    distribution: Distribution2d,
    /// Cosine and sine of the rotation about +Y.
    rotation: (f32, f32),
}

impl EnvironmentImage {
    /// An image of radiance, turned by some degrees, and its mean over the sphere.
    pub fn new(
        width: usize,
        height: usize,
        pixels: Vec<[f32; 3]>,
        rotate_degrees: f32,
    ) -> (Self, Vec3) {
        let cells = Cells { width, height, pixels: &pixels };
        let mean = cells.spherical_mean();
        let distribution = Distribution2d::new(width, cells.rows(), &cells.importance())
            .expect("weights are finite and not all zero");
        let radians = rotate_degrees.to_radians();
        let image = Self {
            width,
            height,
            distribution,
            pixels,
            rotation: (libm::cosf(radians), libm::sinf(radians)),
        };
        (image, mean)
    }

    /// Rows of radiance from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The radiance from a unit direction, and the density over solid angle of sampling it.
    pub fn radiance_and_pdf(&self, direction: Vec3) -> (Vec3, f32) {
        let (uv, sine) = self.locate(direction);
        (self.look_up(uv), solid_angle_pdf(self.distribution.pdf(uv), sine))
    }

    /// Samples a direction by a uniform `u` in the unit square; `None` at the poles, where the
    /// density over solid angle is not finite.
    pub fn sample(&self, u: Vec2) -> Option<EnvironmentSample> {
        let (uv, density) = self.distribution.sample(u);
        let (direction, sine) = self.direction(uv);
        let pdf = solid_angle_pdf(density, sine);
        (pdf > 0.0).then(|| EnvironmentSample { direction, radiance: self.look_up(uv), pdf })
    }

    /// The point of the unit square of cells that a direction has, and the sine of its polar angle.
    /// A cell lies between four texels; the first column of cells starts at the first texels.
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
        let [a, b, c, d] = cells.corner_texels(column, row);
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
    fn corner_texels(&self, column: usize, row: usize) -> [Vec3; 4] {
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
                .map(|column| {
                    self.corner_texels(column, row).iter().map(|c| c.as_dvec3()).sum::<DVec3>()
                })
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
                let corners = self.corner_texels(column, row);
                0.25 * sine * corners.into_iter().map(brightness).sum::<f32>()
            }));
        }
        if weights.iter().all(|&weight| weight == 0.0) {
            return vec![1.0; weights.len()]; // black: any density will do
        }
        weights
    }
}
