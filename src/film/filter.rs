//! Reconstruction filters, sampled by importance.
//!
//! A camera ray is not weighted by the filter but placed by it: an offset drawn with the filter as
//! its density contributes with weight 1, to its own pixel and no other. All filters here are
//! non-negative, so the weight is exactly 1, and a pixel's samples stay independent of its
//! neighbours': M. Ernst, M. Stamminger and G. Greiner, "Filter Importance Sampling", 2006.
//!
//! Each is a product of one function of x and the same of y, so two inversions of one distribution
//! function do. For the smooth ones the inverse is a table with straight lines between its entries.

use crate::math::Vec2;
use crate::names::choices;
use crate::simd::lanes::{Float, Lanes, Mask, Uint};
use std::sync::LazyLock;

/// The shape of a pixel.
///
/// The default is Blackman-Harris: at the same half-width as the Gaussian it is sharper (standard
/// deviation 0.42 pixels against 0.48), and where the Gaussian is cut off it goes to zero with its
/// first derivatives, so that it neither rings nor lets fine patterns alias through side lobes
/// (-92 dB). The box is for comparing with renderers that use it, and for pixel-exact tests.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PixelFilter {
    /// The unit square around the pixel's centre.
    Box,
    /// A Gaussian of standard deviation 0.5 pixels, lowered to reach zero at a radius of 1.5.
    Gaussian,
    /// The four-term Blackman-Harris window over a radius of 1.5 pixels.
    #[default]
    BlackmanHarris,
}

choices!(PixelFilter, "filter", [
    Box => "box",
    Gaussian => "gaussian",
    BlackmanHarris => "blackman-harris",
]);

impl PixelFilter {
    /// The farthest that an offset can be from the centre, in pixels along x or y.
    pub const fn radius(self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Gaussian | Self::BlackmanHarris => RADIUS as f32,
        }
    }

    /// An offset from the pixel's centre in pixels, with the filter as its density, for `u` in
    /// `[0, 1)` twice. Monotonic in each coordinate, so that stratified `u` stay stratified.
    #[inline]
    pub fn sample(self, u: Vec2) -> Vec2 {
        match self {
            Self::Box => u - Vec2::splat(0.5),
            Self::Gaussian => Vec2::new(GAUSSIAN.invert(u.x), GAUSSIAN.invert(u.y)),
            Self::BlackmanHarris => {
                Vec2::new(BLACKMAN_HARRIS.invert(u.x), BLACKMAN_HARRIS.invert(u.y))
            }
        }
    }
}

impl PixelFilter {
    /// [`PixelFilter::sample`] in lanes.
    #[inline(always)]
    pub fn sample_in_lanes<L: Lanes>(self, lanes: L, u: [L::Float; 2]) -> [L::Float; 2] {
        let inverse: &Inverse = match self {
            Self::Box => return [u[0] - 0.5, u[1] - 0.5],
            Self::Gaussian => &GAUSSIAN,
            Self::BlackmanHarris => &BLACKMAN_HARRIS,
        };
        inverse.invert_in_lanes(lanes, u)
    }
}

const RADIUS: f64 = 1.5;
const PIECES: usize = 1024;

static GAUSSIAN: LazyLock<Inverse> = LazyLock::new(|| Inverse::of(gaussian_cdf));
static BLACKMAN_HARRIS: LazyLock<Inverse> = LazyLock::new(|| Inverse::of(blackman_harris_cdf));

/// The inverse of a symmetric distribution function over `[-RADIUS, RADIUS]`.
///
/// Its left half is tabulated over `t = sqrt(2 u)` rather than `u`, because the filters end in
/// tails: equal steps of `u` would put everything beyond 1.38 pixels into one piece of the
/// Gaussian, and the chi-squared test below sees that.
struct Inverse {
    at: [f32; PIECES + 1],
}

impl Inverse {
    fn of(cdf: fn(f64) -> f64) -> Self {
        let mut at = [0.0; PIECES + 1];
        for (piece, value) in at.iter_mut().enumerate().take(PIECES) {
            let t = piece as f64 / PIECES as f64;
            // Bisection: 60 halvings leave nothing of the interval.
            let (mut below, mut above) = (-RADIUS, 0.0);
            for _ in 0..60 {
                let middle = 0.5 * (below + above);
                if cdf(middle) < 0.5 * t * t {
                    below = middle;
                } else {
                    above = middle;
                }
            }
            *value = below as f32;
        }
        Self { at }
    }

    /// [`Inverse::invert`] of two numbers a lane.
    #[inline(always)]
    fn invert_in_lanes<L: Lanes>(&self, lanes: L, [u, v]: [L::Float; 2]) -> [L::Float; 2] {
        let (x, y) = (Self::locate(lanes, u), Self::locate(lanes, v));
        let pair = |piece: usize| [self.at[piece], self.at[piece + 1], 0.0, 0.0];
        let [from_x, to_x, ..] = lanes.gather(x.0, pair);
        let [from_y, to_y, ..] = lanes.gather(y.0, pair);
        let left = [from_x + x.1 * (to_x - from_x), from_y + y.1 * (to_y - from_y)];
        let half = lanes.float(0.5);
        [u.lt(half).select(left[0], -left[0]), v.lt(half).select(left[1], -left[1])]
    }

    /// The piece of the table that holds `u`, and the position in it.
    #[inline(always)]
    fn locate<L: Lanes>(lanes: L, u: L::Float) -> (L::Uint, L::Float) {
        let rest = lanes.float(1.0) - u;
        let position = (u.least(rest) * 2.0).sqrt() * PIECES as f32;
        let piece = position.to_int().min(lanes.uint(PIECES as u32 - 1));
        (piece, position - piece.to_float())
    }

