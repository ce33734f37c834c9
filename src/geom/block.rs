//! Blocks of triangles that one stream of vector instructions tests at once.
//!
//! [`BlockRef::find_candidates`] only filters: it may pass a triangle that is missed, but it never
//! rejects one that [`super::intersect_triangle()`] would accept. So width, instruction set and
//! rounding cannot change a hit.
//!
//! # The bound
//! The test is Möller and Trumbore's with the edge functions as dot products of `r = c × d`, `c`
//! the first vertex from the origin. Let `ε` be 2^-24, `|x|` the sum of a vector's magnitudes. Each
//! component of `c` is off by `ε|c|`, edges by `ε|e|`; a component of a cross product of x and y by
//! less than `4ε|x||y|` (two products, one difference, and the operands' own errors), and a dot
//! product adds as much again for each of its three terms. So an edge function `r · e` is off by
//! less than `16ε |c||d||e|`, the determinant and the distance `n · c`, with `n = e × e'`, by less
//! than `16ε |d||e||e'|` and `16ε |c||e||e'|`. We allow twice that. A product that underflows is
//! off by up to 2^-149 and may be multiplied by another operand: so each product of norms is raised
//! by the smallest normal number before it meets the third norm, and after. Where a bound is above
//! 2^100 something may have overflowed, and the lane passes unseen. Where the instruction set fuses
//! multiplication and addition, a rounding is spared: the bound stands.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask};

use super::{Corners, SlabRay, Triangle};
use crate::math::{PrimId, Ray, Vec3};

/// `W` triangles as structure of arrays. Unused places repeat a triangle, with no id.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct TriangleBlock<const W: usize> {
    /// For each vertex a, b, c and axis, in this order, the coordinates.
    pub vertices: [[f32; W]; 9],
    /// Whose they are.
    pub ids: [PrimId; W],
}

impl<const W: usize> TriangleBlock<W> {
    /// Without triangles.
    pub const EMPTY: Self = Self { vertices: [[0.0; W]; 9], ids: [PrimId::NONE; W] };

    /// Packs up to `W` triangles.
    ///
    /// # Panics
    /// If there are none or more than `W`.
    pub fn new(triangles: &[(PrimId, Triangle)]) -> Self {
        assert!((1..=W).contains(&triangles.len()), "a block holds 1 to {W} triangles");
        Self::fetch(triangles.len(), |lane| triangles[lane])
    }

    /// Packs the first `count` triangles that a function hands out, at least one and at most `W`.
    #[inline]
    pub fn fetch(count: usize, triangle: impl Fn(usize) -> (PrimId, Triangle)) -> Self {
        let mut block = Self::EMPTY;
        for lane in 0..W {
            let (id, triangle) = triangle(lane.min(count - 1));
            for (vertex, p) in [triangle.a, triangle.b, triangle.c].into_iter().enumerate() {
                for axis in 0..3 {
                    block.vertices[3 * vertex + axis][lane] = p[axis];
                }
            }
            if lane < count {
                block.ids[lane] = id;
            }
        }
        block
    }

    /// By its parts.
    #[inline(always)]
    pub fn parts(&self) -> BlockRef<'_, W> {
        BlockRef { vertices: &self.vertices, ids: &self.ids }
    }
}

/// A [`TriangleBlock`] by its parts, wherever these lie.
#[derive(Clone, Copy, Debug)]
pub struct BlockRef<'a, const W: usize> {
    /// See [`TriangleBlock::vertices`].
    pub vertices: &'a [[f32; W]; 9],
    /// See [`TriangleBlock::ids`].
    pub ids: &'a [PrimId; W],
}

