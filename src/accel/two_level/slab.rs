//! The space between two planes that holds all that moves.
//!
//! What turns stays about in a plane: a fan, a wheel. Its box is far larger where it stands
//! slanted. So rays are also held against the slab (T. L. Kay and J. T. Kajiya, "Ray Tracing
//! Complex Scenes", 1986) of the direction in which the points vary the least.

use glam::{DMat3, DVec3};

use crate::math::Vec3;

/// Points `p` of which `normal * p` lies between `low` and `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Of about unit length.
    pub normal: Vec3,
    /// The least product.
    pub low: f32,
    /// The largest.
    pub high: f32,
}

/// So often the guess at the direction is made better.
const ROUNDS: usize = 24;

impl Slab {
    /// What holds all of some points, and as much as `slack` around along each axis; `None` if that
    /// is not finite.
    pub fn of_points(points: impl Iterator<Item = Vec3> + Clone, slack: f32) -> Option<Self> {
        let normal = find_normal(points.clone().map(Vec3::as_dvec3)).as_vec3();
        let along = |point: Vec3| {
            f64::from(normal.x) * f64::from(point.x)
                + f64::from(normal.y) * f64::from(point.y)
                + f64::from(normal.z) * f64::from(point.z)
        };
        let ends = points.map(along).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| {
            [low.min(at), high.max(at)]
        });
        let room = 2.0 * f64::from(slack);
        let (low, high) = ((ends[0] - room) as f32, (ends[1] + room) as f32);
        (normal.is_finite() && low.is_finite() && high.is_finite()).then_some(Self {
            normal,
            low,
            high,
        })
    }
}

/// The direction of the least variance: that vector which the inverse of the covariance makes
/// longest, by the power method.
fn find_normal(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let count = points.clone().count().max(1) as f64;
    let mean = points.clone().fold(DVec3::ZERO, |sum, point| sum + point) / count;
    let mut covariance = DMat3::ZERO;
    for point in points {
        let off = point - mean;
        covariance += DMat3::from_cols(off * off.x, off * off.y, off * off.z);
    }
    let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
    let inverse = (covariance + DMat3::from_diagonal(DVec3::splat(1e-9 * trace))).inverse();
    let start = DVec3::new(0.48, 0.6, 0.64);
    (0..ROUNDS).fold(start, |guess, _| (inverse * guess).normalize_or(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slanted_disc_lies_between_planes_near_each_other() {
        let turned = glam::Quat::from_rotation_y(0.5);
        let point = |i: u16| {
            let (sine, cosine) = libm::sincosf(f32::from(i));
            turned * Vec3::new(cosine, sine, 0.01 * f32::from(i % 3)) + Vec3::X * 5.0
        };
        let points = || (0..500).map(point);
        let slab = Slab::of_points(points(), 0.001).expect("finite");
        assert!(slab.normal.dot(turned * Vec3::Z).abs() > 0.9999);
        assert!(slab.high - slab.low < 0.03, "{slab:?}");
        let inside = |at: f32| slab.low <= at && at <= slab.high;
        assert!(points().all(|point| inside(slab.normal.dot(point))));
        assert_eq!(Slab::of_points([Vec3::splat(f32::NAN)].into_iter(), 0.0), None);
    }
}
