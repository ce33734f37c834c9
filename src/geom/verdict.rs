//! The one triangle test that decides.
//!
//! Every structure, whatever it filters by, asks [`verdict`] in the end, and nothing else says what
//! `t`, `u` and `v` are. So the order of visits, the width and the instruction set can't matter.
//!
//! # What it decides
//! The watertight test of Woop, Benthin and Wald ("Watertight Ray/Triangle Intersection", JCGT
//! 2013) in f64 on the f32 vertices. Vertices are translated to the ray's origin and sheared so
//! that the ray becomes an axis: each vertex by itself, so that triangles that share it agree. The
//! sign of an edge's function is that of a difference of two products; rounding is monotone, so it
//! may round to zero but never to the wrong sign, and zero counts as inside on both sides of an
//! edge. A ray through the interior of a mesh therefore finds a triangle, at edges and vertices
//! too. In f64 no fallback for zeros is needed to tell how far.
//!
//! Where we differ: a triangle that is edge-on to within 2^-30, or flat, is missed, so that the
//! point at `t` is within 2^-20 of the triangle's size from the triangle itself, however grazing
//! the ray; a kd-tree with clipped triangles needs that. And the hit must lie in the triangle's own
//! box as the slab test sees it (see [`super::slab`]): `t` is clamped into that interval. This
//! makes all boxes around it agree.

use super::Triangle;
use super::slab::{SlabRay, own_box};
use crate::math::Ray;

/// A ray, prepared for verdicts.
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
        let a = d.abs();
        // The first of the largest. Without branches: which it is can't be guessed.
        let (y_wins, z_wins) = (usize::from(a.y > a.x), usize::from(a.z > a.x.max(a.y)));
        let z = y_wins + z_wins * (2 - y_wins);
        // The winding does not matter: either sign of the determinant is a hit.
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z];
        let scale = 1.0 / f64::from(d[z]);
        Self {
            origin: [f64::from(o.x), f64::from(o.y), f64::from(o.z)],
            axes,
            shear: [f64::from(d[axes[0]]) * scale, f64::from(d[axes[1]]) * scale, scale],
        }
    }

    /// A vertex with the ray as third axis: first and second coordinate, and `t`.
    #[inline(always)]
    fn project(&self, p: crate::math::Vec3) -> [f64; 3] {
        let at = |axis: usize| f64::from(p[self.axes[axis]]) - self.origin[self.axes[axis]];
        let z = at(2);
        [at(0) - self.shear[0] * z, at(1) - self.shear[1] * z, self.shear[2] * z]
    }
}

/// Where a ray meets a triangle: `t` and the barycentrics `u` and `v`, or nothing.
///
/// Not limited by the ray's own interval, apart from `t` being finite.
#[inline]
pub fn verdict(slab: &SlabRay, shear: &ShearRay, triangle: &Triangle) -> Option<[f32; 3]> {
    let a = shear.project(triangle.a);
    let b = shear.project(triangle.b);
    let c = shear.project(triangle.c);
    // Twice the signed areas that the ray's foot spans with each edge: weights of a, b and c.
    let (cb, bc) = (c[0] * b[1], c[1] * b[0]);
    let (ac, ca) = (a[0] * c[1], a[1] * c[0]);
    let (ba, ab) = (b[0] * a[1], b[1] * a[0]);
    let (wa, wb, wc) = (cb - bc, ac - ca, ba - ab);
    if (wa < 0.0 || wb < 0.0 || wc < 0.0) && (wa > 0.0 || wb > 0.0 || wc > 0.0) {
        return None;
    }
    let det = wa + wb + wc;
    let magnitude = cb.abs() + bc.abs() + ac.abs() + ca.abs() + ba.abs() + ab.abs();
    const EDGE_ON: f64 = 9.313225746154785e-10; // 2^-30
    if det.abs() <= EDGE_ON * magnitude {
        return None;
    }
    let distance = wa * a[2] + wb * b[2] + wc * c[2];
    let depth = a[2].abs().max(b[2].abs()).max(c[2].abs());
    if distance.abs() <= 32.0 * f64::EPSILON * magnitude * depth {
        return None;
    }
    let inv_det = 1.0 / det;
    let t = (distance * inv_det) as f32;
    let (enter, exit) = slab.interval(&own_box(triangle));
    // Also refuses a NaN, should a huge triangle have made one.
    if !(enter <= exit && t < f32::INFINITY) {
        return None;
    }
    Some([t.max(enter).min(exit), (wb * inv_det) as f32, (wc * inv_det) as f32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    const WALL: Triangle =
        Triangle { a: Vec3::ZERO, b: Vec3::new(4.0, 0.0, 0.0), c: Vec3::new(0.0, 4.0, 0.0) };

    fn ask(origin: [f32; 3], direction: [f32; 3], triangle: &Triangle) -> Option<[f32; 3]> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, f32::INFINITY);
        verdict(&SlabRay::new(&ray), &ShearRay::new(&ray), triangle)
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
