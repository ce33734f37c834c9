//! The region of a bundle of rays.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x8, mask32x8};

use super::region::{LONGEST, SLACK, Shaft, find_farthest};
use crate::geom::RayBundle;
use crate::geom::bundle::dot;
use crate::math::{Aabb, Ray, Vec3};

impl Shaft {
    /// Makes the region of rays, which are a raster so many rays wide; a run of rays is as wide as
    /// it is long. `None` if they do not go the same way, within some 75 degrees, or none of them
    /// could hit anything.
    ///
    /// Rays without points (`t_max <= t_min`) are not asked about.
    #[inline(always)]
    pub fn of_rays<S: Simd>(simd: S, rays: &[Ray], width: usize) -> Option<Self> {
        let last = rays.len().checked_sub(1)?;
        let width = width.clamp(1, rays.len());
        let corners =
            [0, width - 1, last + 1 - width, last].map(|index: usize| rays[index].direction());
        let mut bounds = Bounds::new(simd, corners)?;
        for rays in rays.chunks(RayBundle::LANES) {
            let mut bundle = RayBundle::EMPTY;
            for (lane, ray) in rays.iter().enumerate() {
                bundle.put(lane, ray);
            }
            if !bounds.include(simd, &bundle) {
                return None;
            }
        }
        bounds.into_shaft()
    }

    /// Makes the region of bundles of rays; `corners` are the directions of those at the corners of
    /// their raster, scanline by scanline: they only say how the region is turned.
    #[inline(always)]
    pub fn of_bundles<S: Simd>(simd: S, bundles: &[RayBundle], corners: [Vec3; 4]) -> Option<Self> {
        let mut bounds = Bounds::new(simd, corners)?;
        for bundle in bundles {
            if !bounds.include(simd, bundle) {
                return None;
            }
        }
        bounds.into_shaft()
    }
}

/// The bounds of rays in a frame: lanes apart until all were seen.
struct Bounds<S: Simd> {
    frame: [Vec3; 3],
    /// Lower and upper bounds of slopes.
    slopes: [[f32x8<S>; 2]; 2],
    /// Of origins, by axis.
    origins: [[f32x8<S>; 2]; 3],
    /// Where they end along the axis.
    end: f32x8<S>,
}

impl<S: Simd> Bounds<S> {
    #[inline(always)]
    fn new(simd: S, corners: [Vec3; 4]) -> Option<Self> {
        let none = [f32x8::splat(simd, f32::INFINITY), f32x8::splat(simd, f32::NEG_INFINITY)];
        let (slopes, origins, end) = ([none; 2], [none; 3], none[1]);
        Some(Self { frame: make_frame(corners)?, slopes, origins, end })
    }

    /// Takes rays into the bounds; false if they do not go the same way.
    #[inline(always)]
    fn include(&mut self, simd: S, bundle: &RayBundle) -> bool {
        let ([o, d], [t_min, t_max]) = (bundle.rays(simd), bundle.spans(simd));
        let [axis, across, up] = self.frame;
        let live = t_max.simd_gt(t_min);
        let along = dot(d, axis);
        let longest = d[0].abs().max(d[1].abs()).max(d[2].abs());
        let length_squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let same_way = along.simd_gt(0.0)
            & (along * along * 16.0).simd_ge(length_squared)
            & longest.simd_ge(1.0 / LONGEST)
            & longest.simd_le(LONGEST);
        if (live & !same_way).to_bitmask() != 0 {
            return false;
        }

        let inverse = f32x8::splat(simd, 1.0) / along;
        for (slopes, side) in self.slopes.iter_mut().zip([across, up]) {
            widen(slopes, live, dot(d, side) * inverse);
        }
        for (origins, value) in self.origins.iter_mut().zip(o) {
            widen(origins, live, value);
        }
        let end = dot(o, axis) + t_max * along;
        self.end = live.select(end.max(self.end), self.end);
        true
    }

    #[inline(always)]
    fn into_shaft(self) -> Option<Shaft> {
        let [x, y, z] = self.origins.map(reduce_lanes);
        let origins = Aabb { min: Vec3::new(x[0], y[0], z[0]), max: Vec3::new(x[1], y[1], z[1]) };
        if origins.is_empty() {
            return None;
        }
        let [_, end] = reduce_lanes([self.end; 2]);
        make_shaft(self.frame, self.slopes.map(reduce_lanes), origins, end)
    }
}

/// Takes values into bounds, in those lanes that have one.
#[inline(always)]
fn widen<S: Simd>(bounds: &mut [f32x8<S>; 2], live: mask32x8<S>, value: f32x8<S>) {
    bounds[0] = live.select(value.min(bounds[0]), bounds[0]);
    bounds[1] = live.select(value.max(bounds[1]), bounds[1]);
}

/// Finds the bounds of all lanes.
#[inline(always)]
fn reduce_lanes<S: Simd>([low, high]: [f32x8<S>; 2]) -> [f32; 2] {
    let low = low.to_array().into_iter().fold(f32::INFINITY, f32::min);
    [low, high.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max)]
}

/// Makes the region of rays with origins in a box and slopes (parts of the direction along the
/// second and third vector over that along the first) within bounds; it ends at a distance along
/// the first.
#[inline(always)]
fn make_shaft(
    [axis, across, up]: [Vec3; 3],
    slopes: [[f32; 2]; 2],
    origins: Aabb,
    end: f32,
) -> Option<Shaft> {
    let widen = |slope: f32, by: f32| slope + (1.0 + slope.abs()) * by;
    let slopes = slopes.map(|[low, high]| [-widen(-low, SLACK), widen(high, SLACK)]);
    let mut planes = [(-axis, find_farthest(&origins, -axis)); 5];
    for (i, (side, [low, high])) in [across, up].into_iter().zip(slopes).enumerate() {
        let (upper, lower) = (side - axis * high, axis * low - side);
        planes[2 * i + 1] = (upper, find_farthest(&origins, upper));
        planes[2 * i + 2] = (lower, find_farthest(&origins, lower));
    }
    let mut shaft = Shaft::new(&planes, origins, axis)?;
    shaft.end_at(end);
    // Once more, for the rounding of corners themselves.
    let [[left, right], [low, high]] =
        slopes.map(|[low, high]| [-widen(-low, SLACK), widen(high, SLACK)]);
    let corner = |x: f32, y: f32| axis + across * x + up * y;
    let corners = [corner(left, low), corner(right, low), corner(left, high), corner(right, high)];
    shaft.has_sides = true;
    shaft.core = Some((origins, corners, (right - left).max(high - low)));
    Some(shaft)
}

/// Makes a frame of the mean direction of a raster's corners, and two across it: along its width,
/// and along its height.
#[inline(always)]
fn make_frame(corners: [Vec3; 4]) -> Option<[Vec3; 3]> {
    let [a, b, c, d] = corners.map(Vec3::normalize_or_zero);
    let axis = (a + b + c + d).try_normalize()?;
    let wide = (b - a) + (d - c);
    let across = (wide - axis * axis.dot(wide)).try_normalize();
    let across = across.unwrap_or_else(|| axis.any_orthonormal_vector());
    Some([axis, across, axis.cross(across)])
}
