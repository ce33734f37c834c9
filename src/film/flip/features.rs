//! Edges and points of the achromatic channel, and how they differ.

use rayon::prelude::*;

use super::separable::{PIXELS_PER_DEGREE, filter_columns, filter_rows};
use crate::math::{Vec3, Vec4};

/// Strength of the edge and of the point at each pixel of the achromatic channel.
pub fn detect_features(picture: &[Vec3], width: usize) -> Vec<(f32, f32)> {
    let lightness: Vec<_> =
        picture.par_iter().map(|c| Vec4::splat(c.x / 116.0 + 16.0 / 116.0)).collect();
    // Taps hold the Gaussian and its first and second derivative.
    let taps = derivative_taps();
    let rows: Vec<_> = filter_rows(&lightness, width, &taps)
        .into_iter()
        .map(|it| Vec4::new(it.y, it.z, it.x, it.x))
        .collect();
    let across: Vec<_> = taps.iter().map(|it| Vec4::new(it.x, it.x, it.y, it.z)).collect();
    filter_columns(&rows, width, &across)
        .into_iter()
        .map(|it| ((it.x * it.x + it.z * it.z).sqrt(), (it.y * it.y + it.w * it.w).sqrt()))
        .collect()
}

fn derivative_taps() -> Vec<Vec4> {
    let deviation = 0.5 * 0.082 * PIXELS_PER_DEGREE;
    let radius = libm::ceilf(3.0 * deviation) as i32;
    let mut taps: Vec<_> = (-radius..=radius)
        .map(|x| {
            let x = x as f32;
            let gaussian = libm::expf(-x * x / (2.0 * deviation * deviation));
            let second = (x * x / (deviation * deviation) - 1.0) * gaussian;
            Vec4::new(gaussian, -x * gaussian, second, 0.0)
        })
        .collect();
    // The Gaussian weighs 1; of each derivative the positive taps 1 and the negative ones -1.
    let positive: Vec4 = taps.iter().map(|tap| tap.max(Vec4::ZERO)).sum();
    let negative: Vec4 = taps.iter().map(|tap| (-*tap).max(Vec4::ZERO)).sum();
    for tap in &mut taps {
        for axis in 0..3 {
            tap[axis] /= if tap[axis] > 0.0 { positive[axis] } else { negative[axis].max(1e-30) };
        }
    }
    taps
}

pub fn feature_difference(a: (f32, f32), b: (f32, f32)) -> f32 {
    let greater = (a.0 - b.0).abs().max((a.1 - b.1).abs());
    (greater * std::f32::consts::FRAC_1_SQRT_2).sqrt()
}
