//! Maps from the unit square to disks, spheres and triangles, with their densities.
//!
//! All take `u` in `[0, 1)^2`, keep uniform points uniform, and stretch the square little, so that
//! stratified points stay stratified.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_4};

use crate::math::{Vec2, Vec3};
use crate::simd::lanes::{self, Float, Lanes, Mask, Scalar, Vec3f, sin_cos_eighth};

/// The point of the unit circle at `turns` of a full turn, for `turns` in `[0, 1]`.
///
/// An order of magnitude quicker than a general sine: the quadrant is exact in `turns`.
#[inline]
pub fn unit_circle(turns: f32) -> Vec2 {
    let (x, y) = lanes::unit_circle::<Scalar>(turns);
    Vec2::new(x, y)
}

/// A uniform point of the unit disk, concentric squares becoming circles.
///
/// Shirley and Chiu, "A Low Distortion Map Between Disk and Square", JGT 1997.
#[inline]
pub fn disk(u: Vec2) -> Vec2 {
    let [x, y] = disk_in_lanes(Scalar, [u.x, u.y]);
    Vec2::new(x, y)
}

/// [`disk`] in lanes.
#[inline(always)]
pub fn disk_in_lanes<L: Lanes>(lanes: L, [u, v]: [L::Float; 2]) -> [L::Float; 2] {
    let (a, b) = (u * 2.0 - 1.0, v * 2.0 - 1.0);
    let wide = a.abs().gt(b.abs());
    let (radius, other) = (wide.select(a, b), wide.select(b, a));
    // The floor keeps the centre off 0 / 0; it moves no other point of 24 bits.
    let ratio = other / radius.abs().most(lanes.float(1e-12)).copysign(radius);
    let (sin, cos) = sin_cos_eighth::<L>(ratio * FRAC_PI_4);
    [wide.select(cos, sin) * radius, wide.select(sin, cos) * radius]
}

/// Density of [`disk`] in the unit disk, per area.
pub const DISK_PDF: f32 = FRAC_1_PI;

/// A unit vector of the upper hemisphere with density [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    cosine_hemisphere_in_lanes(Scalar, [u.x, u.y]).into()
}

/// [`cosine_hemisphere`] in lanes.
#[inline(always)]
pub fn cosine_hemisphere_in_lanes<L: Lanes>(lanes: L, u: [L::Float; 2]) -> Vec3f<L> {
    let [x, y] = disk_in_lanes(lanes, u);
    // The floor keeps the direction off the horizon, where its density would be zero.
    let z = (lanes.float(1.0) - (x * x + y * y)).most(lanes.float(1e-12)).sqrt();
    Vec3f { x, y, z }
}

/// Density of [`cosine_hemisphere`] per solid angle; zero below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A uniform unit vector.
#[inline]
pub fn sphere(u: Vec2) -> Vec3 {
    sphere_in_lanes(Scalar, [u.x, u.y]).into()
}

/// [`sphere`] in lanes.
#[inline(always)]
pub fn sphere_in_lanes<L: Lanes>(l: L, [u, v]: [L::Float; 2]) -> Vec3f<L> {
    let one = l.float(1.0);
    let z = one - v * 2.0;
    let ring = (one - z * z).most(l.float(0.0)).sqrt();
    let (x, y) = lanes::unit_circle::<L>(u);
    Vec3f { x: x * ring, y: y * ring, z }
}

/// Density of [`sphere`] per solid angle.
pub const SPHERE_PDF: f32 = 0.25 * FRAC_1_PI;

