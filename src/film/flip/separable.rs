//! Separable filters, their edges clamped.

use rayon::prelude::*;

use crate::math::Vec4;

/// Pixels per degree of the eye: 0.7 m from a screen 0.7 m and 3840 pixels wide.
pub const PIXELS_PER_DEGREE: f32 = 0.7 * (3840.0 / 0.7) * (std::f32::consts::PI / 180.0);

pub fn filter_rows(picture: &[Vec4], width: usize, taps: &[Vec4]) -> Vec<Vec4> {
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

pub fn filter_columns(picture: &[Vec4], width: usize, taps: &[Vec4]) -> Vec<Vec4> {
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
