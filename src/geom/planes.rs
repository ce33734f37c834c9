//! The filter for few triangles and many rays: a triangle after the other against rays in lanes.
//!
//! Of each triangle is prepared what depends on it alone: its plane, which it may share with
//! others, and the gradients of the barycentrics `u` and `v`, as D. Baldwin and M. Weber have it
//! ("Fast Ray-Triangle Intersections by Coordinate Transformation", JCGT 2016). A ray meets the
//! plane at `t`, and `u` and `v` are dot products with the point there. Like [`super::block`] it
//! only filters: it never rejects what [`super::intersect_triangle()`] would accept.
//!
//! # The bound
//! Let `ε` be 2^-24, `|x|` the sum of a vector's magnitudes, `S` the largest `|x|` of all vertices,
//! `R = |o| + S`, and `n` the plane's unit normal. The computed `n · o + k` is off by less than
//! `6εR`, by the roundings of its coefficients and of its sums, and by `2εS` for others that share
//! the plane; `n · d` is off by less than `6ε|d|`. Rays with `|n · d| ≤ 2^-14 |d|` pass unseen, so
//! that in the others the quotient is known to first order: with `i = 1 / |n · d|`, and as
//! `|t||d| ≤ R` wherever a triangle is hit, `t` is off by less than `17εRi`, the point by less than
//! `26εRi|d|`, and what `u` is of it by less than `50 |U| εRi|d|`, with `U` its gradient: 23 of
//! them are its own roundings. The exact test's error adds little: where triangles are not thin,
//! its double precision leaves 2^-35 of `u` times `i|d|`, a thousandth of the above. We allow
//! `32εRi` for `t`, and twice that, times `|d|` and the gradient, for each of `u`, `v` and `u + v`.
//!
//! Of a plane across an axis, `n · o + k` is one subtraction of exact numbers, and `t` is off by
//! less than `4εt`. What is left is the error of the exact test, at most 2^-31 `Si` by the above,
//! and we allow no more where a ray begins: which spares rays that begin near such a wall an exact
//! test of it.
//!
//! What is so thin that gradients are large, above 2^14 over its size, passes unseen, and so do
//! rays that come from 2^20 times as far as the triangles reach, and those whose direction is not
//! within 2^-60 to 2^60 long. Triangles must reach to between 2^-40 and 2^40
//! ([`Reach`]). Then nothing overflows, and what underflows is far below any bound.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

use super::{RayLanes, Triangle};
use crate::math::{DVec3, Vec3};

/// 2^-14: of the direction's length, what it must have across a plane.
const FLATTEST: f32 = 6.103_515_6e-5;
/// 32 ε.
const RELATIVE: f32 = 16.0 * f32::EPSILON;

/// A plane with triangles in it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FilterPlane {
    /// The unit normal, and what the plane has along it. All zeros if its triangles are to pass
    /// unseen.
    normal: [f32; 4],
    /// How much of the slack it needs where a ray begins: 2^-12 if it is across an axis, else all.
    share: f32,
}

/// A triangle in a plane.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct FilterSides {
    /// Gradient and constant of `u` and of `v`.
    u: [f32; 4],
    v: [f32; 4],
    /// Twice the bounds of the lengths of the gradients of `u`, `v` and their sum.
    steepness: [f32; 3],
}

/// How far triangles reach: the largest sum of a vertex' magnitudes.
#[derive(Clone, Copy, Debug)]
pub struct Reach(f32);

impl Reach {
    /// That of triangles, if they reach as far as those that can be prepared.
    pub fn new(triangles: impl IntoIterator<Item = Triangle>) -> Option<Self> {
        const LIMIT: f32 = 1_099_511_627_776.0; // 2^40
        let far = |t: Triangle| [t.a, t.b, t.c].map(|p| p.abs().element_sum());
        let reach = triangles.into_iter().flat_map(far).fold(0.0, f32::max);
        (1.0 / LIMIT..=LIMIT).contains(&reach).then_some(Self(reach))
    }
}

