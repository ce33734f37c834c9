//! The exact ray-triangle test.
//!
//! Every structure, whatever it filters by, asks this test in the end: [`intersect_triangle`] for
//! one ray, or its twins for eight rays ([`super::RayBundle::intersect_triangle`]) and for sixteen
//! pairs of a ray and a triangle (`RayLanes::intersect_pairs`), which compute the same bits.
//! Nothing else says whether a triangle is hit and what `t`, `u` and `v` are, so the
//! order of visits, the width of vectors and the instruction set cannot change a hit.
//!
//! # The test
//! It is the watertight test of S. Woop, C. Benthin and I. Wald ("Watertight Ray/Triangle
//! Intersection", JCGT 2013), in f64 on f32 vertices. Vertices are translated to the ray's origin
//! and sheared so that the ray becomes an axis; each vertex is transformed by itself, so triangles
//! that share it agree. The sign of an edge function is that of a difference of two products.
//! Rounding is monotone: the difference may round to zero, but never to the wrong sign, and zero
//! counts as inside on both sides of an edge. So a ray through the interior of a mesh finds a
//! triangle, at edges and vertices too. In f64 no fallback for zeros is needed.
//!
//! It differs from the paper in three points. A triangle that is edge-on to within 2^-30, or flat,
//! is missed: then the point at `t` is within 2^-20 of the triangle's size from the triangle
//! itself, however grazing the ray, which a kd-tree with clipped triangles needs. A triangle whose
//! distance is zero within rounding is missed: a ray that begins on it does not hit it. And the hit
//! must lie in the triangle's own box as the slab test sees it ([`super::slab`]): `t` is clamped
//! into that interval, so that all boxes around the own box agree. For that, a ray in a plane of
//! the axes whose hit is more than 2^36 directions away may have to miss: [`SlabRay::is_beyond`].

use fearless_simd::{Simd, SimdBase, SimdCombine, SimdMask, SimdWiden, f32x4, f64x4, mask64x4};

use super::Corners;
use super::heading::permute_axes;
use super::slab::SlabRay;
use crate::math::{Ray, larger, smaller};

/// Determinants below this much of the magnitude of their terms may be zero: 2^-30.
pub(super) const EDGE_ON: f64 = 9.313225746154785e-10;
/// And distances below this much of theirs.
pub(super) const DISTANCE_BOUND: f64 = 32.0 * f64::EPSILON;

/// A ray, prepared for the exact test.
#[derive(Clone, Copy, Debug)]
pub struct ShearRay {
    origin: [f64; 3],
    /// The axes, permuted: the last is that of the direction's largest component.
    axes: [usize; 3],
    /// Shear along the first two axes, and scale of the last.
    shear: [f64; 3],
}

impl ShearRay {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let (o, d) = (ray.origin(), ray.direction());
        let axes = permute_axes(d);
        let d = [d.x, d.y, d.z, 0.0];
        let [x, y, z] = axes.map(|axis| f64::from(d[axis & 3]));
        let scale = 1.0 / z;
        Self {
            origin: [f64::from(o.x), f64::from(o.y), f64::from(o.z)],
            axes,
            shear: [x * scale, y * scale, scale],
        }
    }

    /// The vertices with the ray as third axis: of each, a lane, first and second coordinate, and
    /// `t`. The fourth lane has no meaning.
    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, corners: &impl Corners) -> [f64x4<S>; 3] {
        let [x, y, z] = self.axes;
        let x = self.project_along(simd, corners, x);
        let y = self.project_along(simd, corners, y);
        let z = self.project_along(simd, corners, z);
        [x - z * self.shear[0], y - z * self.shear[1], z * self.shear[2]]
    }

    /// The vertices' coordinates along an axis, from the ray's origin. (No closure: where one is
    /// not inlined, it is compiled for no instruction set.)
    #[inline(always)]
    fn project_along<S: Simd>(&self, simd: S, corners: &impl Corners, axis: usize) -> f64x4<S> {
        // It is below 3; where the compiler knows, it checks no bounds.
        let axis = axis.min(2);
        let [a, b, c] = corners.along(axis);
        let (low, high) = f32x4::load_array(simd, [a, b, c, 0.0]).widen();
        low.combine(high) - self.origin[axis]
    }
}