    #[inline]
    fn invert(&self, u: f32) -> f32 {
        let position = (2.0 * u.min(1.0 - u)).sqrt() * PIECES as f32;
        let piece = (position as usize).min(PIECES - 1);
        let (from, to) = (self.at[piece], self.at[piece + 1]);
        let left = from + (position - piece as f32) * (to - from);
        if u < 0.5 { left } else { -left }
    }
}

/// The part of `exp(-x²/2σ²) - exp(-r²/2σ²)`, σ = 0.5, left of `x`.
fn gaussian_cdf(x: f64) -> f64 {
    const SIGMA: f64 = 0.5;
    let scale = 1.0 / (SIGMA * std::f64::consts::SQRT_2);
    let cut = libm::exp(-0.5 * RADIUS * RADIUS / (SIGMA * SIGMA));
    // The Gaussian's integral from 0 is σ sqrt(π/2) erf(x / (σ sqrt 2)).
    let half =
        |x: f64| SIGMA * libm::sqrt(0.5 * std::f64::consts::PI) * libm::erf(x * scale) - cut * x;
    0.5 + 0.5 * half(x) / half(RADIUS)
}

/// The part of the Blackman-Harris window left of `x`: F. Harris, "On the Use of Windows for
/// Harmonic Analysis with the Discrete Fourier Transform", 1978, the minimum four-term window.
fn blackman_harris_cdf(x: f64) -> f64 {
    use std::f64::consts::PI;
    const A: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];
    let t = x / RADIUS;
    let waves: f64 =
        (1..4).map(|k| A[k] * libm::sin(PI * k as f64 * t) / (PI * k as f64)).sum::<f64>();
    0.5 + 0.5 * (t + waves / A[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cdf(filter: PixelFilter) -> fn(f64) -> f64 {
        match filter {
            PixelFilter::Box => |x| (x + 0.5).clamp(0.0, 1.0),
            PixelFilter::Gaussian => gaussian_cdf,
            PixelFilter::BlackmanHarris => blackman_harris_cdf,
        }
    }

    /// Numbers in [0, 1) from a 64-bit linear congruential generator.
    fn random(count: usize) -> impl Iterator<Item = f32> {
        let mut state = 0x2545_f491_4f6c_dd1d_u64;
        (0..count).map(move |_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f32 / 16777216.0
        })
    }

    #[test]
    fn offsets_are_distributed_as_the_filter() {
        // Chi-squared over 60 bins along x and as many along y, six tests in all. The 1 % point
        // for 59 degrees of freedom is 87.2; divided among six tests (Šidák) it is 96.5.
        const BINS: usize = 60;
        const COUNT: usize = 200_000;
        for filter in PixelFilter::ALL {
            let numbers: Vec<f32> = random(2 * COUNT).collect();
            let mut counts = [[0_u32; BINS]; 2];
            let width = 2.0 * filter.radius() / BINS as f32;
            for u in numbers.chunks_exact(2) {
                let offset = filter.sample(Vec2::new(u[0], u[1]));
                for (axis, count) in counts.iter_mut().enumerate() {
                    let bin = ((offset[axis] + filter.radius()) / width) as usize;
                    count[bin.min(BINS - 1)] += 1;
                }
            }
            let edge = |bin: usize| f64::from(bin as f32 * width - filter.radius());
            for axis in counts {
                let chi_squared: f64 = (0..BINS)
                    .map(|bin| {
                        let mass = cdf(filter)(edge(bin + 1)) - cdf(filter)(edge(bin));
                        let expected = mass * COUNT as f64;
                        let off = f64::from(axis[bin]) - expected;
                        // The outermost bins of Blackman-Harris expect less than one offset.
                        off * off / expected.max(5.0)
                    })
                    .sum();
                assert!(chi_squared < 96.5, "{filter}: {chi_squared}");
            }
        }
    }

    #[test]
    fn moments_are_those_of_the_filter() {
        // Standard deviations by numerical integration of the formulas.
        let expected = [(12.0_f64).sqrt().recip(), 0.4790, 0.4155];
        for (filter, expected) in PixelFilter::ALL.into_iter().zip(expected) {
            let strata = 100_000;
            let offsets = (0..strata).map(|i| {
                f64::from(filter.sample(Vec2::new((i as f32 + 0.5) / strata as f32, 0.5)).x)
            });
            let (sum, squares) =
                offsets.fold((0.0, 0.0), |(sum, squares), x| (sum + x, squares + x * x));
            let (mean, deviation) = (sum / strata as f64, (squares / strata as f64).sqrt());
            assert!(mean.abs() < 1e-5, "{filter}: {mean}");
            assert!((deviation - expected).abs() < 1e-3, "{filter}: {deviation}");
        }
    }

    #[test]
    fn offsets_rise_with_the_number_and_stay_within_the_radius() {
        for filter in PixelFilter::ALL {
            let mut last = -filter.radius();
            for i in 0..=65536_u32 {
                let u = (i as f32 / 65536.0).min(1.0 - f32::EPSILON / 2.0);
                let x = filter.sample(Vec2::new(u, u)).x;
                assert!(x >= last && x <= filter.radius(), "{filter}: {x} after {last}");
                last = x;
            }
            assert_eq!(filter.sample(Vec2::splat(0.5)), Vec2::ZERO);
        }
    }

    #[test]
    fn words_name_filters() {
        for filter in PixelFilter::ALL {
            assert_eq!(filter.to_string().parse(), Ok(filter));
        }
        let error = "tent".parse::<PixelFilter>().expect_err("no such filter");
        assert_eq!(
            error.to_string(),
            "no filter `tent`; there are box, gaussian and blackman-harris"
        );
    }
}
