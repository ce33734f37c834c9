//! An environment's image: a map of latitude and longitude, sampled by importance.

use std::f32::consts::{FRAC_1_PI, PI};

use crate::math::{DVec3, Vec3};
use crate::sampling::Distribution2d;
use crate::simd::lanes::{Float, Lanes, Mask, Uint, Vec3f, atan2, fetch, unit_circle};

/// Directions sampled by importance, one a lane.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentSamples<L: Lanes> {
    /// Unit directions that the light comes from.
    pub direction: Vec3f<L>,
    /// Radiance from there.
    pub radiance: Vec3f<L>,
    /// Density over solid angle; zero where there is no sample.
    pub pdf: L::Float,
}

/// This share of the mean brightness is left out where directions are chosen, and with it all that
/// is darker: paths that follow the scattering of surfaces find what is even, so that samples serve
/// better where it is bright. By measurements, of 0.5, 0.75 and 1.
///
/// Karlík, Šik, Vévoda, Skřivan and Křivánek, "MIS Compensation: Optimizing Sampling Techniques in
/// Multiple Importance Sampling", SIGGRAPH Asia 2019.
const EVEN_PART: f64 = 0.75;

/// A latitude-longitude map, looked up bilinearly.
#[derive(Clone, Debug)]
pub struct EnvironmentImage {
    width: u32,
    height: u32,
    /// Rows from +Y down: radiance, the scale multiplied in, and the density of samples, over the
    /// unit square, in the cell to the lower right of the texel.
    texels: Vec<[f32; 4]>,
    /// Over the unit square of cells, see [`EnvironmentImage::locate`]; constant in each.
    distribution: Distribution2d,
    /// Cosine and sine of the rotation about +Y.
    rotation: (f32, f32),
}

/// A point in a cell.
struct Place<L: Lanes> {
    column: L::Uint,
    row: L::Uint,
    across: L::Float,
    down: L::Float,
    /// Sine of the polar angle.
    sine: L::Float,
}

impl EnvironmentImage {
    /// An image of radiance, turned by some degrees, and its mean over the sphere.
    pub fn new(
        width: usize,
        height: usize,
        pixels: &[[f32; 3]],
        rotate_degrees: f32,
    ) -> (Self, Vec3) {
        let cells = Cells { width, height, pixels };
        let mean = cells.spherical_mean();
        let importance = cells.importance();
        let distribution = Distribution2d::new(width, cells.rows(), &importance)
            .expect("weights are finite and not all zero");
        let mut texels: Vec<_> = pixels.iter().map(|&[r, g, b]| [r, g, b, 0.0]).collect();
        for (texel, &weight) in texels.iter_mut().zip(&importance) {
            texel[3] = distribution.density(weight);
        }
        let radians = rotate_degrees.to_radians();
        let rotation = (libm::cosf(radians), libm::sinf(radians));
        let (width, height) = (width as u32, height as u32);
        (Self { width, height, texels, distribution, rotation }, mean)
    }

    /// Rows of radiance from the top.
    pub fn pixels(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.texels.iter().map(|&[r, g, b, _]| [r, g, b])
    }