/// Where a ray meets a triangle: `t` and the barycentrics `u` and `v`, or nothing.
///
/// Not limited by the ray's own interval, apart from `t` being finite. The three vertices are
/// computed with side by side: additions and multiplications of one lane each, which round alike
/// at every instruction set.
#[inline(always)]
pub fn intersect_triangle<S: Simd>(
    simd: S,
    slab: &SlabRay,
    shear: &ShearRay,
    corners: &impl Corners,
) -> Option<[f32; 3]> {
    let [x, y, t] = shear.project(simd, corners);
    // Twice the signed areas that the ray's foot spans with each edge: weights of a, b and c. In
    // the fourth lane, a difference of equal products: zero.
    let next = |v: f64x4<S>| f64x4::load_array(simd, [v[1], v[2], v[0], v[3]]);
    let after = |v: f64x4<S>| f64x4::load_array(simd, [v[2], v[0], v[1], v[3]]);
    let (p, q) = (after(x) * next(y), after(y) * next(x));
    let weights = p - q;
    let sign = |mask: mask64x4<S>| mask.to_bitmask() != 0;
    if sign(weights.simd_lt(0.0)) && sign(weights.simd_gt(0.0)) {
        return None;
    }
    let sum = |v: f64x4<S>| v[0] + v[1] + v[2];
    let (det, magnitude) = (sum(weights), sum(p.abs() + q.abs()));
    if det.abs() <= EDGE_ON * magnitude {
        return None;
    }
    let distance = sum(weights * t);
    let depth = larger(larger(t[0].abs(), t[1].abs()), t[2].abs());
    if distance.abs() <= DISTANCE_BOUND * magnitude * depth {
        return None;
    }
    let inv_det = 1.0 / det;
    let t = (distance * inv_det) as f32;
    let (enter, exit) = slab.own_interval(simd, corners);
    // Also refuses a NaN, should a huge triangle have made one.
    if !(enter <= exit && t < f32::INFINITY) || slab.is_beyond(t, exit) {
        return None;
    }
    let [u, v] = [1, 2].map(|lane| (weights[lane] * inv_det) as f32);
    Some([smaller(larger(t, enter), exit), u, v])
}

/// The same for a ray that is not prepared.
#[cfg(test)]
pub fn intersect(ray: &Ray, triangle: &super::Triangle) -> Option<[f32; 3]> {
    let (slab, shear) = (SlabRay::new(ray), ShearRay::new(ray));
    intersect_triangle(crate::simd::baseline(), &slab, &shear, triangle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Triangle;
    use crate::math::Vec3;

    const WALL: Triangle =
        Triangle { a: Vec3::ZERO, b: Vec3::new(4.0, 0.0, 0.0), c: Vec3::new(0.0, 4.0, 0.0) };

    fn ask(origin: [f32; 3], direction: [f32; 3], triangle: &Triangle) -> Option<[f32; 3]> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, f32::INFINITY);
        intersect(&ray, triangle)
    }

    #[test]
    fn barycentrics_belong_to_the_second_and_third_vertex() {
        assert_eq!(ask([1.0, 2.0, -3.0], [0.0, 0.0, 1.0], &WALL), Some([3.0, 0.25, 0.5]));
        assert_eq!(ask([1.0, 2.0, 3.0], [0.0, 0.0, -2.0], &WALL), Some([1.5, 0.25, 0.5]));
        assert_eq!(ask([3.0, 2.0, -3.0], [0.0, 0.0, 1.0], &WALL), None);
    }

    #[test]
    fn edges_and_vertices_count() {
        for corner in [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [2.0, 2.0], [0.0, 1.0]] {
            let hit = ask([corner[0], corner[1], -1.0], [0.0, 0.0, 1.0], &WALL);
            assert_eq!(hit.map(|[t, ..]| t), Some(1.0), "{corner:?}");
        }
    }

    #[test]
    fn edge_on_and_flat_triangles_are_missed() {
        assert_eq!(ask([-1.0, 1.0, 0.0], [1.0, 0.0, 0.0], &WALL), None);
        let line = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::X * 2.0 };
        assert_eq!(ask([0.5, 0.0, -1.0], [0.0, 0.0, 1.0], &line), None);
        let point = Triangle { a: Vec3::X, b: Vec3::X, c: Vec3::X };
        assert_eq!(ask([1.0, 0.0, -1.0], [0.0, 0.0, 1.0], &point), None);
    }

    #[test]
    fn a_triangle_is_not_hit_from_a_point_on_it() {
        for i in 0..1000_u32 {
            let random = |k: u32| (i.wrapping_mul(2654435761).wrapping_add(k * 40503) >> 8) as f32;
            let unit = |k: u32| random(k) / 16777216.0;
            let (u, v) = (unit(1) * 0.5, unit(2) * 0.5);
            let direction = [unit(3) - 0.5, unit(4) - 0.5, unit(5) * 0.1];
            assert_eq!(ask([u * 4.0, v * 4.0, 0.0], direction, &WALL), None, "{direction:?}");
        }
    }

    #[test]
    fn scales_from_1e_minus_20_to_1e20_are_alike() {
        for scale in [1e-20_f32, 1e-6, 1.0, 1e6, 1e20] {
            let big = Triangle { a: WALL.a * scale, b: WALL.b * scale, c: WALL.c * scale };
            let [t, u, v] = ask([scale, 2.0 * scale, -3.0 * scale], [0.0, 0.0, 1.0], &big)
                .expect("the ray goes through the middle");
            assert!(
                (t / scale - 3.0).abs() < 1e-5 && (u - 0.25).abs() < 1e-6 && (v - 0.5).abs() < 1e-6
            );
        }
    }
}
