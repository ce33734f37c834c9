//! The range of exposures at which pictures of high dynamic range are shown, and the tone map.

use crate::math::Vec3;

/// The quotient of quadratics of K. Narkowicz's fit of ACES, with its exposure of 0.6 taken out:
/// `(a x² + b x) / (c x² + d x + e)`.
const ACES: [f64; 5] = [0.36 * 2.51, 0.6 * 0.03, 0.36 * 2.43, 0.6 * 0.59, 0.14];

/// In f64, where no square of a float overflows.
pub fn tone_map_aces(colour: [f32; 3], gain: f32) -> Vec3 {
    let [a, b, c, d, e] = ACES;
    Vec3::from_array(colour.map(|value| {
        let x = f64::from(value.max(0.0)) * f64::from(gain);
        let y = (a * x * x + b * x) / (c * x * x + d * x + e);
        (y as f32).clamp(0.0, 1.0)
    }))
}

/// The shortest and the longest exposure, in stops: those that bring the brightest luminance and
/// the median luminance to 0.85 of the tone map's range.
pub fn exposure_range(reference: &[[f32; 3]]) -> (f32, f32) {
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
