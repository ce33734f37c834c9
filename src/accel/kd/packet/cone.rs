//! The cone of a packet whose rays start at one point: the corner rays of a shaft.
//!
//! All rays of the packet have directions that are sums, with weights that are not negative, of the
//! directions of four corners, which lie a little outside of them all ([`crate::geom::shaft`]). So
//! whatever is linear in the direction and has one sign for all corners has it for all rays.
//!
//! *Planes.* With the origin at zero, a ray meets the plane `a = A` at `A / d_a`. Where no corner's
//! component is zero and all have the same signs, say up, then of two planes ahead `A / d_a (1 + e)
//! <= B / d_b` means `A (1 + e) d_b <= B d_a`: linear. If computed distances to the planes differ
//! by more than a factor of `1 + 2^-18` for all four corners, then the true ones do for all rays,
//! but for 2^-20, and so do the computed ones of all rays, which are within 2^-22 of the true.
//! (Planes behind, and at, the origin have no positive distances, for corners and rays alike: the
//! difference of coordinates is the same float for all. Products that underflow are below the
//! tree's slack, as for single rays.)
//!
//! *Triangles.* A ray passes an edge from `p` to `q` on the side that `d · (p × q)` has the sign
//! of: linear. If it is above zero for all corners and one edge, and below zero for all corners and
//! another, by more than the rounding of double precision, then the exact test sees edges of both
//! signs for each ray, and takes none.

use crate::geom::{Shaft, Triangle};
use crate::math::{DVec3, Vec3};

pub struct Cone {
    origin: Vec3,
    corners: [Vec3; 4],
    inverse: [[f32; 4]; 3],
}

/// Distances of a plane along the corners.
pub type Distances = [f32; 4];

/// Distances that differ by less are not told apart: 2^-18.
const MARGIN: f32 = 3.8146973e-6;

impl Cone {
    /// How many corners it has.
    pub const CORNERS: u64 = 4;

    /// That of a shaft, if its rays start at one point and its corners all go the same way along
    /// each axis.
    pub fn of(shaft: &Shaft) -> Option<Self> {
        let (origin, corners) = shaft.cone()?;
        let mut inverse = [[0.0; 4]; 3];
        for axis in 0..3 {
            let up = corners[0][axis] > 0.0;
            for (corner, inverse) in corners.iter().zip(&mut inverse[axis]) {
                let component = corner[axis];
                // Not so small that a distance could overflow or the inverse be denormal.
                if component.abs() < 1e-12 || (component > 0.0) != up {
                    return None;
                }
                *inverse = 1.0 / component;
            }
        }
        Some(Self { origin, corners, inverse })
    }

    /// The distances of a plane.
    #[inline(always)]
    pub fn distances(&self, axis: usize, split: f32) -> Distances {
        self.inverse[axis].map(|inverse| (split - self.origin[axis]) * inverse)
    }

    /// Whether no ray hits a triangle.
    pub fn misses(&self, triangle: &Triangle) -> bool {
        /// More than the rounding of some twenty operations: 2^-44.
        const ROUNDING: f64 = 5.684341886080802e-14;
        let origin = self.origin.as_dvec3();
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(|p| p.as_dvec3() - origin);
        let size = |p: DVec3| p.abs().element_sum();
        let (mut above, mut below) = (false, false);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (normal, slack) = (p.cross(q), size(p) * size(q) * ROUNDING);
            let sides = self.corners.map(|corner| {
                let corner = corner.as_dvec3();
                (corner.dot(normal), size(corner) * slack)
            });
            above |= sides.iter().all(|&(side, slack)| side > slack);
            below |= sides.iter().all(|&(side, slack)| side < -slack);
        }
        above && below
    }
}

/// Whether the first distances are sure to be at or before the second along all rays.
#[inline(always)]
pub fn is_surely_before(a: &Distances, b: &Distances) -> bool {
    a.iter().zip(b).all(|(a, b)| *a <= 0.0 || a * (1.0 + MARGIN) <= *b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Heading;
    use crate::geom::intersect_triangle::intersect;
    use crate::math::{Aabb, Ray};
    use crate::simd::baseline;

    /// A raster of rays from a point, and its shaft.
    fn rays(eye: Vec3, towards: Vec3) -> (Vec<Ray>, Shaft) {
        let ray = |i: usize| {
            let across = Vec3::new(i as f32 % 8.0 - 3.5, (i / 8) as f32 - 3.5, 0.0) * 0.01;
            Ray::new(eye, towards + across, 0.0, f32::INFINITY)
        };
        let rays: Vec<Ray> = (0..64).map(ray).collect();
        let shaft = Shaft::of_rays(baseline(), &rays, 8).expect("they go the same way");
        (rays, shaft)
    }

    #[test]
    fn a_triangle_that_is_missed_by_the_cone_is_missed_by_all_rays() {
        let eye = Vec3::new(0.3, -0.2, 0.1);
        let (rays, shaft) = rays(eye, Vec3::new(0.4, 0.5, 1.0));
        let cone = Cone::of(&shaft).expect("it starts at a point");
        let target = eye + Vec3::new(0.4, 0.5, 1.0) * 2.0;
        let (mut missed, mut hit) = (0, 0);
        for i in 0..4000_u32 {
            let random =
                |k: u32| ((i * 9 + k).wrapping_mul(0x9e37_79b9) >> 8) as f32 / 16777216.0 - 0.5;
            let corner = |k: u32| target + Vec3::new(random(k), random(k + 1), random(k + 2)) * 0.5;
            let triangle = Triangle { a: corner(0), b: corner(3), c: corner(6) };
            let hits = rays.iter().any(|ray| intersect(ray, &triangle).is_some());
            assert!(!(hits && cone.misses(&triangle)), "{triangle:?}");
            missed += usize::from(cone.misses(&triangle));
            hit += usize::from(hits);
        }
        assert!(missed > 500 && hit > 500, "{missed} missed, {hit} hit");
    }

    #[test]
    fn rays_from_many_points_or_across_an_axis_have_no_cone() {
        assert!(Cone::of(&rays(Vec3::ZERO, Vec3::Z).1).is_none());
        let box_of = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert!(Cone::of(&Shaft::within(box_of).expect("a box")).is_none());
        let (rays, _) = rays(Vec3::ZERO, Vec3::ONE);
        let apart: Vec<Ray> = rays
            .iter()
            .enumerate()
            .map(|(i, ray)| Ray::new(Vec3::X * i as f32 * 1e-3, ray.direction(), 0.0, 1.0))
            .collect();
        let shaft = Shaft::of_rays(baseline(), &apart, 8).expect("they go the same way");
        assert!(Cone::of(&shaft).is_none());
        assert!(rays.iter().all(|ray| Heading::of(ray.direction()).negative == [0; 3]));
    }
}
