//! A picture at the size of a terminal.

use crate::film::{Picture, Tonemap};
use crate::math::Vec3;

/// A small picture as a display gets it, row by row.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Thumbnail {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The pixels.
    pub pixels: Vec<[u8; 3]>,
}

/// The sides of a picture that fits into `most`; it is never enlarged.
pub fn fit((width, height): (usize, usize), most: (usize, usize)) -> (usize, usize) {
    let ratio = |most: usize, side: usize| most.max(1) as f64 / side.max(1) as f64;
    let scale = ratio(most.0, width).min(ratio(most.1, height)).min(1.0);
    let side =
        |side: usize, most: usize| ((side as f64 * scale).round() as usize).clamp(1, most.max(1));
    (side(width, most.0), side(height, most.1))
}

impl Thumbnail {
    /// A picture's crop, each pixel the mean of those that it stands for, which are finite; `None`
    /// if the picture has no colours. What is transparent shows black.
    pub fn new(
        picture: &Picture,
        most: (usize, usize),
        tonemap: Tonemap,
        exposure: f32,
    ) -> Option<Self> {
        let (from_width, from_height) = (picture.width(), picture.height());
        if picture.crop.area() == 0 {
            return None;
        }
        let (width, height) = fit((from_width, from_height), most);
        let channels = [picture.channel("R")?, picture.channel("G")?, picture.channel("B")?];
        let gain = libm::exp2f(exposure);
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            let rows = span(y, height, from_height);
            for x in 0..width {
                let columns = span(x, width, from_width);
                let mean = channels.map(|channel| {
                    let row = |y: usize| &channel[y * from_width..][columns.clone()];
                    mean(rows.clone().flat_map(row).copied())
                });
                let shown = tonemap.apply(Vec3::from(mean) * gain);
                pixels.push(shown.to_array().map(|value| (value * 255.0 + 0.5) as u8));
            }
        }
        Some(Self { width, height, pixels })
    }

    /// The pixel at a place.
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        self.pixels[y * self.width + x]
    }
}

/// Which of `from` pixels the one at `index` of `to` stands for: one at least.
fn span(index: usize, to: usize, from: usize) -> std::ops::Range<usize> {
    let start = index * from / to;
    start..((index + 1) * from / to).max(start + 1)
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (mut sum, mut count) = (0.0, 0);
    for value in values.filter(|value| value.is_finite()) {
        sum += f64::from(value);
        count += 1;
    }
    (sum / f64::from(count.max(1))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;

    #[test]
    fn pictures_fit_and_keep_their_shape() {
        assert_eq!(fit((1280, 720), (80, 40)), (71, 40));
        assert_eq!(fit((1280, 720), (80, 400)), (80, 45));
        assert_eq!(fit((30, 20), (80, 40)), (30, 20));
        assert_eq!(fit((100_000, 1), (80, 40)), (80, 1));
        assert_eq!(fit((10, 10), (0, 0)), (1, 1));
    }

    #[test]
    fn pixels_are_means_of_what_is_finite() {
        let window = Window::of_size(4, 2);
        let mut picture = Picture::new(window, window);
        assert_eq!(Thumbnail::new(&picture, (2, 2), Tonemap::Srgb, 0.0), None);
        let values = [0.0, 1.0, 0.25, 0.25, 0.0, 1.0, f32::NAN, f32::INFINITY];
        picture.set_aov("", "RGB", &values.map(|value| [value, 0.0, 1.0]));
        let small = Thumbnail::new(&picture, (2, 9), Tonemap::Srgb, 0.0).expect("colours");
        assert_eq!((small.width, small.height), (2, 1));
        assert_eq!(small.pixels, [[188, 0, 255], [137, 0, 255]]);
        let brighter = Thumbnail::new(&picture, (2, 9), Tonemap::Srgb, 1.0).expect("colours");
        assert_eq!(brighter.at(1, 0), [188, 0, 255]);
    }
}
