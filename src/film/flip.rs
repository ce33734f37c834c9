//! FLIP: how strong the difference between two pictures is to an eye that flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. Fairchild, "FLIP: A
//! Difference Evaluator for Alternating Images", HPG 2020; for high dynamic range P. Andersson,
//! J. Nilsson, P. Shirley and T. Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range
//! Images", Eurographics 2021. The filters are separated as in NVIDIA's implementation 1.2 and
//! later; the tests hold figures of its version 1.7, which ours meet within 1e-3 relative.
//!
//! What we do differently: colours below zero are taken as zero, and a reference that is mostly
//! black (where the median luminance, and with it the longest exposure, is undefined) takes the
//! median of what is not black.

use crate::math::{Mat3, Vec3, Vec4};
use rayon::prelude::*;

/// Pixels per degree of the eye: 0.7 m from a screen 0.7 m and 3840 pixels wide.
const PIXELS_PER_DEGREE: f32 = 0.7 * (3840.0 / 0.7) * (std::f32::consts::PI / 180.0);

/// FLIP per pixel, in `[0, 1]`, of pictures in linear Rec. 709 whose values outside `[0, 1]` are
/// clamped: what a display without tone mapping would show.
///
/// # Panics
/// If the pictures do not have `width` times a number of rows of pixels each.
pub fn ldr(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize) -> Vec<f32> {
    let clamped = |picture: &[[f32; 3]]| {
        picture.iter().map(|&it| Vec3::from(it).clamp(Vec3::ZERO, Vec3::ONE)).collect()
    };
    displayed(clamped(reference), clamped(test), width)
}

/// FLIP per pixel of pictures in linear Rec. 709 without an upper bound: the greatest over a range
/// of exposures, each shown through the ACES tone map. The range comes from `reference`.
///
/// # Panics
/// If the pictures do not have `width` times a number of rows of pixels each.
pub fn hdr(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize) -> Vec<f32> {
    let (start, stop) = exposures(reference);
    let count = (libm::ceilf(stop - start) as usize).max(2);
    let step = (stop - start) / (count - 1) as f32;
    let mut greatest = vec![0.0_f32; reference.len()];
    for exposure in (0..count).map(|i| start + i as f32 * step) {
        let gain = libm::exp2f(exposure);
        let shown = |picture: &[[f32; 3]]| picture.par_iter().map(|&it| aces(it, gain)).collect();
        let errors = displayed(shown(reference), shown(test), width);
        for (greatest, error) in greatest.iter_mut().zip(errors) {
            *greatest = greatest.max(error);
        }
    }
    greatest
}

// --- Exposures and tone map ---------------------------------------------------------------------