impl<const W: usize> BlockRef<'_, W> {
    /// The triangle of a lane, left where it lies.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> impl Corners {
        Lane { vertices: self.vertices, lane: lane % W }
    }

    /// The triangle of a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> Triangle {
        let at = |vertex: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| self.vertices[3 * vertex + axis][lane]);
            Vec3::new(x, y, z)
        };
        Triangle { a: at(0), b: at(1), c: at(2) }
    }

    /// How many triangles it holds.
    #[inline]
    pub fn len(&self) -> usize {
        self.ids.iter().take_while(|&&id| id != PrimId::NONE).count()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bit `i` is set if triangle `i` may be hit at or before `t_max`; repeats may be set too.
    #[inline(always)]
    pub fn find_candidates<S, V>(&self, simd: S, ray: &Ray, t_max: f32) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let splat = |p: Vec3| [V::splat(simd, p.x), V::splat(simd, p.y), V::splat(simd, p.z)];
        let edges = self.edges::<S, V>(simd);
        let d_norm = V::splat(simd, ray.direction().abs().element_sum());
        let (o, d) = (splat(ray.origin()), splat(ray.direction()));
        let passes = edges.find_candidates([o, d], d_norm, V::splat(simd, t_max));
        let all = (1_u64 << W) - 1;
        (passes & all) as u32
    }

    /// The same where the vertices that the exact test will see may be off by `slack` along each
    /// axis.
    #[inline(always)]
    pub fn find_near<S, V>(&self, simd: S, ray: &Ray, t_max: f32, slack: f32) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        self.edges::<S, V>(simd).find_near_ray(simd, ray, t_max, slack)
    }

    /// Bit `i` is set if the ray enters the box from vertex `a` to vertex `b` of lane `i` at or
    /// before `t_max`.
    #[inline(always)]
    pub fn find_boxes<S, V>(&self, simd: S, slab: &SlabRay, t_max: f32) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let plane = |axis: usize, upper: usize, inverse: f32| {
            let planes = V::load_array_ref(simd, &self.vertices[3 * upper + axis]);
            (planes - V::splat(simd, slab.origin[axis])) * V::splat(simd, inverse)
        };
        let near = |axis: usize| plane(axis, slab.negative[axis], slab.inv_near[axis]);
        let far = |axis: usize| plane(axis, 1 - slab.negative[axis], slab.inv_far[axis]);
        let enter = near(0).max(near(1)).max(near(2));
        let exit = far(0).min(far(1)).min(far(2)).min(V::splat(simd, t_max));
        (enter.simd_le(exit).to_bitmask() & ((1_u64 << W) - 1)) as u32
    }

    #[inline(always)]
    fn edges<S, V>(&self, simd: S) -> Edges<V>
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let load =
            |vertex: usize, axis: usize| V::load_array_ref(simd, &self.vertices[3 * vertex + axis]);
        let corner = |vertex: usize| [load(vertex, 0), load(vertex, 1), load(vertex, 2)];
        Edges::new([corner(0), corner(1), corner(2)])
    }
}

/// What the filter needs of triangles: one in each lane, or the same in all.
#[derive(Clone, Copy)]
pub(super) struct Edges<V> {
    a: [V; 3],
    e1: [V; 3],
    e2: [V; 3],
    n: [V; 3],
    e1_norm: V,
    e2_norm: V,
}

impl<V> Edges<V> {
    /// Of triangles by their vertices.
    #[inline(always)]
    pub fn new<S: Simd>([a, b, c]: [[V; 3]; 3]) -> Self
    where
        V: SimdFloat<S, Element = f32>,
    {
        let e1 = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let e2 = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
        Self { a, e1, e2, n: cross(e1, e2), e1_norm: norm(e1), e2_norm: norm(e2) }
    }

    /// Bit `i` is set if lane `i` of rays, by origin, direction and the sum of the latter's
    /// magnitudes, may hit the triangle of its lane at or before `t_max`.
    #[inline(always)]
    pub fn find_candidates<S: Simd>(&self, rays: [[V; 3]; 2], d_norm: V, t_max: V) -> u64
    where
        V: SimdFloat<S, Element = f32>,
    {
        self.find(rays, d_norm, t_max, None)
    }

    /// The same for triangles whose vertices are off by `off` along each axis.
    ///
    /// A dot product with what is off by `off` along each axis is off by at most `off` times the
    /// sum of the other's magnitudes; that sum of a cross product is at most the product of both
    /// sums. So an edge function `c × d · e` is off by at most `off (|d| (|e| + 6 off) +
    /// 2 |c × d|)` besides rounding, since edges are off by twice as much as vertices; and the
    /// others likewise, with `|c|`.
    #[inline(always)]
    pub fn find_near<S: Simd>(&self, rays: [[V; 3]; 2], d_norm: V, t_max: V, off: V) -> u64
    where
        V: SimdFloat<S, Element = f32>,
    {
        self.find(rays, d_norm, t_max, Some(off))
    }

