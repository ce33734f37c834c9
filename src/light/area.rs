//! Triangles that emit.

use crate::geom::Triangle;
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// A point on a triangle, sampled uniformly by area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleSample {
    /// The point.
    pub point: Vec3,
    /// Barycentric weights of the corners b and c.
    pub uv: Vec2,
    /// Unit normal of the front; zero for a triangle without area.
    pub normal: Vec3,
    /// The triangle's area, square metres; the density is one over it.
    pub area: f32,
}

/// Samples a point on `triangle` by a uniform `u` in the unit square.
#[inline]
pub fn sample_triangle(triangle: &Triangle, u: Vec2) -> TriangleSample {
    let uv = warp::triangle(u);
    let double_area = triangle.double_area();
    let length = double_area.length();
    TriangleSample {
        point: triangle.a * (1.0 - uv.x - uv.y) + triangle.b * uv.x + triangle.c * uv.y,
        uv,
        normal: if length > 0.0 { double_area / length } else { Vec3::ZERO },
        area: 0.5 * length,
    }
}

/// The density over solid angle, seen from `distance2` (squared metres) away, of the uniform
/// density over `area`; `cosine` is that between the direction and the light's normal, of any
/// sign. Infinite edge-on.
#[inline(always)]
pub fn area_to_solid_angle(area: f32, distance2: f32, cosine: f32) -> f32 {
    distance2 / (area * cosine.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_on_the_triangle() {
        let triangle = Triangle { a: Vec3::Y, b: Vec3::Y + Vec3::Z, c: Vec3::Y + Vec3::X };
        for (x, y) in [(0.0, 0.0), (0.999, 0.0), (0.5, 0.999), (0.3, 0.6)] {
            let sample = sample_triangle(&triangle, Vec2::new(x, y));
            assert_eq!((sample.normal, sample.area), (Vec3::Y, 0.5));
            let p = sample.point;
            assert!(p.x >= -1e-6 && p.z >= -1e-6 && p.x + p.z <= 1.0 + 1e-6, "{p}");
            assert!((p.y - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_density_integrates_to_one_over_the_triangle() {
        // A small far triangle of area A at distance d facing us fills A / d² steradians.
        let (area, distance2) = (0.5, 1e4);
        let pdf = area_to_solid_angle(area, distance2, -1.0);
        assert!((pdf * (area / distance2) - 1.0).abs() < 1e-6);
    }
}