    /// The radiance from unit directions, and the density over solid angle of sampling them.
    #[inline(always)]
    pub fn radiance_and_pdf_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        direction: Vec3f<L>,
    ) -> (Vec3f<L>, L::Float) {
        self.look_up(lanes, &self.locate(lanes, direction))
    }

    /// Samples directions by uniform numbers in the unit square; there is none at the poles, where
    /// the density over solid angle is not finite.
    #[inline(always)]
    pub fn sample_in_lanes<L: Lanes>(&self, lanes: L, u: [L::Float; 2]) -> EnvironmentSamples<L> {
        let cell = self.distribution.sample_in_lanes(lanes, u);
        let (across, down) = (cell.across, cell.down);
        let x = (cell.column.to_float() + across) / self.width as f32;
        let y = (cell.row.to_float() + down) / self.rows() as f32;
        let (direction, sine) = self.direction(x, y);
        let place = Place { column: cell.column, row: cell.row, across, down, sine };
        let (radiance, pdf) = self.look_up(lanes, &place);
        EnvironmentSamples { direction, radiance, pdf }
    }

    /// The place in a cell that a direction has. A cell lies between four texels; the first column
    /// of cells starts at the first texels.
    #[inline(always)]
    fn locate<L: Lanes>(&self, lanes: L, direction: Vec3f<L>) -> Place<L> {
        let (cos, sin) = self.rotation;
        let x = direction.x * cos - direction.z * sin;
        let z = direction.x * sin + direction.z * cos;
        let sine = (x * x + z * z).sqrt();
        let u = atan2(lanes, x, -z) * (0.5 * FRAC_1_PI) + self.first_column();
        let v = atan2(lanes, sine, direction.y) * FRAC_1_PI;
        let (x, y) = ((u - u.floor()) * self.width as f32, v * self.rows() as f32);
        let column = x.to_int().min(lanes.uint(self.width - 1));
        let row = y.to_int().min(lanes.uint(self.rows() - 1));
        Place { column, row, across: x - column.to_float(), down: y - row.to_float(), sine }
    }

    /// The direction of a point of the unit square of cells, and the sine of its polar angle.
    #[inline(always)]
    fn direction<L: Lanes>(&self, x: L::Float, y: L::Float) -> (Vec3f<L>, L::Float) {
        let (cosine, sine) = unit_circle::<L>(y * 0.5);
        let (c, s) = unit_circle::<L>(x - self.first_column());
        let (x, z) = (sine * s, -(sine * c));
        let (cos, sin) = self.rotation;
        (Vec3f::new(x * cos + z * sin, cosine, z * cos - x * sin), sine)
    }

    /// The share of the circle from the first column to the image's centre.
    fn first_column(&self) -> f32 {
        0.5 - 0.5 / self.width as f32
    }

    /// Rows of cells: at least one, also for an image of a single row.
    fn rows(&self) -> u32 {
        (self.height - 1).max(1)
    }

    /// Radiance, bilinear in the cell, and density over solid angle: the square maps to 2 pi by pi,
    /// and that to the sphere with the sine of the polar angle.
    #[inline(always)]
    fn look_up<L: Lanes>(&self, lanes: L, place: &Place<L>) -> (Vec3f<L>, L::Float) {
        let right = place.column + 1;
        let right = right.eq(self.width).select_uint(lanes.uint(0), right);
        let upper = place.row * self.width;
        let lower = (place.row + 1).min(lanes.uint(self.height - 1)) * self.width;
        let texel = |at: L::Uint| fetch(lanes, &self.texels, at);
        let [r, g, b, density] = texel(upper + place.column);
        let mix =
            |a: Vec3f<L>, b: Vec3f<L>, t: L::Float| a.scale(lanes.float(1.0) - t) + b.scale(t);
        let beside = Vec3f::of_columns(texel(upper + right));
        let below = Vec3f::of_columns(texel(lower + place.column));
        let across = Vec3f::of_columns(texel(lower + right));
        let above = mix(Vec3f::new(r, g, b), beside, place.across);
        let radiance = mix(above, mix(below, across, place.across), place.down);
        let zero = lanes.float(0.0);
        let pdf = density / (place.sine * (2.0 * PI * PI));
        (radiance, place.sine.gt(zero).select(pdf, zero))
    }
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

    /// A weight for each cell: what [`EVEN_PART`] leaves of the mean of the bilinear interpolant
    /// over it, which is that of its corners. So the slopes around a bright texel are chosen as
    /// often as they deserve.
    fn importance(&self) -> Vec<f32> {
        let brightness = |c: Vec3| {
            // NaN counts as nothing, infinity as much as leaves room to add.
            ((c.x.max(0.0) + c.y.max(0.0) + c.z.max(0.0)) / 3.0).min(f32::MAX / 64.0)
        };
        let mut weights = Vec::with_capacity(self.width * self.rows());
        let (mut sum, mut of_ones) = (0.0, 0.0);
        for row in 0..self.rows() {
            weights.extend((0..self.width).map(|column| {
                let corners = self.corner_texels(column, row);
                0.25 * corners.into_iter().map(brightness).sum::<f32>()
            }));
            let of_row = &weights[row * self.width..];
            let sine = f64::from(self.sine(row));
            sum += sine * of_row.iter().map(|&weight| f64::from(weight)).sum::<f64>();
            of_ones += sine * self.width as f64;
        }
        let even = (EVEN_PART * sum / of_ones) as f32;
        for (row, weights) in weights.chunks_exact_mut(self.width).enumerate() {
            let sine = self.sine(row);
            for weight in weights {
                *weight = (*weight - even).max(0.0) * sine;
            }
        }
        if weights.iter().all(|&weight| weight == 0.0) {
            // Black, or so dark that nothing is left: any density will do.
            return vec![1.0; weights.len()];
        }
        weights
    }
}
