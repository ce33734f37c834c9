//! The phase function: where a scattering sends light.

use std::f32::consts::FRAC_1_PI;

use crate::math::{Frame, Vec2, Vec3};
use crate::sampling::warp;

/// Henyey and Greenstein, "Diffuse radiation in the galaxy", Astrophysical Journal 93, 1941.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    g: f32,
}

impl HenyeyGreenstein {
    /// The largest magnitude of the mean cosine: beyond it, light goes on straight, or back, within
    /// what single precision tells apart.
    const MOST: f32 = 0.999;

    /// Scatters by the mean cosine `g`: above 0 on, below 0 back.
    pub fn new(g: f32) -> Self {
        Self { g: g.clamp(-Self::MOST, Self::MOST) }
    }

    /// The density per solid angle of going on from the direction of flight to one at that cosine
    /// to it; both its value and the density of [`HenyeyGreenstein::sample`].
    #[inline]
    pub fn eval(&self, cos: f32) -> f32 {
        let g = self.g;
        // 1 + g² - 2 g cos, without the cancellation where both are near one.
        let base = (1.0 - g.abs()) * (1.0 - g.abs()) + 2.0 * (g.abs() - g * cos);
        let base = base.max((1.0 - g.abs()) * (1.0 - g.abs()));
        0.25 * FRAC_1_PI * (1.0 - g * g) / (base * base.sqrt())
    }

    /// A direction to go on in from the unit `direction` of flight, and its density.
    #[inline]
    pub fn sample(&self, direction: Vec3, u: Vec2) -> (Vec3, f32) {
        let g = self.g;
        let cos = if g.abs() < 1e-3 {
            1.0 - 2.0 * u.y
        } else {
            let ratio = (1.0 - g * g) / (1.0 + g - 2.0 * g * u.y);
            ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
        };
        let ring = warp::unit_circle(u.x) * (1.0 - cos * cos).max(0.0).sqrt();
        let scattered = Frame::from_normal(direction).to_world(Vec3::new(ring.x, ring.y, cos));
        let scattered = scattered.normalize();
        (scattered, self.eval(scattered.dot(direction).clamp(-1.0, 1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;

    #[test]
    fn the_density_is_one_in_all_and_the_mean_cosine_is_g() {
        for g in [-0.9, -0.3, 0.0, 5e-4, 0.5, 0.9] {
            let phase = HenyeyGreenstein::new(g);
            let (mut all, mut mean) = (0.0_f64, 0.0_f64);
            let steps = 20_000;
            for i in 0..steps {
                let cos = -1.0 + 2.0 * (i as f32 + 0.5) / steps as f32;
                let share = f64::from(phase.eval(cos)) * std::f64::consts::TAU * 2.0;
                all += share / f64::from(steps);
                mean += share * f64::from(cos) / f64::from(steps);
            }
            assert!((all - 1.0).abs() < 2e-4, "{g}: {all}");
            assert!((mean - f64::from(g)).abs() < 2e-4, "{g}: {mean}");
        }
    }

    /// Samples have the density that they say: the mean of 1 over it is the sphere's area, and the
    /// mean cosine is g.
    #[test]
    fn samples_follow_the_density() {
        let direction = Vec3::new(0.6, -0.48, 0.64);
        for g in [-0.7, 0.0, 0.4, 0.8] {
            let phase = HenyeyGreenstein::new(g);
            let (mut cosines, mut area) = (0.0_f64, 0.0_f64);
            let count = 100_000;
            for i in 0..count {
                let u = Sampler::independent(i, 0, 9).next_2d();
                let (scattered, pdf) = phase.sample(direction, u);
                assert!((scattered.length() - 1.0).abs() < 1e-5);
                cosines += f64::from(scattered.dot(direction)) / count as f64;
                area += 1.0 / (f64::from(pdf) * count as f64);
            }
            assert!((cosines - f64::from(g)).abs() < 0.01, "{g}: {cosines}");
            assert!((area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.05, "{g}: {area}");
        }
    }

    #[test]
    fn extremes_stay_finite() {
        for g in [-1.0, 1.0, -0.9999, 0.9999] {
            let phase = HenyeyGreenstein::new(g);
            for u in [Vec2::ZERO, Vec2::splat(0.5), Vec2::splat(0.999_999_9)] {
                let (direction, pdf) = phase.sample(Vec3::Y, u);
                assert!(direction.is_finite() && pdf.is_finite() && pdf > 0.0, "{g} {u}");
            }
        }
    }
}
