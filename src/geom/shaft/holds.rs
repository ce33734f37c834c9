//! Whether rays lie in a region.

use fearless_simd::{Simd, SimdBase, SimdMask};

use super::region::{LONGEST, PLANES, Shaft, is_tame};
use crate::geom::RayBundle;
use crate::geom::bundle::dot;
use crate::math::{Ray, Vec3};

/// 2^-22: three products and their sum are off by less of the sum of their magnitudes.
const ROUNDED: f32 = 2.3841858e-7;

impl Shaft {
    /// Whether all points of the ray lie in the region.
    pub fn holds(&self, ray: &Ray) -> bool {
        if ray.t_max() <= ray.t_min() {
            return true;
        }
        let (o, d) = (ray.origin().as_dvec3(), ray.direction().as_dvec3());
        let end = o + d * f64::from(ray.t_max());
        let held = |lane: usize| {
            let (normal, offset) = (self.normal(lane), f64::from(self.offset[lane]));
            o.dot(normal) <= offset && (d.dot(normal) <= 0.0 || end.dot(normal) <= offset)
        };
        let near = ray.origin().abs().cmple(self.reach).all();
        is_tame(ray.direction()) && near && (0..PLANES).all(held)
    }

    /// Whether all points of a bundle's rays lie in the region, in single precision: it may say no
    /// where a ray is as near to a plane as that can tell, or would lie in the region only for that
    /// it ends there.
    ///
    /// A plane's half-space holds a ray if its origin lies in it and its direction does not lead
    /// towards the plane, both by more than what they may be rounded by.
    ///
    /// Plain loops: closures would be compiled apart, for no instruction set in particular.
    #[inline(always)]
    pub fn holds_bundle<S: Simd>(&self, simd: S, bundle: &RayBundle) -> bool {
        let ([o, d], [t_min, t_max]) = (bundle.rays(simd), bundle.spans(simd));
        let o_size = [o[0].abs(), o[1].abs(), o[2].abs()];
        let d_size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let longest = d_size[0].max(d_size[1]).max(d_size[2]);
        let mut held = longest.simd_ge(1.0 / LONGEST) & longest.simd_le(LONGEST);
        for axis in 0..3 {
            held &= o_size[axis].simd_le(self.reach[axis]);
        }
        for lane in 0..PLANES {
            if self.inner[lane] == f32::INFINITY {
                continue;
            }
            let [plus, minus] = [&self.plus, &self.minus];
            let normal = Vec3::new(
                plus[0][lane] + minus[0][lane],
                plus[1][lane] + minus[1][lane],
                plus[2][lane] + minus[2][lane],
            );
            let size = normal.abs() * ROUNDED;
            held &= (dot(o, normal) + dot(o_size, size)).simd_le(self.offset[lane])
                & (dot(d, normal) + dot(d_size, size)).simd_le(0.0);
        }
        (t_max.simd_gt(t_min) & !held).to_bitmask() == 0
    }
}
