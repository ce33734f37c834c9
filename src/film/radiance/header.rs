//! The header of a Radiance picture: lines of text, an empty one, and the size.

use std::io::{self, BufRead, Read};

use super::error::RadianceError;
use crate::film::primaries::Primaries;
use crate::math::{DMat3, DVec3};

/// The longest header: real ones are some lines, with the commands that made the picture.
const MAX_BYTES: u64 = 1 << 20;

/// Whether a file's first bytes are those of a Radiance picture, whatever program wrote it.
pub fn is_radiance(start: &[u8]) -> bool {
    start.starts_with(b"#?")
}

/// What stands before the pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Pixels from left to right, once upright; at least 1.
    pub width: usize,
    /// Pixels from top to bottom, once upright; at least 1.
    pub height: usize,
    /// What red, green and blue were multiplied by since they were radiance.
    pub(super) exposure: [f64; 3],
    /// What takes colours to Rec. 709; none where they are.
    pub(super) to_rec_709: Option<DMat3>,
    /// From scanline to scanline, and within one.
    axes: [Axis; 2],
    /// How many times as high as wide pixels are; not a number where the file has none there.
    pixel_aspect: f64,
}

/// Along what pixels follow one another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis {
    /// `X` to the right, or else `Y` upwards.
    is_x: bool,
    /// Or the other way.
    ascends: bool,
    count: usize,
}

impl Axis {
    /// The coordinate of the pixel that comes so many after the first.
    fn coordinate(&self, at: usize) -> usize {
        if self.ascends { at } else { self.count - 1 - at }
    }
}

impl Header {
    /// Reads from the first byte up to the pixels.
    ///
    /// # Errors
    /// [`RadianceError`] with the line.
    pub fn read(source: &mut impl BufRead) -> Result<Self, RadianceError> {
        let mut lines = Lines { source: source.by_ref().take(MAX_BYTES), number: 0 };
        if !is_radiance(&lines.next()?) {
            return Err(lines.error("is not that of a Radiance picture, which begins with #?"));
        }
        let (mut exposure, mut to_rec_709, mut pixel_aspect) = (DVec3::ONE, None, 1.0);
        loop {
            let line = lines.next()?;
            let text = String::from_utf8_lossy(&line);
            if text.is_empty() {
                break;
            }
            // Indented lines are of the pictures that this one was made of.
            let Some((key, value)) = text.split_once('=') else { continue };
            match key {
                "FORMAT" => check_format(value).map_err(|problem| lines.error(&problem))?,
                "EXPOSURE" => {
                    exposure *= positive::<1>(value).map_err(|it| lines.fault(key, it))?[0];
                }
                "COLORCORR" => {
                    let factors = positive::<3>(value).map_err(|it| lines.fault(key, it))?;
                    exposure *= DVec3::from_array(factors);
                }
                "PIXASPECT" => {
                    pixel_aspect *= positive::<1>(value).map_or(f64::NAN, |it| it[0]);
                }
                "PRIMARIES" => {
                    to_rec_709 = primaries(value).map_err(|it| lines.fault(key, it))?;
                }
                _ => {}
            }
        }
        if !(exposure.is_finite() && exposure.min_element() > 0.0) {
            return Err(lines.error("all exposures together are beyond all numbers"));
        }
        let line = lines.next()?;
        let axes = axes(&String::from_utf8_lossy(&line))
            .ok_or_else(|| lines.error("is not the size of the picture, as in -Y 512 +X 1024"))?;
        let [width, height] =
            if axes[0].is_x { axes } else { [axes[1], axes[0]] }.map(|it| it.count);
        let exposure = exposure.to_array();
        Ok(Self { width, height, exposure, to_rec_709, axes, pixel_aspect })
    }

    /// What it asks for that is not honoured.
    pub fn notes(&self) -> Vec<String> {
        let aspect = self.pixel_aspect;
        let is_square = (aspect - 1.0).abs() <= 1e-4;
        let note = || format!("PIXASPECT is {aspect} and is not honoured: pixels count as square");
        (!is_square).then(note).into_iter().collect()
    }