impl FilterPlane {
    /// Prepares a triangle, and its plane.
    pub fn new(triangle: &Triangle) -> (Self, FilterSides) {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::as_dvec3);
        let (e1, e2) = (b - a, c - a);
        let n = e1.cross(e2);
        let (area, size) = (n.length(), (e1.length() + e2.length()));
        let square = area * area;
        let (u, v) = (e2.cross(n) / square, n.cross(e1) / square);
        let thinness = (u.length() + v.length()) * size;
        let row = |g: DVec3| [g.x as f32, g.y as f32, g.z as f32, -g.dot(a) as f32];
        let (u_length, v_length) = (2.0 * u.length() as f32, 2.0 * v.length() as f32);
        let steepness = [u_length, v_length, u_length + v_length];
        // Written so that what is not a number is refused.
        if thinness < 16384.0 {
            let normal = row(n / area);
            let across = (0..3).any(|axis| a[axis] == b[axis] && b[axis] == c[axis]);
            let share = if across { ACROSS } else { 1.0 };
            (Self { normal, share }, FilterSides { u: row(u), v: row(v), steepness })
        } else {
            let zeros = [0.0; 4];
            (NOWHERE, FilterSides { u: zeros, v: zeros, steepness: [0.0; 3] })
        }
    }

    /// Whether a triangle lies in the plane, to within what the bound has for it. One too thin for
    /// the bound does not: it must pass unseen.
    pub fn holds(self, triangle: &Triangle, Reach(reach): Reach) -> bool {
        if Self::new(triangle).0 == NOWHERE {
            return false;
        }
        let [x, y, z, k] = self.normal.map(f64::from);
        let off = |p: Vec3| (DVec3::new(x, y, z).dot(p.as_dvec3()) + k).abs();
        let most = if self.share == ACROSS { 0.0 } else { f64::from(reach * f32::EPSILON) };
        [triangle.a, triangle.b, triangle.c].into_iter().all(|p| off(p) <= most) && self != NOWHERE
    }
}

/// The share of planes across an axis: 2^-12.
const ACROSS: f32 = 1.0 / 4096.0;

/// The plane of what passes unseen.
const NOWHERE: FilterPlane = FilterPlane { normal: [0.0; 4], share: 1.0 };

/// Rays of one vector's lanes, prepared for the filter.
#[derive(Clone, Copy)]
pub struct FilterLanes<S: Simd> {
    origin: [S::f32s; 3],
    direction: [S::f32s; 3],
    t_min: S::f32s,
    t_max: S::f32s,
    /// The direction's length as the sum of its magnitudes.
    length: S::f32s,
    /// What `n · d` must be above.
    flattest: S::f32s,
    /// 32 ε R.
    slack: S::f32s,
}

/// Where lanes meet a plane.
#[derive(Clone, Copy)]
pub struct Meeting<S: Simd> {
    /// At what `t` at the earliest, and at the latest; without meaning where not `known`.
    pub first: S::f32s,
    /// See `first`.
    pub last: S::f32s,
    /// Whether that is known; if not, all of the plane's triangles pass.
    pub known: S::mask32s,
    /// Whether it is surely out of the ray's interval.
    outside: S::mask32s,
    point: [S::f32s; 3],
    /// How far off `point` may be.
    slack: S::f32s,
}

impl<S: Simd> FilterLanes<S> {
    /// Prepares those from lane `from` on, for triangles that reach so far.
    #[inline(always)]
    pub fn new(simd: S, rays: &RayLanes, from: usize, Reach(reach): Reach) -> Self {
        const SHORTEST: f32 = 8.673_617e-19; // 2^-60
        const LONGEST: f32 = 1.152_921_5e18; // 2^60
        const FARTHEST: f32 = 1_048_576.0; // 2^20
        let [[ox, oy, oz, t_min], [dx, dy, dz, t_max]] = rays.load(simd, from);
        let far = ox.abs() + oy.abs() + oz.abs();
        let length = dx.abs() + dy.abs() + dz.abs();
        let usual =
            far.simd_le(reach * FARTHEST) & length.simd_ge(SHORTEST) & length.simd_le(LONGEST);
        let never = S::f32s::splat(simd, f32::INFINITY);
        Self {
            origin: [ox, oy, oz],
            direction: [dx, dy, dz],
            t_min,
            t_max,
            length,
            flattest: usual.select(length * FLATTEST, never),
            slack: (far + reach) * RELATIVE,
        }
    }

    /// Where they meet a plane.
    #[inline(always)]
    pub fn meet(&self, simd: S, plane: &FilterPlane) -> Meeting<S> {
        const RAISED: f32 = 1.0 + 4.0 * f32::EPSILON;
        let FilterPlane { normal, share } = plane;
        let splat = |x: f32| S::f32s::splat(simd, x);
        let [o, d] = [self.origin, self.direction];
        let above = dot(simd, normal, o);
        let across =
            d[0].mul_add(splat(normal[0]), d[1].mul_add(splat(normal[1]), d[2] * normal[2]));
        let inverse = splat(-1.0) / across;
        let t = above * inverse;
        let t_slack = inverse.abs() * self.slack;
        let (first, last) = (t - t_slack, t_slack.mul_add(splat(*share), t * RAISED));
        Meeting {
            first,
            last,
            known: across.abs().simd_gt(self.flattest),
            outside: last.simd_lt(self.t_min) | first.simd_gt(self.t_max),
            point: [t.mul_add(d[0], o[0]), t.mul_add(d[1], o[1]), t.mul_add(d[2], o[2])],
            slack: t_slack * self.length,
        }
    }

