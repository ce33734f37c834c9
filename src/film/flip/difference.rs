//! The difference of two pictures: of colours as the eye resolves them, raised where edges and
//! points differ.

use rayon::prelude::*;

use super::color::{
    color_difference, filter_contrast, greatest_color_difference, to_opponent_space,
};
use super::exposure::{exposure_range, tone_map_aces};
use super::features::{detect_features, feature_difference};
use crate::math::Vec3;

/// FLIP per pixel, in `[0, 1]`, of pictures in linear Rec. 709 whose values outside `[0, 1]` are
/// clamped: what a display without tone mapping would show.
///
/// # Panics
/// If the pictures do not have `width` times a number of rows of pixels each.
pub fn ldr(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize) -> Vec<f32> {
    let clamped = |picture: &[[f32; 3]]| {
        picture.iter().map(|&it| Vec3::from(it).clamp(Vec3::ZERO, Vec3::ONE)).collect()
    };
    compare_displayed(clamped(reference), clamped(test), width)
}

/// FLIP per pixel of pictures in linear Rec. 709 without an upper bound: the greatest over a range
/// of exposures, each shown through the ACES tone map. The range comes from `reference`.
///
/// # Panics
/// If the pictures do not have `width` times a number of rows of pixels each.
pub fn hdr(reference: &[[f32; 3]], test: &[[f32; 3]], width: usize) -> Vec<f32> {
    let (start, stop) = exposure_range(reference);
    let count = (libm::ceilf(stop - start) as usize).max(2);
    let step = (stop - start) / (count - 1) as f32;
    let mut greatest = vec![0.0_f32; reference.len()];
    for exposure in (0..count).map(|i| start + i as f32 * step) {
        let gain = libm::exp2f(exposure);
        let shown =
            |picture: &[[f32; 3]]| picture.par_iter().map(|&it| tone_map_aces(it, gain)).collect();
        let errors = compare_displayed(shown(reference), shown(test), width);
        for (greatest, error) in greatest.iter_mut().zip(errors) {
            *greatest = greatest.max(error);
        }
    }
    greatest
}

/// FLIP of two pictures in linear light, in `[0, 1]`.
fn compare_displayed(reference: Vec<Vec3>, test: Vec<Vec3>, width: usize) -> Vec<f32> {
    let height = reference.len().checked_div(width).unwrap_or(0);
    assert!(reference.len() == width * height && test.len() == reference.len(), "whole rows");
    let [reference, test] = [reference, test].map(to_opponent_space);
    let [colours_a, colours_b] = [&reference, &test].map(|it| filter_contrast(it, width));
    let [features_a, features_b] = [&reference, &test].map(|it| detect_features(it, width));
    let greatest = greatest_color_difference();
    (0..reference.len())
        .into_par_iter()
        .map(|i| {
            let colour = color_difference(colours_a[i], colours_b[i], greatest);
            let feature = feature_difference(features_a[i], features_b[i]);
            libm::powf(colour, 1.0 - feature)
        })
        .collect()
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
