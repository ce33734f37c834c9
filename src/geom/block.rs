//! Blocks of triangles that one vector instruction stream tests at once.
//!
//! [`TriangleBlock::candidates`] only filters: it may let a miss pass but never stops a triangle
//! that [`super::verdict`] would take. Width, instruction set and rounding can't change a hit.
//!
//! # The bound
//! The test is Möller and Trumbore's with the edge functions as dot products of `r = c × d`, `c`
//! the first vertex from the origin. Let `ε` be 2^-24, `|x|` the sum of a vector's magnitudes.
//! Each component of `c` is off by `ε|c|`, edges by `ε|e|`; a component of a cross product of
//! x and y by less than `4ε|x||y|` (two products, one difference, and the operands' own errors),
//! and a dot product adds as much again for each of its three terms. So an edge function
//! `r · e` is off by less than `16ε |c||d||e|`, the determinant and the distance `n · c`, with
//! `n = e × e'`, by less than `16ε |d||e||e'|` and `16ε |c||e||e'|`. We allow twice that and, for
//! underflow, a few times the smallest normal number. What is compared is also written so that a
//! NaN from an overflow passes.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};

use super::Triangle;
use crate::math::{Ray, TriangleId, Vec3};

/// `W` triangles as structure of arrays. Unused places repeat a triangle, with no id.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct TriangleBlock<const W: usize> {
    /// Per vertex a, b, c and axis, the coordinates.
    pub vertices: [[[f32; W]; 3]; 3],
    /// Whose they are.
    pub ids: [TriangleId; W],
}

impl<const W: usize> TriangleBlock<W> {
    /// Packs up to `W` triangles.
    ///
    /// # Panics
    /// If there are none or more than `W`.
    pub fn new(triangles: &[(TriangleId, Triangle)]) -> Self {
        assert!((1..=W).contains(&triangles.len()), "a block holds 1 to {W} triangles");
        let mut block = Self { vertices: [[[0.0; W]; 3]; 3], ids: [TriangleId::NONE; W] };
        for lane in 0..W {
            let (id, triangle) = triangles[lane.min(triangles.len() - 1)];
            for (vertex, p) in [triangle.a, triangle.b, triangle.c].into_iter().enumerate() {
                for axis in 0..3 {
                    block.vertices[vertex][axis][lane] = p[axis];
                }
            }
            if lane < triangles.len() {
                block.ids[lane] = id;
            }
        }
        block
    }

    /// The triangle of a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> Triangle {
        let [a, b, c] = &self.vertices;
        let at = |v: &[[f32; W]; 3]| Vec3::new(v[0][lane], v[1][lane], v[2][lane]);
        Triangle { a: at(a), b: at(b), c: at(c) }
    }

    /// How many triangles it holds.
    #[inline]
    pub fn len(&self) -> usize {
        self.ids.iter().take_while(|&&id| id != TriangleId::NONE).count()
    }

    /// Whether it holds none; never true.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bit `i` is set if triangle `i` may be hit at or before `t_max`; repeats may be set too.
    #[inline(always)]
    pub fn candidates<S, V>(&self, simd: S, ray: &Ray, t_max: f32) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        const RELATIVE: f32 = 32.0 * 0.5 * f32::EPSILON;
        const UNDERFLOW: f32 = 64.0 * f32::MIN_POSITIVE;
        let (o, d) = (ray.origin(), ray.direction());
        let splat = |x: f32| V::splat(simd, x);
        let load =
            |vertex: usize, axis: usize| V::load_array_ref(simd, &self.vertices[vertex][axis]);

        let a = [load(0, 0), load(0, 1), load(0, 2)];
        let e1 = [load(1, 0) - a[0], load(1, 1) - a[1], load(1, 2) - a[2]];
        let e2 = [load(2, 0) - a[0], load(2, 1) - a[1], load(2, 2) - a[2]];
        let c = [a[0] - splat(o.x), a[1] - splat(o.y), a[2] - splat(o.z)];
        let d = [splat(d.x), splat(d.y), splat(d.z)];
        let n = cross(e1, e2);
        let r = cross(c, d);
        let (det, distance) = (dot(n, d), dot(n, c));
        let (u, v) = (dot(r, e2), -dot(r, e1));

        // Norms of the operands, for the bounds.
        let d_norm = splat(ray.direction().abs().element_sum() * RELATIVE);
        let (c_norm, e1_norm, e2_norm) = (norm(c), norm(e1), norm(e2));
        let tiny = splat(UNDERFLOW);
        let (cd, ee) = (c_norm * d_norm, e1_norm * e2_norm);
        let (u_slack, v_slack) = (cd * e2_norm + tiny, cd * e1_norm + tiny);
        let det_slack = d_norm * ee + tiny;
        let t_slack = c_norm * ee * splat(RELATIVE) + tiny;

        // The sign of the determinant makes all of one sign; close to zero either may be right,
        // and where it is not told apart from zero every test must pass: slack covers both.
        let magnitude = det.abs();
        let (u, v) = (flip_sign(u, det), flip_sign(v, det));
        let distance = flip_sign(distance, det);
        let unsure = magnitude.simd_le(det_slack);
        let outside = u.simd_lt(-u_slack)
            | v.simd_lt(-v_slack)
            | (u + v).simd_gt(magnitude + det_slack + u_slack + v_slack)
            | distance.simd_lt(-t_slack)
            | distance.simd_gt(splat(t_max) * (magnitude + det_slack) + t_slack);
        let all = (1_u64 << W) - 1;
        ((!outside | unsure).to_bitmask() & all) as u32
    }
}

/// `x` with its sign turned where `sign` is negative.
#[inline(always)]
fn flip_sign<S: Simd, V: SimdFloat<S, Element = f32>>(x: V, sign: V) -> V {
    let signs = sign.to_bits() & V::Bits::splat(x.token(), 0x8000_0000);
    V::from_bits(x.to_bits() ^ signs)
}

#[inline(always)]
fn cross<S: Simd, V: SimdFloat<S, Element = f32>>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot<S: Simd, V: SimdFloat<S, Element = f32>>(a: [V; 3], b: [V; 3]) -> V {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn norm<S: Simd, V: SimdFloat<S, Element = f32>>(a: [V; 3]) -> V {
    a[0].abs() + a[1].abs() + a[2].abs()
}
