//! The filter for triangles that move: many of them, each about on a straight line, against one
//! ray.

use fearless_simd::{Simd, SimdFloat};

use super::Triangle;
use super::block::Edges;
use crate::math::{Aabb, Ray, TriangleId, Vec3};

/// A triangle over a part of the time, in the world.
#[derive(Clone, Copy, Debug)]
pub struct MovingTriangle {
    /// At the beginning.
    pub from: Triangle,
    /// At the end.
    pub to: Triangle,
    /// No vertex is further off, along any axis, from where it would be if it went straight and
    /// evenly; and no own box further from those.
    pub slack: f32,
}

impl MovingTriangle {
    /// What holds it over all of the part.
    pub fn bounds(&self) -> Aabb {
        let Aabb { min, max } = self.from.bounds().union(self.to.bounds());
        // Twice, since it is rounded.
        Aabb { min: min - 2.0 * self.slack, max: max + 2.0 * self.slack }
    }
}

/// Up to `W` triangles over a part of the time. Those that are missing repeat the first, without
/// its id.
#[derive(Clone, Debug)]
pub struct MovingBlock<const W: usize> {
    /// Vertex by vertex and axis by axis, at the beginning.
    from: [[f32; W]; 9],
    /// From there to the end.
    way: [[f32; W]; 9],
    slack: f32,
    /// Whose they are.
    pub ids: [TriangleId; W],
}

impl<const W: usize> MovingBlock<W> {
    /// Of triangles, of which there is at least one.
    pub fn new(triangles: &[(TriangleId, MovingTriangle)]) -> Self {
        let mut block = Self {
            from: [[0.0; W]; 9],
            way: [[0.0; W]; 9],
            slack: triangles
                .iter()
                .map(|(_, triangle)| or_infinite(triangle.slack))
                .fold(0.0, f32::max),
            ids: [TriangleId::NONE; W],
        };
        for lane in 0..W {
            let (id, triangle) = triangles.get(lane).unwrap_or(&triangles[0]);
            let ends = triangle.from.corners().into_iter().zip(triangle.to.corners());
            for (vertex, (from, to)) in ends.enumerate() {
                let way: Vec3 = to - from;
                for axis in 0..3 {
                    block.from[3 * vertex + axis][lane] = from[axis];
                    block.way[3 * vertex + axis][lane] = way[axis];
                }
            }
            if lane < triangles.len() {
                block.ids[lane] = *id;
            }
        }
        block
    }

    /// Bit `i` is set if triangle `i` may be hit at or before `t_max`, at a place in the part from
    /// 0 to 1; repeats may be set too.
    #[inline(always)]
    pub fn find_near<S, V>(&self, simd: S, ray: &Ray, place: f32, t_max: f32) -> u32
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let place = V::splat(simd, place);
        let (a, b, c) = (self.at(simd, 0, place), self.at(simd, 1, place), self.at(simd, 2, place));
        Edges::new([a, b, c]).find_near_ray(simd, ray, t_max, self.slack)
    }

    /// A vertex of each, at a place in the part. (No closures: those that are not inlined are
    /// compiled for no instruction set.)
    #[inline(always)]
    fn at<S, V>(&self, simd: S, vertex: usize, place: V) -> [V; 3]
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let [x, y, z] = [3 * vertex, 3 * vertex + 1, 3 * vertex + 2];
        [self.row(simd, x, place), self.row(simd, y, place), self.row(simd, z, place)]
    }

    #[inline(always)]
    fn row<S, V>(&self, simd: S, row: usize, place: V) -> V
    where
        S: Simd,
        V: SimdFloat<S, Element = f32, Array = [f32; W]>,
    {
        let from = V::load_array_ref(simd, &self.from[row]);
        V::load_array_ref(simd, &self.way[row]).mul_add(place, from)
    }
}

/// A bound that is no number bounds nothing.
fn or_infinite(slack: f32) -> f32 {
    if slack.is_nan() { f32::INFINITY } else { slack }
}

#[cfg(test)]
mod tests {
    use fearless_simd::f32x8;
    use proptest::prelude::*;

    use super::*;
    use crate::geom::{ShearRay, SlabRay, intersect_triangle};
    use crate::math::InstanceId;
    use crate::simd::baseline;

    fn id(index: u32) -> TriangleId {
        TriangleId { instance: InstanceId(2), index }
    }

    fn point() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0_f32..1.0).prop_map(Vec3::from_array)
    }

    fn triangle() -> impl Strategy<Value = Triangle> {
        (point(), point(), point()).prop_map(|(a, b, c)| Triangle { a, b, c })
    }

    proptest! {
        #[test]
        fn what_the_exact_test_hits_passes(
            (from, to, off) in (triangle(), triangle(), triangle()),
            (origin, target) in (point(), prop::array::uniform2(0.0_f32..1.0)),
            (place, slack) in (0.0_f32..1.0, 1e-5_f32..0.1),
        ) {
            let triangle = MovingTriangle { from, to, slack };
            let block = MovingBlock::<8>::new(&[(id(3), triangle)]);
            // It bends by less than it may.
            let mix = |a: Vec3, b: Vec3, off: Vec3| a + (b - a) * place + off * slack * 0.99;
            let now = Triangle {
                a: mix(from.a, to.a, off.a),
                b: mix(from.b, to.b, off.b),
                c: mix(from.c, to.c, off.c),
            };
            prop_assert!(triangle.bounds().contains(now.bounds()));
            let [u, v] = target.map(|x| x * 0.6 - 0.05);
            let target = now.a + (now.b - now.a) * u + (now.c - now.a) * v;
            let direction = (target - origin * 4.0).normalize_or(Vec3::X);
            let ray = Ray::new(origin * 4.0, direction, 0.0, f32::INFINITY);
            let (slab, shear) = (SlabRay::new(&ray), ShearRay::new(&ray));
            if let Some([t, ..]) = intersect_triangle(baseline(), &slab, &shear, &now) {
                let passes = |t_max: f32| {
                    block.find_near::<_, f32x8<_>>(baseline(), &ray, place, t_max) & 1 == 1
                };
                prop_assert!(passes(t) && passes(f32::INFINITY));
            }
        }
    }

    #[test]
    fn what_is_elsewhere_at_the_time_does_not_pass() {
        let at = |x: f32| {
            let corner = |y: f32, z: f32| Vec3::new(x, y, z);
            Triangle { a: corner(0.0, 0.0), b: corner(1.0, 0.0), c: corner(0.0, 1.0) }
        };
        let triangle = |shift| MovingTriangle { from: at(shift), to: at(shift + 4.0), slack: 0.01 };
        let triangles = [(id(5), triangle(0.0)), (id(9), triangle(1.0))];
        let block = MovingBlock::<8>::new(&triangles);
        let find = |origin: [f32; 3], place, t_max| {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::X, 0.0, f32::INFINITY);
            block.find_near::<_, f32x8<_>>(baseline(), &ray, place, t_max) & 3
        };
        // At half of the way they are at 2 and 3.
        assert_eq!(find([0.0, 0.2, 0.2], 0.5, 10.0), 3);
        assert_eq!(find([0.0, 0.2, 0.2], 0.5, 2.5), 1);
        assert_eq!(find([2.5, 0.2, 0.2], 0.5, 10.0), 2);
        assert_eq!(find([2.5, 0.2, 0.2], 0.0, 10.0), 0);
        assert_eq!(find([0.0, 0.8, 0.8], 0.5, 10.0), 0);
        assert_eq!(block.ids[..3], [id(5), id(9), TriangleId::NONE]);
    }
}