    /// The same of one ray.
    #[inline(always)]
    pub fn find_near_ray<S, const W: usize>(
        &self,
        simd: S,
        ray: &Ray,
        t_max: f32,
        slack: f32,
    ) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let splat = |p: Vec3| [V::splat(simd, p.x), V::splat(simd, p.y), V::splat(simd, p.z)];
        let d_norm = V::splat(simd, ray.direction().abs().element_sum());
        let rays = [splat(ray.origin()), splat(ray.direction())];
        // With what rounding takes off the bounds.
        let off = V::splat(simd, 1.001 * slack);
        let passes = self.find_near(rays, d_norm, V::splat(simd, t_max), off);
        (passes & ((1_u64 << W) - 1)) as u32
    }

    #[inline(always)]
    fn find<S: Simd>(&self, [o, d]: [[V; 3]; 2], d_norm: V, t_max: V, off: Option<V>) -> u64
    where
        V: SimdFloat<S, Element = f32>,
    {
        let d_sum = d_norm;
        const RELATIVE: f32 = 32.0 * 0.5 * f32::EPSILON;
        const LARGE: f32 = 1.2676506e30; // 2^100
        let Self { a, e1, e2, n, e1_norm, e2_norm } = *self;
        let splat = |x: f32| V::splat(t_max.token(), x);
        let c = [a[0] - o[0], a[1] - o[1], a[2] - o[2]];
        let r = cross(c, d);
        let (det, distance) = (dot(n, d), dot(n, c));
        let (u, v) = (dot(r, e2), -dot(r, e1));

        // Norms of the operands, for the bounds.
        let (d_norm, c_norm, tiny) = (d_norm * RELATIVE, norm(c), splat(f32::MIN_POSITIVE));
        let (cd, ee) = (c_norm.mul_add(d_norm, tiny), e1_norm.mul_add(e2_norm, tiny));
        // That of both edge functions together, allowed to each.
        let mut edge_slack = cd.mul_add(e1_norm + e2_norm, tiny);
        let mut det_slack = d_norm.mul_add(ee, tiny);
        let mut t_slack = (c_norm * splat(RELATIVE)).mul_add(ee, tiny);
        if let Some(off) = off {
            let (edges, twice) = (off.mul_add(splat(6.0), e1_norm + e2_norm), off + off);
            let c_twice = c_norm + c_norm;
            let moment = norm(r) + cd;
            edge_slack = off.mul_add(d_sum.mul_add(edges, moment + moment), edge_slack);
            det_slack = (d_sum * twice).mul_add(edges, det_slack);
            t_slack = (off * edges).mul_add(edges + c_twice, t_slack);
        }
        let uv_slack = edge_slack + det_slack;

        // The sign of the determinant makes all of one sign. Where it can't be told, or something
        // may have overflowed, the lane passes.
        let magnitude = det.abs();
        let (u, v) = (flip_sign(u, det), flip_sign(v, det));
        let distance = flip_sign(distance, det);
        let sure = magnitude.simd_gt(det_slack) & (uv_slack + t_slack).simd_le(splat(LARGE));
        let outside = u.simd_lt(-edge_slack)
            | v.simd_lt(-edge_slack)
            | (u + v).simd_gt(magnitude + uv_slack)
            | distance.simd_lt(-t_slack)
            | distance.simd_gt(t_max.mul_add(magnitude + det_slack, t_slack));
        !(outside & sure).to_bitmask()
    }
}

/// One triangle of a block, where it lies.
struct Lane<'a, const W: usize> {
    vertices: &'a [[f32; W]; 9],
    lane: usize,
}

impl<const W: usize> Corners for Lane<'_, W> {
    #[inline(always)]
    fn along(&self, axis: usize) -> [f32; 3] {
        [0, 3, 6].map(|vertex| self.vertices[vertex + axis][self.lane % W])
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
    let along = |y: usize, z: usize| a[y].mul_sub(b[z], a[z] * b[y]);
    [along(1, 2), along(2, 0), along(0, 1)]
}

#[inline(always)]
fn dot<S: Simd, V: SimdFloat<S, Element = f32>>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn norm<S: Simd, V: SimdFloat<S, Element = f32>>(a: [V; 3]) -> V {
    a[0].abs() + a[1].abs() + a[2].abs()
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch, f32x4};
    use proptest::prelude::*;

    use super::*;
    use crate::geom::intersect_triangle::intersect;

    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -2.0_f32..2.0,
            1 => Just(0.0_f32),
            1 => Just(1.0_f32),
            1 => -1e-6_f32..1e-6,
            1 => 1e5_f32..1.0001e5,
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
            a in point(), b in point(), c in point(), origin in point(),
            w in [0.0_f32..=1.0, 0.0_f32..=1.0], on_edge in 0..4, exponent in -60_i32..60,
        ) {
            // Aimed at the inside, an edge or a vertex, at any scale.
            let (u, v) = match on_edge {
                0 => (w[0] * (1.0 - w[1]), w[1]),
                1 => (w[0], 1.0 - w[0]),
                2 => (w[0], 0.0),
                _ => (1.0, 0.0),
            };
            let scale = f32::from_bits(((exponent + 127) as u32) << 23);
            let target = a * (1.0 - u - v) + b * u + c * v;
            let ray = Ray::new(origin * scale, (target - origin) * scale, 0.0, f32::INFINITY);
            prop_assume!(ray != Ray::MISS);
            let triangle = Triangle { a: a * scale, b: b * scale, c: c * scale };
            if let Some([t, ..]) = intersect(&ray, &triangle) {
                let block = TriangleBlock::<4>::new(&[(PrimId(0), triangle)]);
                let found = dispatch!(Level::new(), simd => {
                    block.parts().find_candidates::<_, f32x4<_>>(simd, &ray, t)
                });
                prop_assert_eq!(found, 0b1111);
            }
        }
    }
}