    /// Where the rays begin and end.
    #[inline(always)]
    pub fn spans(&self) -> [S::f32s; 2] {
        [self.t_min, self.t_max]
    }
}

impl<S: Simd> Meeting<S> {
    /// Which of them may hit a triangle of the plane.
    #[inline(always)]
    pub fn find_candidates(&self, simd: S, sides: &FilterSides) -> S::mask32s {
        let splat = |x: f32| S::f32s::splat(simd, x);
        let FilterSides { u, v, steepness } = sides;
        let (u, v) = (dot(simd, u, self.point), dot(simd, v, self.point));
        let w = (splat(1.0) - u) - v;
        let outside = self.slack.mul_add(splat(steepness[0]), u).simd_lt(0.0)
            | self.slack.mul_add(splat(steepness[1]), v).simd_lt(0.0)
            | self.slack.mul_add(splat(steepness[2]), w).simd_lt(0.0)
            | self.outside;
        !(outside & self.known)
    }
}

/// A dot product, and a constant.
#[inline(always)]
fn dot<S: Simd>(simd: S, row: &[f32; 4], p: [S::f32s; 3]) -> S::f32s {
    let splat = |x: f32| S::f32s::splat(simd, x);
    let z = p[2].mul_add(splat(row[2]), splat(row[3]));
    p[0].mul_add(splat(row[0]), p[1].mul_add(splat(row[1]), z))
}

#[cfg(test)]
mod tests {
    use fearless_simd::SimdMask;
    use proptest::prelude::*;

    use super::*;
    use crate::geom::intersect_triangle::intersect;
    use crate::math::Ray;
    use crate::simd::{Isa, vectorized};

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -2.0_f32..2.0,
            1 => Just(0.0_f32),
            1 => Just(1.0_f32),
            1 => -1e-6_f32..1e-6,
            1 => 1e4_f32..1.0001e4,
        ]
    }

    fn point() -> impl Strategy<Value = Vec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig {
            cases: 20_000, max_global_rejects: 200_000, ..ProptestConfig::default()
        })]
        #[test]
        fn what_the_exact_test_takes_is_never_stopped(
            a in point(), b in point(), c in point(), origin in point(), beside in point(),
            w in [0.0_f32..=1.0, 0.0_f32..=1.0], on_edge in 0..5,
            exponent in -20_i32..20, length in -80_i32..80,
        ) {
            // Aimed at the inside, an edge or a vertex, or along the plane, at any scale.
            let (u, v) = match on_edge {
                0 => (w[0] * (1.0 - w[1]), w[1]),
                1 => (w[0], 1.0 - w[0]),
                2 => (w[0], 0.0),
                _ => (1.0, 0.0),
            };
            let power = |e: i32| f32::from_bits(((e + 127) as u32) << 23);
            let scale = power(exponent);
            let origin = if on_edge == 4 { a + (b - c) + beside * 1e-6 } else { origin };
            let target = a * (1.0 - u - v) + b * u + c * v;
            let direction = (target - origin) * power(length);
            let ray = Ray::new(origin * scale, direction, 0.0, f32::INFINITY);
            prop_assume!(ray != Ray::MISS);
            let triangle = Triangle { a: a * scale, b: b * scale, c: c * scale };
            let Some([t, ..]) = intersect(&ray, &triangle) else { return Ok(()) };
            prop_assume!(t > 0.0 && t.is_normal());
            // Barely long enough.
            let ray = Ray::new(ray.origin(), ray.direction(), 0.0, t);
            let reach = Reach::new([triangle]);
            prop_assume!(reach.is_some());
            let reach = reach.unwrap();
            for isa in Isa::available() {
                let level = isa.level().expect("available");
                let (plane, sides) = FilterPlane::new(&triangle);
                let (passes, known, first) = vectorized!(level, simd => {
                    let mut lanes = RayLanes::EMPTY;
                    lanes.fill(&[ray; RayLanes::LANES]);
                    let lanes = FilterLanes::new(simd, &lanes, 0, reach);
                    let met = lanes.meet(simd, &plane);
                    let passes = met.find_candidates(simd, &sides);
                    (passes.all_true(), met.known.any_true(), met.first[0])
                });
                prop_assert!(passes, "{}", isa);
                prop_assert!(!known || first <= t, "{}: {} after {}", isa, first, t);
            }
        }
    }
}