    /// How many scanlines there are, and how long each is.
    pub(super) fn scanlines(&self) -> (usize, usize) {
        (self.axes[0].count, self.axes[1].count)
    }

    /// What a scanline is once the picture is upright.
    pub(super) fn scanline_name(&self) -> &'static str {
        if self.axes[0].is_x { "column" } else { "row" }
    }

    /// Pixels in the file's order to rows from the top.
    pub(super) fn turn_upright(&self, pixels: Vec<[f32; 3]>) -> Vec<[f32; 3]> {
        let [outer, inner] = self.axes;
        if !outer.is_x && !outer.ascends && inner.ascends {
            return pixels;
        }
        let mut upright = vec![[0.0; 3]; pixels.len()];
        for (i, scanline) in pixels.chunks_exact(inner.count).enumerate() {
            for (j, &pixel) in scanline.iter().enumerate() {
                let (a, b) = (outer.coordinate(i), inner.coordinate(j));
                let (x, y) = if outer.is_x { (a, b) } else { (b, a) };
                upright[(self.height - 1 - y) * self.width + x] = pixel;
            }
        }
        upright
    }
}

/// Lines one by one, and their number.
struct Lines<R> {
    source: io::Take<R>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// The next one, without its end.
    fn next(&mut self) -> Result<Vec<u8>, RadianceError> {
        let mut line = Vec::new();
        self.number += 1;
        self.source.read_until(b'\n', &mut line)?;
        if line.pop() != Some(b'\n') {
            return Err(self.error("ends within the header"));
        }
        if line.last() == Some(&b'\r') {
            line.pop();
        }
        Ok(line)
    }

    fn error(&self, problem: &str) -> RadianceError {
        RadianceError::Header(format!("line {}: {problem}", self.number))
    }

    fn fault(&self, key: &str, problem: &str) -> RadianceError {
        self.error(&format!("{key} {problem}"))
    }
}

fn check_format(value: &str) -> Result<(), String> {
    match value.trim() {
        "32-bit_rle_rgbe" => Ok(()),
        "32-bit_rle_xyze" => Err("holds CIE XYZ, which is not supported: \
                                  convert it by `ra_xyze -r`"
            .to_owned()),
        other => {
            let name: String = other.chars().take(40).collect();
            Err(format!("the format {name:?} is not supported, only 32-bit_rle_rgbe"))
        }
    }
}

/// So many numbers, all above 0.
fn positive<const N: usize>(value: &str) -> Result<[f64; N], &'static str> {
    let found = numbers::<N>(value).ok_or("lacks numbers")?;
    if found.iter().all(|&number| number > 0.0) { Ok(found) } else { Err("is not above 0") }
}

/// The first `N` numbers, if they are there and finite.
fn numbers<const N: usize>(value: &str) -> Option<[f64; N]> {
    let words = value.split_whitespace().take(N).map(|word| word.parse::<f64>().ok());
    let found: Vec<f64> = words.collect::<Option<_>>()?;
    found.try_into().ok().filter(|all: &[f64; N]| all.iter().all(|it| it.is_finite()))
}

fn primaries(value: &str) -> Result<Option<DMat3>, &'static str> {
    let primaries = Primaries::from_array(numbers::<8>(value).ok_or("lacks its eight numbers")?);
    if primaries.is_rec_709() {
        return Ok(None);
    }
    primaries.to_rec_709().map(Some).ok_or("spans no colours")
}

/// Such as `-Y 512 +X 1024`.
fn axes(line: &str) -> Option<[Axis; 2]> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[first, rows, second, columns] = &words[..] else { return None };
    let axis = |name: &str, count: &str| {
        let (is_x, ascends) = match name {
            "+X" => (true, true),
            "-X" => (true, false),
            "+Y" => (false, true),
            "-Y" => (false, false),
            _ => return None,
        };
        let count = count.parse::<u32>().ok().filter(|&count| count > 0)?;
        Some(Axis { is_x, ascends, count: count as usize })
    };
    let axes = [axis(first, rows)?, axis(second, columns)?];
    (axes[0].is_x != axes[1].is_x).then_some(axes)
}
