//! Pixels of an environment that are no numbers, mended from their neighbours.

/// What to do about pixels that are infinite or not a number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NotFinite {
    /// An error that names the first of them.
    #[default]
    Refuse,
    /// The mean of their neighbours takes their place, which is said.
    Repair,
}

/// How far a pixel may be from those that it is mended by: what is farther is no small flaw.
const MAX_STEPS: usize = 64;

/// Pixels are left that have nothing to be mended by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TooMany;

/// Whether all numbers of a pixel are.
pub(super) fn is_finite(pixel: &[f32; 3]) -> bool {
    pixel.iter().all(|value| value.is_finite())
}

/// Puts the mean of the neighbours in the place of each pixel that is not finite: of those eight
/// that are, around the left and right edge. Where none is, what was mended a step before counts.
///
/// # Errors
/// [`TooMany`].
pub(super) fn repair(width: usize, pixels: &mut [[f32; 3]]) -> Result<(), TooMany> {
    let mut left: Vec<usize> = (0..pixels.len()).filter(|&at| !is_finite(&pixels[at])).collect();
    for _ in 0..MAX_STEPS {
        if left.is_empty() {
            break;
        }
        // All of a step are known before any is put in, so that their order does not matter.
        let means: Vec<_> = left.iter().map(|&at| mean_around(width, pixels, at)).collect();
        for (&at, mean) in left.iter().zip(means) {
            pixels[at] = mean.unwrap_or(pixels[at]);
        }
        left.retain(|&at| !is_finite(&pixels[at]));
    }
    if left.is_empty() { Ok(()) } else { Err(TooMany) }
}

/// The mean of the finite neighbours of a pixel.
fn mean_around(width: usize, pixels: &[[f32; 3]], at: usize) -> Option<[f32; 3]> {
    let (x, y) = (at % width, at / width);
    let (mut sum, mut count) = ([0.0_f64; 3], 0);
    for row in y.saturating_sub(1)..(y + 2).min(pixels.len() / width) {
        for column in [x + width - 1, x, x + 1] {
            let pixel = &pixels[row * width + column % width];
            if is_finite(pixel) {
                (0..3).for_each(|k| sum[k] += f64::from(pixel[k]));
                count += 1;
            }
        }
    }
    (count > 0).then(|| sum.map(|value| (value / f64::from(count)) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: [f32; 3] = [f32::NAN; 3];

    #[test]
    fn the_mean_of_the_neighbours_takes_the_place() {
        // The last column is beside the first.
        let mut pixels = vec![NAN, [1.0; 3], [9.0; 3], [3.0; 3]];
        assert_eq!(repair(4, &mut pixels), Ok(()));
        assert_eq!(pixels, [[2.0; 3], [1.0; 3], [9.0; 3], [3.0; 3]]);
        // In the middle of three by three, all eight.
        let mut pixels = vec![[1.0; 3]; 9];
        (pixels[0], pixels[4]) = ([9.0; 3], [1.0, f32::NEG_INFINITY, 0.0]);
        assert_eq!(repair(3, &mut pixels), Ok(()));
        assert_eq!(pixels[4], [2.0; 3]);
    }

    #[test]
    fn what_is_far_from_all_others_is_mended_step_by_step_up_to_a_limit() {
        let mut pixels = vec![NAN; 100];
        pixels[0] = [1.0; 3];
        assert_eq!(repair(100, &mut pixels), Ok(()));
        assert_eq!(pixels, [[1.0; 3]; 100]);
        let mut pixels = vec![NAN; 200];
        pixels[0] = [1.0; 3];
        assert_eq!(repair(200, &mut pixels), Err(TooMany));
        assert_eq!(repair(2, &mut [NAN; 2]), Err(TooMany));
    }
}
