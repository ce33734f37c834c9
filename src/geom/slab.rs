//! The slab test: where a ray enters and leaves an axis-aligned box.
//!
//! # Why it is conservative
//! The distance to a plane is computed as `(plane - origin) * inverse`: four roundings, of the
//! inverse, of that times its slack, of the difference and of the product, each by half an ulp at
//! most, so that it is off by some 2 ulps relatively, wherever the origin. Near planes are
//! multiplied with the inverse lowered by 4 ulps, far planes with it raised by 4: for planes ahead
//! of the origin, `enter` is then below and `exit` above the true value, and planes behind it do
//! not matter since hits lie at `t > 0`. Where the ray runs along an axis' planes the inverse is a
//! huge finite number, 2^126, and the ray is inside by comparison alone; the slack of [`own_box`]
//! keeps a ray inside that runs exactly in a face, for 2^36 directions at least. Beyond that the
//! number is not huge enough, and [`SlabRay::is_beyond`] tells.
//!
//! # Why it is monotone
//! Subtraction and multiplication round monotonically, minimum and maximum are exact. So a box
//! that contains another has `enter` no larger and `exit` no smaller, in floating point, not only
//! in theory: a hit inside its triangle's own box is inside every box around it.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x4};

use super::{Corners, Triangle};
use crate::math::{Aabb, Ray, Vec3, larger, smaller};

/// A ray, prepared for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay {
    /// The ray's origin; here and below, the last has no meaning.
    pub origin: [f32; 4],
    /// Reciprocal direction for near planes.
    pub inv_near: [f32; 4],
    /// Reciprocal direction for far planes.
    pub inv_far: [f32; 4],
    /// 1 for each axis along which the ray goes down (negative zero included), else 0.
    pub negative: [usize; 3],
}

impl SlabRay {
    /// Four units in the last place of a number in [1, 2).
    pub(super) const SLACK: f32 = 4.0 * f32::EPSILON;
    /// 2^-126: components of directions are no smaller here. Not denormal: to divide by those
    /// takes many times as long, and lanes that have no meaning, zeros, are divided by too.
    pub(super) const SMALLEST: f32 = f32::MIN_POSITIVE;

    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let direction = ray.direction();
        let inverse = Vec3::new(recip(direction.x), recip(direction.y), recip(direction.z));
        Self {
            origin: pad(ray.origin()),
            inv_near: pad(inverse * (1.0 - Self::SLACK)),
            inv_far: pad(inverse * (1.0 + Self::SLACK)),
            negative: [
                usize::from(direction.x.is_sign_negative()),
                usize::from(direction.y.is_sign_negative()),
                usize::from(direction.z.is_sign_negative()),
            ],
        }
    }

    /// The interval of `t` inside the box, not clipped to the ray's own; it misses if the first is
    /// above the second.
    #[inline(always)]
    pub fn interval(&self, bounds: &Aabb) -> (f32, f32) {
        let (lo, hi) = (bounds.min, bounds.max);
        let pick = |axis: usize| {
            if self.negative[axis] == 0 { (lo[axis], hi[axis]) } else { (hi[axis], lo[axis]) }
        };
        let (nx, fx) = pick(0);
        let (ny, fy) = pick(1);
        let (nz, fz) = pick(2);
        let near = |axis: usize, plane: f32| (plane - self.origin[axis]) * self.inv_near[axis];
        let far = |axis: usize, plane: f32| (plane - self.origin[axis]) * self.inv_far[axis];
        (
            larger(larger(near(0, nx), near(1, ny)), near(2, nz)),
            smaller(smaller(far(0, fx), far(1, fy)), far(2, fz)),
        )
    }

    /// Whether a triangle's own box ends, at `exit`, only because a component of zero had to be
    /// taken for another: hits at `t` behind that do not count.
    ///
    /// Elsewhere a hit lies in its own box but for rounding, and is moved into it. To move it
    /// across space would take it away from its triangle, where no structure but brute force looks
    /// for it.
    #[inline(always)]
    pub fn is_beyond(&self, t: f32, exit: f32) -> bool {
        let [x, y, z] = [0, 1, 2].map(|axis| self.inv_near[axis].abs());
        t > exit && exit >= FARTHEST_ALONG && larger(larger(x, y), z) >= INVERSE_ALONG
    }

    /// The interval inside the [`own_box`] of a triangle: the same arithmetic, its axes side by
    /// side.
    #[inline(always)]
    pub fn own_interval<S: Simd>(&self, simd: S, corners: &impl Corners) -> (f32, f32) {
        let [x, y, z] = [corners.along(0), corners.along(1), corners.along(2)];
        let corner = |i: usize| f32x4::load_array(simd, [x[i], y[i], z[i], 0.0]);
        let (a, b, c) = (corner(0), corner(1), corner(2));
        let slack = |p: f32x4<S>| (p.abs() * RELATIVE_SLACK).max(ABSOLUTE_SLACK);
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        let (lo, hi) = (lo - slack(lo), hi + slack(hi));
        let load = |values: &[f32; 4]| f32x4::load_array(simd, *values);
        let (origin, inv_near, inv_far) =
            (load(&self.origin), load(&self.inv_near), load(&self.inv_far));
        let down = inv_near.simd_lt(0.0);
        let near = (down.select(hi, lo) - origin) * inv_near;
        let far = (down.select(lo, hi) - origin) * inv_far;
        (larger(larger(near[0], near[1]), near[2]), smaller(smaller(far[0], far[1]), far[2]))
    }
}

