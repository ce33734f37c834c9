//! A point of a surface: position with its error, normals, texture coordinates.

use super::Attributes;
use crate::geom::Triangle;
use crate::math::{DVec3, Frame, InstanceId, MaterialId, Ray, Vec2, Vec3};

/// Bounds the relative error of seven roundings in a row: `n u / (1 - n u)` with n = 7 and
/// u = 2^-24 (Higham).
pub(super) const GAMMA_7: f32 = 7.0 * HALF_ULP / (1.0 - 7.0 * HALF_ULP);
const HALF_ULP: f32 = 0.5 * f32::EPSILON;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where it is, world space.
    pub position: Vec3,
    /// Componentwise bound of the position's error: the point of the true plane that is meant
    /// lies within.
    pub position_error: Vec3,
    /// Unit geometric normal; the triangle is counter-clockwise seen from where it points.
    pub normal: Vec3,
    /// The shading frame; its normal is on the side of the geometric one.
    pub frame: Frame,
    /// What colours it there.
    pub attributes: Attributes,
    /// The placed mesh that it belongs to.
    pub instance: InstanceId,
    /// The triangle's number in the mesh.
    pub triangle: usize,
    /// The weights of the triangle's second and third corner, as in [`crate::accel::ClosestHit`].
    pub barycentrics: Vec2,
    /// The triangle's area, square metres.
    pub area: f32,
    /// What it is made of.
    pub material: MaterialId,
    /// Whether the ray arrived at the side that the geometric normal points to.
    pub front: bool,
    /// When the ray arrived, while the shutter was open: from 0 to 1.
    pub time: f32,
}

impl Surface {
    /// A point in space that light passes in the unit `direction` at a `time` of the shutter, as if
    /// a surface faced it there: rays leave it from where it is.
    pub fn point_in_space(position: Vec3, direction: Vec3, time: f32) -> Self {
        Self {
            barycentrics: Vec2::ZERO,
            position,
            position_error: Vec3::ZERO,
            normal: -direction,
            frame: Frame::from_normal(-direction),
            attributes: Attributes::NONE,
            instance: InstanceId::from_index(0),
            triangle: 0,
            area: 0.0,
            material: MaterialId::NONE,
            front: true,
            time,
        }
    }

    /// The ray from here in a unit `direction`, as far as it goes; does not meet this surface.
    #[inline(always)]
    pub fn ray_towards(&self, direction: Vec3) -> Ray {
        let origin = offset_origin(self.position, self.position_error, self.normal, direction);
        Ray::new(origin, direction, 0.0, f32::INFINITY)
    }
}

/// A point of a triangle in world space and the bound of its error (pbrt-v4, section 6.8).
///
/// The corners are taken as exact: structures intersect the very same rounded triangle, so that
/// what an instance's transform has rounded away is no error of the point against it. But their
/// exact test about it rounds too, in f64, however close to zero the coordinates are: `slack`
/// bounds that.
#[inline]
pub(super) fn triangle_point(triangle: &Triangle, u: f32, v: f32, slack: f32) -> (Vec3, Vec3) {
    let (a, b, c) = (triangle.a * (1.0 - u - v), triangle.b * u, triangle.c * v);
    (a + b + c, (a.abs() + b.abs() + c.abs()) * GAMMA_7 + slack)
}

/// `point` moved off its surface to the side that `towards` points to, just so far that it lies
/// on that side of the true surface whatever the error within `error` is (pbrt-v4, 6.8.5).
#[inline(always)]
pub(super) fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, towards: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let side = if towards.dot(normal) < 0.0 { -normal } else { normal };
    let moved = point + side * distance;
    // The sum's own rounding goes outwards too.
    let outward = |value: f32, way: f32| {
        if way > 0.0 {
            value.next_up()
        } else if way < 0.0 {
            value.next_down()
        } else {
            value
        }
    };
    Vec3::new(outward(moved.x, side.x), outward(moved.y, side.y), outward(moved.z, side.z))
}

/// The unit normal of a triangle's front, and its area.
#[inline]
pub(super) fn normal_and_area(triangle: &Triangle) -> (Vec3, f32) {
    let double_area = triangle.double_area();
    let length2 = double_area.length_squared();
    if length2 > 1e-30 && length2 < 1e30 {
        let length = length2.sqrt();
        return (double_area / length, 0.5 * length);
    }
    // Tiny or huge: the squares need a wider range.
    let (a, b, c) = (triangle.a.as_dvec3(), triangle.b.as_dvec3(), triangle.c.as_dvec3());
    let double_area = (b - a).cross(c - a);
    let normal = double_area.normalize_or(DVec3::Z).as_vec3();
    (normal, (0.5 * double_area.length()) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_origins_lie_beyond_the_error() {
        let point = Vec3::new(1000.0, -3.0, 1e-3);
        let error = point.abs() * GAMMA_7;
        for normal in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 2.0, -2.0) / 3.0] {
            for way in [normal, -normal] {
                let moved = offset_origin(point, error, normal, way);
                let beyond = (moved - point).as_dvec3().dot(way.as_dvec3());
                assert!(beyond >= f64::from(normal.abs().dot(error)), "{normal} {beyond}");
            }
        }
    }

    #[test]
    fn normals_of_triangles_of_any_size() {
        for scale in [1e-18, 1e-4, 1.0, 1e4, 1e15] {
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * scale);
            let [a, b, c] = corners;
            let (normal, area) = normal_and_area(&Triangle { a, b, c });
            assert_eq!(normal, Vec3::Z);
            assert!((area / (0.5 * scale * scale) - 1.0).abs() < 1e-5 || scale == 1e-18, "{area}");
        }
    }
}
