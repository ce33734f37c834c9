//! The heart of the exact test in lanes, whatever they are lanes of: rays and one triangle, or
//! pairs of both.

use fearless_simd::{Simd, SimdFloat, SimdMask};

use super::intersect_triangle::{DISTANCE_BOUND, EDGE_ON};

/// Where rays meet triangles: `t`, `u`, `v`, and a bit for each lane that misses. The vertices are
/// those that each ray sees: projected, with the ray as the third axis.
#[inline(always)]
pub(super) fn intersect_sheared<S: Simd, V: SimdFloat<S, Element = f64>>(
    simd: S,
    a: [V; 3],
    b: [V; 3],
    c: [V; 3],
) -> ([V; 3], u32) {
    let (p0, q0) = (c[0] * b[1], c[1] * b[0]);
    let (p1, q1) = (a[0] * c[1], a[1] * c[0]);
    let (p2, q2) = (b[0] * a[1], b[1] * a[0]);
    let (w0, w1, w2) = (p0 - q0, p1 - q1, p2 - q2);
    let outside = (w0.simd_lt(0.0) | w1.simd_lt(0.0) | w2.simd_lt(0.0))
        & (w0.simd_gt(0.0) | w1.simd_gt(0.0) | w2.simd_gt(0.0));
    let det = w0 + w1 + w2;
    let magnitude = (p0.abs() + q0.abs()) + (p1.abs() + q1.abs()) + (p2.abs() + q2.abs());
    let edge_on = det.abs().simd_le(magnitude * EDGE_ON);
    let distance = w0 * a[2] + w1 * b[2] + w2 * c[2];
    let depth = a[2].abs().max(b[2].abs()).max(c[2].abs());
    let on_it = distance.abs().simd_le(magnitude * DISTANCE_BOUND * depth);
    let misses = (outside | edge_on | on_it).to_bitmask() as u32;
    let inv_det = V::splat(simd, 1.0) / det;
    ([distance * inv_det, w1 * inv_det, w2 * inv_det], misses)
}