/// A unit vector uniform in the cone of half-angle `acos(cos_max)` about +Z.
#[inline]
pub fn cone(u: Vec2, cos_max: f32) -> Vec3 {
    let z = 1.0 - u.y * (1.0 - cos_max);
    let ring = unit_circle(u.x) * (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(ring.x, ring.y, z)
}

/// Density of [`cone`] per solid angle.
#[inline]
pub fn cone_pdf(cos_max: f32) -> f32 {
    0.5 * FRAC_1_PI / (1.0 - cos_max)
}

/// Barycentrics (u of the second vertex, v of the third) uniform over a triangle's area; the
/// density is one over that area.
///
/// Heitz, "A Low-Distortion Map Between Triangle and Square", 2019.
#[inline]
pub fn triangle(u: Vec2) -> Vec2 {
    let [x, y] = triangle_in_lanes::<Scalar>([u.x, u.y]);
    Vec2::new(x, y)
}

/// [`triangle`] in lanes.
#[inline(always)]
pub fn triangle_in_lanes<L: Lanes>([u, v]: [L::Float; 2]) -> [L::Float; 2] {
    let upper = v.gt(u);
    let half = upper.select(u, v) * 0.5;
    [upper.select(half, u - half), upper.select(v - half, half)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;

    const COUNT: u64 = 60_000;

    /// Independent points: stratified ones would fit too well.
    fn points() -> impl Iterator<Item = Vec2> {
        (0..COUNT).map(|i| Sampler::new(i, 0, 11).next_2d())
    }

    fn histogram(cells: usize, cell: impl Fn(Vec2) -> usize) -> Vec<u64> {
        let mut counts = vec![0; cells];
        points().for_each(|u| counts[cell(u)] += 1);
        counts
    }

    fn slot(x: f32, n: usize) -> usize {
        ((x * n as f32) as usize).min(n - 1)
    }

    fn azimuth(x: f32, y: f32) -> f32 {
        libm::atan2f(y, x) / std::f32::consts::TAU + 0.5
    }

    #[test]
    fn the_circle_agrees_with_libm() {
        for i in 0..=100_000 {
            let turns = i as f32 / 100_000.0;
            let (sin, cos) = libm::sincos(f64::from(turns) * std::f64::consts::TAU);
            let point = unit_circle(turns).as_dvec2();
            assert!((point.x - cos).abs() < 2e-7 && (point.y - sin).abs() < 2e-7, "{turns}");
        }
    }

    #[test]
    fn the_disk_is_uniform() {
        let counts = histogram(12 * 16, |u| {
            let p = disk(u);
            assert!(p.length_squared() <= 1.0 + 1e-6);
            slot(p.length_squared(), 12) * 16 + slot(azimuth(p.x, p.y), 16)
        });
        assert_fits(&counts, &vec![COUNT as f64 / 192.0; 192], 5, "disk");
    }

    #[test]
    fn the_cosine_hemisphere_has_its_density() {
        let counts = histogram(12 * 16, |u| {
            let w = cosine_hemisphere(u);
            assert!(w.z > 0.0 && (w.length() - 1.0).abs() < 1e-6);
            slot(w.z, 12) * 16 + slot(azimuth(w.x, w.y), 16)
        });
        let expected: Vec<f64> = (0..12)
            .flat_map(|ring| {
                let (low, high) = (f64::from(ring) / 12.0, f64::from(ring + 1) / 12.0);
                [(high * high - low * low) * COUNT as f64 / 16.0; 16]
            })
            .collect();
        assert_fits(&counts, &expected, 5, "cosine hemisphere");
    }

    #[test]
    fn the_sphere_and_the_cone_are_uniform() {
        let counts = histogram(16 * 16, |u| {
            let w = sphere(u);
            slot(w.z * 0.5 + 0.5, 16) * 16 + slot(azimuth(w.x, w.y), 16)
        });
        assert_fits(&counts, &vec![COUNT as f64 / 256.0; 256], 5, "sphere");
        let cos_max = 0.9;
        let counts = histogram(16 * 16, |u| {
            let w = cone(u, cos_max);
            assert!(w.z >= cos_max - 1e-6);
            slot((w.z - cos_max) / (1.0 - cos_max), 16) * 16 + slot(azimuth(w.x, w.y), 16)
        });
        assert_fits(&counts, &vec![COUNT as f64 / 256.0; 256], 5, "cone");
    }

    #[test]
    fn the_triangle_is_uniform() {
        // Cells of equal area: the upper half of the grid folds onto the lower one.
        const N: usize = 12;
        let counts = histogram(N * N, |u| {
            let p = triangle(u);
            assert!(p.x >= 0.0 && p.y >= 0.0 && p.x + p.y <= 1.0);
            let (column, row) = (slot(p.x, N), slot(p.y, N));
            let folded = p.x + p.y > (column + row + 1) as f32 / N as f32;
            if folded { (N - 1 - row) * N + (N - 1 - column) } else { row * N + column }
        });
        let used: Vec<u64> = counts.into_iter().filter(|&count| count > 0).collect();
        assert_eq!(used.len(), N * N);
        assert_fits(&used, &vec![COUNT as f64 / (N * N) as f64; N * N], 5, "triangle");
    }
}
