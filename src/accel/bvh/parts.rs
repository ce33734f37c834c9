//! Parts of triangles: boxes that hold some of a triangle only, and why nothing is missed by them.
//!
//! Early splits ([`super::early`]) and spatial splits ([`super::spatial`]) put a triangle into
//! several leaves, each with the box of a part of it. That a hit lies in its triangle's own box,
//! the argument of [`crate::accel`], does not help: it must lie in the box of one of the parts, as
//! the slab test sees it. So parts are grown by a margin, never beyond the triangle's own box.
//!
//! # Why a hit lies in the box of a part
//! Let u be 2^-24, `size` the longest edge of the triangle's box, and the z axis that of the
//! direction's largest component.
//!
//! *The exact test is near the triangle.* Take the foot of the ray among the projected vertices, as
//! they were rounded. The signs of the weights are right or zero, and a zero that should have been
//! negative puts the foot outside the projected triangle by a rounding error of distances from that
//! very edge. So there is a point P of the triangle that projects to the foot, up to errors that
//! are relative to distances from it along each axis, by some 2^-51. Let t' be the distance of P.
//! The exact test's distance is that of the point with the exact test's weights: a triangle is
//! missed that is edge-on to within 2^-30, so that the weights are off by at most 3 * 2^-52 * 2^30
//! in sum, and P's own by a third of that. Along z both distances differ by at most 2^-20 `size`,
//! and along x and y, where the ray goes no faster, by no more. (A clamp into the own box moves `t`
//! towards t', for P is in there.) So up to the rounding of `t` and errors of 2^-51 of the distance
//! along each axis, the point at `t` is within 2^-20 `size` = 16u `size` of P, wherever the ray
//! starts.
//!
//! *The slab test forgives relative errors.* It lowers the distance of near planes and raises that
//! of far ones by 2^-22 net of its own rounding ([`crate::geom::slab`]): more than the rounding of
//! `t`, 2^-24, and the errors in double precision take away. A plane that lies 16u `size` or more
//! beyond P is therefore passed in time, and only that absolute error has to be made up for.
//!
//! *The margin* is 32u `size` plus 2^-22 of the largest coordinate of the scene plus 2^-90. The
//! second term is for the rounding of the boxes themselves: of the clipping in double precision, of
//! its result to single, of the sum with the margin. Nothing adds up from split to split: a part is
//! clipped from the whole triangle each time, to its box cut a margin beyond the plane. If P is on
//! this side of the plane, it is a margin within the cut box, and within all cut before; so it is
//! in what is left, and a margin within the new box, or the own box ends before. There the own
//! box's plane bounds the part, and the clamp keeps `t` before it to the bit.
//!
//! *Which rays* this covers ([`Parts::covers`]). With directions of at most 2^48, `t` is so
//! large that 2^-149, the step of denormal numbers, is less than 2^-100 of space. The slab test
//! raises components below 2^-126 to that; a far plane is then left at `t` of 2^125 margins, more
//! than 2^102 of the largest coordinate: enough for origins up to 2^32 times as far as that, and
//! directions of at least 2^-64. Others, hardly ever met, test all triangles. Scenes with
//! coordinates above 2^100, whose distances might overflow, are never cut.

use super::prims::Prim;
use crate::geom::{Triangle, TriangleSource, clip_bounds};
use crate::math::{Aabb, Ray};

/// Which rays a tree with parts of triangles in its leaves is good for. All others must be offered
/// all triangles, whatever the boxes say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts {
    /// Largest coordinate of an origin.
    reach: f32,
}

impl Parts {
    const LONGEST: f32 = 281474976710656.0; // 2^48
    const SHORTEST: f32 = 5.421011e-20; // 2^-64

    /// Whether the ray is covered: see [`super::parts`].
    #[inline(always)]
    pub fn covers(&self, ray: &Ray) -> bool {
        let length = ray.direction().abs().max_element();
        let far = ray.origin().abs().max_element();
        far <= self.reach && (Self::SHORTEST..=Self::LONGEST).contains(&length)
    }
}

/// Cuts triangles into parts.
pub struct Cutter<'a> {
    source: &'a dyn TriangleSource,
    bounds: Aabb,
    /// What every margin is at least.
    floor: f32,
    reach: f32,
}

impl<'a> Cutter<'a> {
    /// 2^-19, or 32 half-ulps of one.
    const OF_SIZE: f32 = 1.9073486e-6;
    /// 2^-22.
    const OF_COORDINATES: f32 = 2.0 * f32::EPSILON;
    /// 2^-90.
    const ABSOLUTE: f32 = 8.077936e-28;
    /// 2^100.
    const LARGEST: f32 = 1.2676506e30;
    /// How much further than the scene's coordinates origins may be.
    const REACH: f32 = 4294967296.0; // 2^32

    /// For the triangles of a scene whose own boxes have the union `bounds`; `None` if they are too
    /// large to be cut.
    pub fn new(source: &'a dyn TriangleSource, bounds: Aabb) -> Option<Self> {
        let largest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let floor = largest * Self::OF_COORDINATES + Self::ABSOLUTE + source.slack();
        let reach = largest * Self::REACH;
        let can_be_cut = largest <= Self::LARGEST && source.boxes() == 0;
        can_be_cut.then_some(Self { source, bounds, floor, reach })
    }

