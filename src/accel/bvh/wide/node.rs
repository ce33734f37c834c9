//! The test of all of a node's children.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use crate::geom::SlabRay;
use crate::simd::order::{BIAS, DISTANCE};
use crate::simd::{Vectors, Width};

/// A vector of `W` numbers.
pub type Floats<S, const W: usize> = <Width as Vectors<W>>::Floats<S>;
type Bits<S, const W: usize> = <Floats<S, W> as SimdFloat<S>>::Bits;

/// The keys of those children that the ray enters from `t_min` to `t_max` (see `simd::order`),
/// zero for the others, and a bit for each of the former. `planes` are a node's, lower and upper by
/// axis.
///
/// The arithmetic is [`crate::geom::SlabRay::interval`]'s, lane by lane.
#[inline(always)]
pub fn intersect_children<S: Simd, const W: usize>(
    simd: S,
    planes: &[[f32; W]; 6],
    (slab, t_min): (&SlabRay, f32),
    t_max: f32,
) -> ([u32; W], u32)
where
    Width: Vectors<W>,
{
    let distance = |axis: usize, side: usize, inverse: f32| {
        let planes = Floats::<S, W>::load_array_ref(simd, &planes[2 * axis + side]);
        (planes - slab.origin[axis]) * inverse
    };
    let mut enter = Floats::<S, W>::splat(simd, t_min);
    let mut exit = Floats::<S, W>::splat(simd, t_max);
    for axis in 0..3 {
        let near = slab.negative[axis] & 1;
        enter = distance(axis, near, slab.inv_near[axis]).max(enter);
        exit = distance(axis, 1 - near, slab.inv_far[axis]).min(exit);
    }
    make_keys(simd, enter, exit)
}

/// The same for boxes whose ends are the first two vertices of triangles, as leaves have them.
#[inline(always)]
pub fn intersect_boxes<S: Simd, const W: usize>(
    simd: S,
    vertices: &[[f32; W]; 9],
    ray: (&SlabRay, f32),
    t_max: f32,
) -> ([u32; W], u32)
where
    Width: Vectors<W>,
{
    let [ax, ay, az, bx, by, bz, ..] = vertices;
    intersect_children(simd, &[*ax, *bx, *ay, *by, *az, *bz], ray, t_max)
}

/// The same by where rays enter and leave the children.
#[inline(always)]
pub fn make_keys<S: Simd, const W: usize>(
    simd: S,
    enter: Floats<S, W>,
    exit: Floats<S, W>,
) -> ([u32; W], u32)
where
    Width: Vectors<W>,
{
    let hits = enter.simd_le(exit);
    let lanes = Bits::<S, W>::from_fn(simd, |lane| lane as u32);
    let keys = Floats::<S, W>::from_bits(((enter.to_bits() & DISTANCE) | lanes) + BIAS);
    let keys = hits.select(keys, Floats::<S, W>::splat(simd, 0.0));
    (keys.to_bits().to_array(), hits.to_bitmask() as u32)
}