#[inline(always)]
fn pad(v: Vec3) -> [f32; 4] {
    [v.x, v.y, v.z, 0.0]
}

/// The reciprocal with its magnitude limited to 2^126, so that it stays finite when it is raised.
#[inline(always)]
fn recip(x: f32) -> f32 {
    1.0 / x.abs().max(SlabRay::SMALLEST).copysign(x)
}

/// The box that a triangle's hits lie in by definition (see [`super::intersect_triangle()`]), and
/// that every structure must build with: that of its vertices, grown by 2^-22 of the coordinates,
/// at least by 2^-90, so that no box is flat.
#[inline(always)]
pub fn own_box(triangle: &Triangle) -> Aabb {
    let bounds = triangle.bounds();
    Aabb { min: bounds.min - slack(bounds.min), max: bounds.max + slack(bounds.max) }
}

/// The ends of own boxes along an axis, by those of the vertices: [`own_box`] lane by lane.
#[inline(always)]
pub fn grow_own_box<S: Simd, V: SimdFloat<S, Element = f32>>([lo, hi]: [V; 2]) -> [V; 2] {
    let slack = |p: V| (p.abs() * RELATIVE_SLACK).max(ABSOLUTE_SLACK);
    [lo - slack(lo), hi + slack(hi)]
}

#[inline(always)]
fn slack(p: Vec3) -> Vec3 {
    (p.abs() * RELATIVE_SLACK).max(Vec3::splat(ABSOLUTE_SLACK))
}

/// 2^35: a ray in a face leaves the slack around it later than that.
pub(super) const FARTHEST_ALONG: f32 = 34_359_738_368.0;
/// 2^126, lowered: the reciprocal of components of zero.
pub(super) const INVERSE_ALONG: f32 = (1.0 - SlabRay::SLACK) / SlabRay::SMALLEST;

const RELATIVE_SLACK: f32 = 2.0 * f32::EPSILON; // 2^-22
const ABSOLUTE_SLACK: f32 = 8.077936e-28; // 2^-90

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Isa, vectorized};
    use proptest::prelude::*;

    const INF: f32 = f32::INFINITY;

    fn interval(origin: [f32; 3], direction: [f32; 3], bounds: Aabb) -> (f32, f32) {
        SlabRay::new(&Ray::new(origin.into(), direction.into(), 0.0, INF)).interval(&bounds)
    }

    #[test]
    fn a_ray_along_an_axis_enters_and_leaves_the_unit_box() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let (enter, exit) = interval([-1.0, 0.5, 0.5], [1.0, 0.0, -0.0], unit);
        assert!((enter - 1.0).abs() < 1e-6 && (exit - 2.0).abs() < 1e-6);
        let (enter, exit) = interval([-1.0, 1.5, 0.5], [1.0, 0.0, 0.0], unit);
        assert!(enter > exit);
    }

    #[test]
    fn a_ray_in_the_face_of_an_own_box_is_inside() {
        let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
        let bounds = own_box(&triangle);
        for direction in [[0.0, 0.0, 1.0], [-0.0, -0.0, 1.0]] {
            let (enter, exit) = interval([1.0, 0.0, -3.0], direction, bounds);
            assert!(enter <= 3.0 && exit >= 3.0);
        }
    }

    fn point() -> impl Strategy<Value = Vec3> {
        let axis =
            prop_oneof![-1e3_f32..1e3, -1e-3_f32..1e-3, Just(0.0), Just(-0.0), -1e20_f32..1e20];
        [axis.clone(), axis.clone(), axis].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]
        #[test]
        fn a_box_around_a_box_has_the_wider_interval(
            a in point(), b in point(), c in point(), d in point(), o in point(), e in point()
        ) {
            let inner = Aabb::of_points([a, b]);
            let outer = inner.include(c).include(d);
            let slab = SlabRay::new(&Ray::new(o, e, 0.0, INF));
            let (ei, xi) = slab.interval(&inner);
            let (eo, xo) = slab.interval(&outer);
            prop_assert!(eo <= ei && xo >= xi);
        }

        #[test]
        fn the_axes_side_by_side_give_the_same(
            a in point(), b in point(), c in point(), o in point(), e in point()
        ) {
            let (triangle, slab) = (Triangle { a, b, c }, SlabRay::new(&Ray::new(o, e, 0.0, INF)));
            for isa in Isa::available() {
                let level = isa.level().expect("available");
                let own = vectorized!(level, simd => slab.own_interval(simd, &triangle));
                prop_assert_eq!(own, slab.interval(&own_box(&triangle)));
            }
        }

        #[test]
        fn a_point_of_the_box_lies_in_the_interval(
            a in point(), b in point(), o in point(), w in [0.0_f32..=1.0, 0.0..=1.0, 0.0..=1.0]
        ) {
            // Aim at a point of the box: by t = 1 the ray is there, up to the rounding of its
            // direction, which an own box's slack is not there to cover: grow by that.
            let bounds = Aabb::of_points([a, b]);
            let target = bounds.min + bounds.extent() * Vec3::from(w);
            let direction = target - o;
            let size = target.abs() + o.abs() + direction.abs();
            let rounding = size * (2.0 * f32::EPSILON) + slack(bounds.max);
            let grown = Aabb { min: bounds.min - rounding, max: bounds.max + rounding };
            let ray = Ray::new(o, direction, 0.0, INF);
            prop_assume!(ray != Ray::MISS);
            let (enter, exit) = SlabRay::new(&ray).interval(&grown);
            prop_assert!(enter <= 1.0 && exit >= 1.0, "{enter} {exit}");
        }
    }
}
