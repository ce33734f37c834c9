//! The filter for few triangles and many rays: a triangle after the other against rays in lanes.
//!
//! Of each triangle is prepared what depends on it alone: its plane, and the gradients of the
//! barycentrics `u` and `v`, as D. Baldwin and M. Weber have it ("Fast Ray-Triangle Intersections
//! by Coordinate Transformation", JCGT 2016). A ray meets the plane at `t`, and `u` and `v` are
//! dot products with the point there. Like [`super::block`] it only filters: it never rejects what
//! [`super::intersect_triangle()`] would accept.
//!
//! # The bound
//! Let `ε` be 2^-24, `|x|` the sum of a vector's magnitudes, `S` the largest `|x|` of all vertices,
//! `R = |o| + S`, and `n` the plane's unit normal. The computed `n · o + k` is off by less than
//! `6εR`, by the roundings of its coefficients and of its sums, and `n · d` by less than `6ε|d|`.
//! Rays with `|n · d| ≤ 2^-14 |d|` pass unseen, so that in the others the quotient is known to
//! first order: with `i = 1 / |n · d|`, and as `|t||d| ≤ R` wherever a triangle is hit, `t` is off
//! by less than `15εRi`, the point by less than `24εRi|d|`, and what `u` is of it by less than
//! `48 |U| εRi|d|`, with `U` its gradient. The exact test's own error is far smaller: it misses
//! what is edge-on, and what is left of its double precision then, 2^-24 of `u`, is no more than
//! `8 |U| εRi|d|`. We allow `256εRi`, of which each of `t`, `u`, `v` and `u + v` has its multiple.
//!
//! What is so thin that gradients are large, above 2^14 over its size, passes unseen, and so do
//! rays that come from 2^20 times as far as the triangles reach, and those whose direction is not
//! within 2^-60 to 2^60 long. Triangles must reach to between 2^-40 and 2^40
//! ([`TrianglePlanes::suit`]). Then nothing overflows, and what underflows is far below any bound.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat};

use super::{RayLanes, Triangle};
use crate::math::Vec3;

/// 2^-14: of the direction's length, what it must have across a plane.
const FLATTEST: f32 = 6.103_515_6e-5;
/// 256 ε.
const RELATIVE: f32 = 128.0 * f32::EPSILON;

/// A triangle, prepared for rays in lanes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TrianglePlanes {
    /// The normal, and what the plane has along it.
    plane: [f32; 4],
    /// Gradient and constant of `u` and of `v`.
    u: [f32; 4],
    v: [f32; 4],
    /// Bounds of the lengths of the gradients of `u`, `v` and their sum.
    steepness: [f32; 3],
}

impl TrianglePlanes {
    /// Whether triangles that reach that far, in the sum of a vertex' magnitudes, can be prepared.
    pub fn suit(reach: f32) -> bool {
        const LIMIT: f32 = 1_099_511_627_776.0; // 2^40
        (1.0 / LIMIT..=LIMIT).contains(&reach)
    }

    /// How far triangles reach.
    pub fn reach(triangles: impl IntoIterator<Item = Triangle>) -> f32 {
        let far = |t: Triangle| [t.a, t.b, t.c].map(|p| p.abs().element_sum());
        triangles.into_iter().flat_map(far).fold(0.0, f32::max)
    }

    /// Prepares a triangle.
    pub fn new(triangle: &Triangle) -> Self {
        let [a, b, c] = [triangle.a, triangle.b, triangle.c].map(Vec3::as_dvec3);
        let (e1, e2) = (b - a, c - a);
        let n = e1.cross(e2);
        let (area, size) = (n.length(), (e1.length() + e2.length()));
        let square = area * area;
        let (u, v) = (e2.cross(n) / square, n.cross(e1) / square);
        let steepest = (u.length() + v.length()) * size;
        // Also where a number is not one.
        if !(steepest < 16384.0) {
            let zeros = [0.0; 4];
            return Self { plane: zeros, u: zeros, v: zeros, steepness: [0.0; 3] };
        }
        let row = |g: crate::math::DVec3| {
            [g.x as f32, g.y as f32, g.z as f32, -g.dot(a) as f32]
        };
        let (u_length, v_length) = (u.length() as f32, v.length() as f32);
        let steepness = [u_length, v_length, u_length + v_length];
        Self { plane: row(n / area), u: row(u), v: row(v), steepness }
    }
}

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
    /// 256 ε R.
    slack: S::f32s,
}

/// Which lanes may hit a triangle, and where.
pub struct Candidates<S: Simd> {
    /// Whether they may.
    pub passes: <S::f32s as SimdBase<S>>::Mask,
    /// At what `t` at the earliest, and at the latest; without meaning where not `known`.
    pub t: [S::f32s; 2],
    /// Whether it was not passed unseen.
    pub known: <S::f32s as SimdBase<S>>::Mask,
}

impl<S: Simd> FilterLanes<S> {
    /// Prepares those from lane `from` on, for triangles that reach so far.
    #[inline(always)]
    pub fn new(simd: S, rays: &RayLanes, from: usize, reach: f32) -> Self {
        const SHORTEST: f32 = 8.673_617e-19; // 2^-60
        const LONGEST: f32 = 1.152_921_5e18; // 2^60
        const FARTHEST: f32 = 1_048_576.0; // 2^20
        let [[ox, oy, oz, t_min], [dx, dy, dz, t_max]] = rays.load(simd, from);
        let far = ox.abs() + oy.abs() + oz.abs();
        let length = dx.abs() + dy.abs() + dz.abs();
        let usual = far.simd_le(reach * FARTHEST)
            & length.simd_ge(SHORTEST)
            & length.simd_le(LONGEST);
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

    /// Which of them may hit a triangle.
    #[inline(always)]
    pub fn find_candidates(&self, simd: S, triangle: &TrianglePlanes) -> Candidates<S> {
        let splat = |x: f32| S::f32s::splat(simd, x);
        let [o, d] = [self.origin, self.direction];
        let dot = |row: &[f32; 4], p: [S::f32s; 3], last: S::f32s| {
            let z = p[2].mul_add(splat(row[2]), last);
            p[0].mul_add(splat(row[0]), p[1].mul_add(splat(row[1]), z))
        };
        let TrianglePlanes { plane, u, v, steepness } = triangle;
        let above = dot(plane, o, splat(plane[3]));
        let across =
            d[0].mul_add(splat(plane[0]), d[1].mul_add(splat(plane[1]), d[2] * plane[2]));
        let inverse = splat(-1.0) / across;
        let t = above * inverse;
        let t_slack = inverse.abs() * self.slack;
        let slack = t_slack * self.length;
        let p = [t.mul_add(d[0], o[0]), t.mul_add(d[1], o[1]), t.mul_add(d[2], o[2])];
        let (u, v) = (dot(u, p, splat(u[3])), dot(v, p, splat(v[3])));
        let w = (splat(1.0) - u) - v;
        let u = slack.mul_add(splat(steepness[0]), u);
        let v = slack.mul_add(splat(steepness[1]), v);
        let w = slack.mul_add(splat(steepness[2]), w);
        let (first, last) = (t - t_slack, t + t_slack);
        let outside = u.simd_lt(0.0)
            | v.simd_lt(0.0)
            | w.simd_lt(0.0)
            | last.simd_lt(self.t_min)
            | first.simd_gt(self.t_max);
        let known = across.abs().simd_gt(self.flattest);
        Candidates { passes: !(outside & known), t: [first, last], known }
    }

    /// Where the rays begin and end.
    #[inline(always)]
    pub fn spans(&self) -> [S::f32s; 2] {
        [self.t_min, self.t_max]
    }
}