/// The quotient of quadratics of K. Narkowicz's fit of ACES, with its exposure of 0.6 taken out:
/// `(a x² + b x) / (c x² + d x + e)`.
const ACES: [f64; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

/// In f64, where no square of a float overflows.
fn aces(colour: [f32; 3], gain: f32) -> Vec3 {
    let [a, b, c, d, e] = ACES;
    Vec3::from_array(colour.map(|value| {
        let x = f64::from(value.max(0.0)) * f64::from(gain);
        let y = (a * x * x + b * x) / (c * x * x + d * x + e);
        (y as f32).clamp(0.0, 1.0)
    }))
}

/// The shortest and the longest exposure, in stops: those that bring the brightest luminance and
/// the median luminance to 0.85 of the tone map's range.
fn exposures(reference: &[[f32; 3]]) -> (f32, f32) {
    let luminance = |c: &[f32; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let mut luminances: Vec<f32> = reference.iter().map(|c| luminance(c).max(0.0)).collect();
    luminances.sort_by(f32::total_cmp);
    let brightest = luminances.last().copied().unwrap_or(0.0);
    if brightest == 0.0 {
        return (0.0, 0.0);
    }
    let median = |sorted: &[f32]| {
        let at = (sorted.len() / 2).max(1) - 1;
        0.5 * (sorted[at] + sorted[(at + 1).min(sorted.len() - 1)])
    };
    let mut middle = median(&luminances);
    if middle == 0.0 {
        let black = luminances.partition_point(|&it| it == 0.0);
        middle = median(&luminances[black..]);
    }
    let [a, b, c, d, e] = ACES;
    let (a, b, c) = (a - 0.85 * c, b - 0.85 * d, -0.85 * e);
    let half = -0.5 * b / a;
    let bright = (half + libm::sqrt(half * half - c / a)) as f32;
    (libm::log2f(bright / brightest), libm::log2f(bright / middle))
}

// --- FLIP of two pictures as displayed ----------------------------------------------------------

/// FLIP of two pictures in linear light, in `[0, 1]`.
fn displayed(reference: Vec<Vec3>, test: Vec<Vec3>, width: usize) -> Vec<f32> {
    let height = reference.len().checked_div(width).unwrap_or(0);
    assert!(reference.len() == width * height && test.len() == reference.len(), "whole rows");
    let [reference, test] = [reference, test].map(opponent);
    let [colours_a, colours_b] = [&reference, &test].map(|it| perceived(it, width));
    let [features_a, features_b] = [&reference, &test].map(|it| features(it, width));
    let greatest = greatest_colour_difference();
    (0..reference.len())
        .into_par_iter()
        .map(|i| {
            let colour = colour_difference(colours_a[i], colours_b[i], greatest);
            let feature = feature_difference(features_a[i], features_b[i]);
            libm::powf(colour, 1.0 - feature)
        })
        .collect()
}

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
fn opponent(picture: Vec<Vec3>) -> Vec<Vec3> {
    picture
        .into_par_iter()
        .map(|rgb| {
            let xyz = XYZ_FROM_RGB * rgb * INVERSE_WHITE;
            Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
        })
        .collect()
}

/// YCxCz as the eye resolves it, in CIELAB with Hunt's adjustment of chroma by lightness.
fn perceived(picture: &[Vec3], width: usize) -> Vec<Vec3> {
    let taps = contrast_sensitivity();
    // The blue-yellow filter is the sum of two Gaussians, each separable for itself.
    let separated: Vec<_> = picture.par_iter().map(|c| Vec4::new(c.x, c.y, c.z, c.z)).collect();
    let blurred = filter_columns(&filter_rows(&separated, width, &taps), width, &taps);
    blurred
        .into_par_iter()
        .map(|it| {
            let y = (it.x + 16.0) / 116.0;
            let xyz = Vec3::new(y + it.y / 500.0, y, y - (it.z + it.w) / 200.0) * WHITE;
            hunt_lab((RGB_FROM_XYZ * xyz).clamp(Vec3::ZERO, Vec3::ONE))
        })
        .collect()
}

fn hunt_lab(rgb: Vec3) -> Vec3 {
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
fn contrast_sensitivity() -> Vec<Vec4> {
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
fn colour_difference(a: Vec3, b: Vec3, greatest: f32) -> f32 {
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

fn greatest_colour_difference() -> f32 {
    libm::powf(hyab(hunt_lab(Vec3::Y), hunt_lab(Vec3::Z)), 0.7)
}

/// Strength of the edge and of the point at each pixel of the achromatic channel.
fn features(picture: &[Vec3], width: usize) -> Vec<(f32, f32)> {
    let lightness: Vec<_> =
        picture.par_iter().map(|c| Vec4::splat(c.x / 116.0 + 16.0 / 116.0)).collect();
    // Taps hold the Gaussian and its first and second derivative.
    let taps = derivatives();
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

fn derivatives() -> Vec<Vec4> {
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

fn feature_difference(a: (f32, f32), b: (f32, f32)) -> f32 {
    let greater = (a.0 - b.0).abs().max((a.1 - b.1).abs());
    (greater * std::f32::consts::FRAC_1_SQRT_2).sqrt()
}

// --- Separable filters, their edges clamped -----------------------------------------------------

fn filter_rows(picture: &[Vec4], width: usize, taps: &[Vec4]) -> Vec<Vec4> {
    let radius = taps.len() / 2;
    let mut filtered = vec![Vec4::ZERO; picture.len()];
    filtered.par_chunks_mut(width.max(1)).zip(picture.par_chunks(width.max(1))).for_each(
        |(filtered, row)| {
            for (x, sum) in filtered.iter_mut().enumerate() {
                for (i, &tap) in taps.iter().enumerate() {
                    let from = (x + i).saturating_sub(radius).min(width - 1);
                    *sum += tap * row[from];
                }
            }
        },
    );
    filtered
}

fn filter_columns(picture: &[Vec4], width: usize, taps: &[Vec4]) -> Vec<Vec4> {
    let (radius, height) = (taps.len() / 2, picture.len().checked_div(width).unwrap_or(0));
    let mut filtered = vec![Vec4::ZERO; picture.len()];
    filtered.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, filtered)| {
        for (i, &tap) in taps.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            for (sum, &value) in filtered.iter_mut().zip(&picture[from * width..]) {
                *sum += tap * value;
            }
        }
    });
    filtered
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 40;
    const HEIGHT: usize = 30;

    fn picture(colour: impl Fn(usize, usize) -> [f32; 3]) -> Vec<[f32; 3]> {
        (0..WIDTH * HEIGHT).map(|i| colour(i % WIDTH, i / WIDTH)).collect()
    }

    fn base(x: usize, y: usize) -> [f32; 3] {
        [(x * 7 % 40) as f32 / 40.0, y as f32 / 30.0, (x * y % 17) as f32 / 17.0]
    }

    type Pair = (&'static str, [Vec<[f32; 3]>; 2], [[f64; 3]; 2]);

    /// Reference and test, and what `flip_evaluator` 1.7 says of them: mean, greatest, and the
    /// value at (13, 7), for LDR and then for HDR.
    fn pairs() -> Vec<Pair> {
        let at = |x, edge| if x < edge { [0.1; 3] } else { [0.8; 3] };
        let steps = |x: usize, y: usize| libm::exp2f(((x * 3 + y * 5) % 13) as f32 - 6.0);
        let tint = |value: f32| [value, 0.5 * value, 0.25 * value];
        let spark = |x, y| if x % 8 == 3 && y % 8 == 3 { [50.0, 40.0, 30.0] } else { [0.2; 3] };
        let noise = |x, y| base(x, y).map(|c| c * 0.9 + ((x * 5 + y * 3) % 11) as f32 / 110.0);
        let brighter = |x, y| steps(x, y) * (1.0 + ((x + 2 * y) % 7) as f32 / 20.0);
        vec![
            (
                "noise",
                [picture(base), picture(noise)],
                [[0.165_343_0, 0.336_376_8, 0.163_998_9], [0.215_234_5, 0.640_353_6, 0.180_065_0]],
            ),
            (
                "edge",
                [picture(|x, _| at(x, 20)), picture(|x, _| at(x, 21))],
                [[0.055_110_8, 0.578_762_1, 0.0], [0.044_927_5, 0.468_331_9, 0.0]],
            ),
            (
                "hue",
                [picture(|_, _| [0.0, 1.0, 0.0]), picture(|_, _| [0.0, 0.0, 1.0])],
                [[1.0, 1.0, 1.0], [0.996_166_7, 0.996_167_4, 0.996_167_4]],
            ),
            (
                "bright",
                [picture(|x, y| tint(steps(x, y))), picture(|x, y| tint(brighter(x, y)))],
                [[0.064_710_3, 0.166_550_7, 0.074_039_5], [0.097_359_0, 0.165_756_7, 0.103_074_6]],
            ),
            (
                "sparkle",
                [picture(|_, _| [0.2; 3]), picture(spark)],
                [[0.072_044_1, 0.388_147_8, 0.002_068_2], [0.011_252_7, 0.069_461_6, 0.000_238_9]],
            ),
            (
                "dim",
                [
                    picture(|x, y| base(x, y).map(|c| 0.01 + c / 50.0)),
                    picture(|x, y| base(x, y).map(|c| 0.0105 + c / 51.0)),
                ],
                [[0.018_248_6, 0.030_498_1, 0.022_348_2], [0.043_435_8, 0.080_997_8, 0.044_162_0]],
            ),
        ]
    }

    #[test]
    fn figures_are_those_of_the_authors_implementation() {
        for (name, [reference, test], expected) in pairs() {
            let maps = [ldr(&reference, &test, WIDTH), hdr(&reference, &test, WIDTH)];
            for (map, expected) in maps.iter().zip(expected) {
                let mean = map.iter().map(|&it| f64::from(it)).sum::<f64>() / map.len() as f64;
                let greatest = f64::from(map.iter().fold(0.0_f32, |a, &b| a.max(b)));
                let found = [mean, greatest, f64::from(map[7 * WIDTH + 13])];
                // Far from a spark what is left of single pixels is rounding.
                let rounding = [1e-6, 1e-6, 3e-5];
                for ((found, expected), rounding) in found.into_iter().zip(expected).zip(rounding) {
                    let close = (found - expected).abs() <= 1e-3 * expected + rounding;
                    assert!(close, "{name}: {found} rather than {expected}");
                }
            }
        }
    }

    #[test]
    fn any_floats_give_figures_between_0_and_1() {
        let black = vec![[0.0; 3]; 12];
        let wild: Vec<_> = (0..12).map(|i| [f32::MAX, 1e-40 * i as f32, -3.0 * i as f32]).collect();
        for (a, b) in [(&black, &black), (&black, &wild), (&wild, &black), (&wild, &wild)] {
            for map in [ldr(a, b, 4), hdr(a, b, 4)] {
                assert_eq!(map.len(), 12);
                assert!(map.iter().all(|it| (0.0..=1.0 + 1e-6).contains(it)), "{map:?}");
            }
        }
        assert!(hdr(&black, &black, 4).iter().all(|&it| it == 0.0));
        assert!(hdr(&[], &[], 0).is_empty());
        assert_eq!(hdr(&[[0.5; 3]], &[[0.5; 3]], 1), [0.0]);
    }

    #[test]
    fn a_mostly_black_reference_still_shows_what_is_not() {
        let reference = picture(|x, y| if x < 9 && y < 9 { [4.0, 2.0, 1.0] } else { [0.0; 3] });
        let test: Vec<_> = reference.iter().map(|pixel| pixel.map(|c| 0.5 * c)).collect();
        let map = hdr(&reference, &test, WIDTH);
        assert!(map[4 * WIDTH + 4] > 0.1 && map[20 * WIDTH + 30] < 1e-3);
    }
}