    /// The box of all triangles.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// The rays that its parts are good for.
    pub fn parts(&self) -> Parts {
        Parts { reach: self.reach }
    }

    /// The triangle of a primitive, to be cut.
    #[inline]
    pub fn fetch_whole(&self, prim: &Prim) -> Whole {
        let triangle = self.source.triangle(prim.id);
        let size = triangle.bounds().extent().max_element();
        Whole { triangle, margin: size * Self::OF_SIZE + self.floor }
    }

    /// The parts of a primitive below and above a plane, if there are any.
    pub fn cut(&self, prim: &Prim, axis: usize, plane: f32) -> [Option<Prim>; 2] {
        let halves = self.fetch_whole(prim).cut(&prim.bounds, axis, plane);
        halves.map(|half| half.map(|bounds| Prim { bounds, id: prim.id }))
    }
}

/// A triangle that is cut.
#[derive(Clone, Copy, Debug)]
pub struct Whole {
    /// The triangle that it is a part of.
    pub triangle: Triangle,
    /// How far the box of a part reaches beyond it.
    margin: f32,
}

impl Whole {
    /// The boxes of what is below and above a plane of the part in a box, if there is any.
    #[inline]
    pub fn cut(&self, part: &Aabb, axis: usize, plane: f32) -> [Option<Aabb>; 2] {
        let (mut below, mut above) = (*part, *part);
        below.max[axis] = below.max[axis].min(plane + self.margin);
        above.min[axis] = above.min[axis].max(plane - self.margin);
        [below, above].map(|cell| {
            if cell.is_empty() {
                return None;
            }
            let tight = clip_bounds(&self.triangle, &cell)?;
            let grown = Aabb { min: tight.min - self.margin, max: tight.max + self.margin };
            Some(grown.intersection(cell))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::intersect_triangle::intersect;
    use crate::geom::{SlabRay, TriangleList, own_box};
    use crate::math::{PrimId, Vec3};
    use proptest::prelude::*;

    /// Cuts a triangle in the middles of the longest edges of its parts.
    fn parts_of(triangle: Triangle, levels: u32) -> Vec<Aabb> {
        let list = TriangleList(vec![triangle]);
        let whole = Prim { bounds: own_box(&triangle), id: PrimId(0) };
        let cutter = Cutter::new(&list, whole.bounds).expect("of moderate size");
        let mut parts = vec![whole];
        for _ in 0..levels {
            let cut = |part: &Prim| {
                let axis = part.bounds.longest_axis();
                cutter.cut(part, axis, part.bounds.centre()[axis])
            };
            parts = parts.iter().flat_map(cut).flatten().collect();
        }
        parts.iter().map(|part| part.bounds).collect()
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![-1.0_f32..1.0, -1e-6_f32..1e-6, Just(0.0), Just(-0.0), Just(1.0)]
    }

    fn point() -> impl Strategy<Value = Vec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn each_hit_is_in_the_box_of_a_part(
            a in point(), b in point(), c in point(), from in point(),
            (u, v) in (0.0_f32..=1.0, prop_oneof![0.0_f32..=1.0, Just(0.0), Just(1.0)]),
            away in prop_oneof![Just(1.0_f32), Just(100.0), Just(1e6)],
            scale in prop_oneof![Just(1.0_f32), Just(1e-20), Just(1e15)],
        ) {
            let triangle = Triangle { a: a * scale, b: b * scale, c: c * scale };
            let target = (a + (b - a) * u * v + (c - a) * u * (1.0 - v)) * scale;
            let origin = from * away * scale;
            let ray = Ray::new(origin, target - origin, 0.0, f32::INFINITY);
            prop_assume!(ray != Ray::MISS);
            let slab = SlabRay::new(&ray);
            if let Some([t, ..]) = intersect(&ray, &triangle) {
                let holds = |bounds: &Aabb| {
                    let (enter, exit) = slab.interval(bounds);
                    enter <= t && t <= exit
                };
                prop_assert!(parts_of(triangle, 6).iter().any(holds), "{t}");
            }
        }
    }

    #[test]
    fn parts_are_smaller_and_stay_within_the_own_box() {
        let long = Triangle { a: Vec3::ZERO, b: Vec3::ONE, c: Vec3::new(1.0, 1.0, 0.9) };
        let parts = parts_of(long, 5);
        let area: f64 = parts.iter().map(|part| part.half_area()).sum();
        let own = own_box(&long);
        assert!(parts.iter().all(|part| own.contains(*part)));
        assert!(area < 0.1 * own.half_area(), "{area}");
    }

    #[test]
    fn rays_with_huge_or_tiny_strides_or_from_afar_are_not_covered() {
        let list = TriangleList(vec![]);
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let parts = Cutter::new(&list, unit).expect("of moderate size").parts();
        let covers = |o: f32, d: f32| {
            parts.covers(&Ray::new(Vec3::splat(o), Vec3::splat(d), 0.0, f32::INFINITY))
        };
        assert!(covers(1e6, 1.0) && covers(0.0, 1e14) && covers(0.0, 1e-19));
        assert!(!covers(1e10, 1.0) && !covers(0.0, 1e15) && !covers(0.0, 1e-20));
        let huge = Aabb { min: Vec3::ZERO, max: Vec3::splat(1e31) };
        assert!(Cutter::new(&list, huge).is_none());
    }
}
