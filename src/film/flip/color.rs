//! Colours as the eye resolves them, and how they differ.

use rayon::prelude::*;

use super::separable::{PIXELS_PER_DEGREE, filter_columns, filter_rows};
use crate::math::{Mat3, Vec3, Vec4};

/// Linear Rec. 709 to XYZ under D65, as the reference implementation has it; by columns.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols_array(&[
    10135552.0 / 24577794.0,
    2613072.0 / 12288897.0,
    1425312.0 / 73733382.0,
    8788810.0 / 24577794.0,
    8788810.0 / 12288897.0,
    8788810.0 / 73733382.0,
    4435075.0 / 24577794.0,
    887015.0 / 12288897.0,
    70074185.0 / 73733382.0,
]);
const RGB_FROM_XYZ: Mat3 = Mat3::from_cols_array(&[
    3.241_003_3,
    -0.969_224_33,
    0.055_639_423, //
    -1.537_398_9,
    1.875_930_1,
    -0.204_011_2, //
    -0.498_615_86,
    0.041_554_224,
    1.057_148_9,
]);
const WHITE: Vec3 = Vec3::new(0.950_428_55, 1.0, 1.088_900_4);
const INVERSE_WHITE: Vec3 = Vec3::new(1.052_156_9, 1.0, 0.918_357_7);

/// Linear RGB to YCxCz, the opponent space in which the eye's blur is linear.
pub fn to_opponent_space(picture: Vec<Vec3>) -> Vec<Vec3> {
    picture
        .into_par_iter()
        .map(|rgb| {
            let xyz = XYZ_FROM_RGB * rgb * INVERSE_WHITE;
            Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
        })
        .collect()
}

/// YCxCz as the eye resolves it, in CIELAB with Hunt's adjustment of chroma by lightness.
pub fn filter_contrast(picture: &[Vec3], width: usize) -> Vec<Vec3> {
    let taps = contrast_sensitivity_taps();
    // The blue-yellow filter is the sum of two Gaussians, each separable for itself.
    let separated: Vec<_> = picture.par_iter().map(|c| Vec4::new(c.x, c.y, c.z, c.z)).collect();
    let blurred = filter_columns(&filter_rows(&separated, width, &taps), width, &taps);
    blurred
        .into_par_iter()
        .map(|it| {
            let y = (it.x + 16.0) / 116.0;
            let xyz = Vec3::new(y + it.y / 500.0, y, y - (it.z + it.w) / 200.0) * WHITE;
            to_hunt_lab((RGB_FROM_XYZ * xyz).clamp(Vec3::ZERO, Vec3::ONE))
        })
        .collect()
}

fn to_hunt_lab(rgb: Vec3) -> Vec3 {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |value: f32| {
        if value > DELTA * DELTA * DELTA {
            libm::cbrtf(value)
        } else {
            value / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let xyz = XYZ_FROM_RGB * rgb * INVERSE_WHITE;
    let (x, y, z) = (f(xyz.x), f(xyz.y), f(xyz.z));
    let lightness = 116.0 * y - 16.0;
    Vec3::new(lightness, 5.0 * (x - y) * lightness, 2.0 * (y - z) * lightness)
}

/// Taps of the eye's blur for Y, Cx and the two Gaussians of Cz: table 1 of the paper of 2020.
fn contrast_sensitivity_taps() -> Vec<Vec4> {
    use std::f32::consts::PI;
    let radius = libm::ceilf(3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE) as i32;
    let weight = |x2: f32, b: f32| libm::expf(-PI * PI * x2 / b);
    let height = |a: f32, b: f32| (a * (PI / b).sqrt()).sqrt();
    let mut taps: Vec<_> = (-radius..=radius)
        .map(|x| {
            let x2 = (x as f32 / PIXELS_PER_DEGREE) * (x as f32 / PIXELS_PER_DEGREE);
            Vec4::new(
                weight(x2, 0.0047),
                weight(x2, 0.0053),
                height(34.1, 0.04) * weight(x2, 0.04),
                height(13.5, 0.025) * weight(x2, 0.025),
            )
        })
        .collect();
    let sum: Vec4 = taps.iter().sum();
    // Twice applied, the two Gaussians of Cz together weigh 1.
    let yellow = (sum.z * sum.z + sum.w * sum.w).sqrt();
    for tap in &mut taps {
        *tap /= Vec4::new(sum.x, sum.y, yellow, yellow);
    }
    taps
}

/// HyAB distance, compressed and mapped to `[0, 1]`; `greatest` is that of green and blue.
pub fn color_difference(a: Vec3, b: Vec3, greatest: f32) -> f32 {
    let (knee, at_knee) = (0.4 * greatest, 0.95);
    let difference = libm::powf(hyab(a, b), 0.7);
    if difference < knee {
        difference * at_knee / knee
    } else {
        at_knee + (difference - knee) / (greatest - knee) * (1.0 - at_knee)
    }
}

fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

pub fn greatest_color_difference() -> f32 {
    libm::powf(hyab(to_hunt_lab(Vec3::Y), to_hunt_lab(Vec3::Z)), 0.7)
}
