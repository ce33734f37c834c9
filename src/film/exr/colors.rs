//! The colours of OpenEXR files, whatever channels hold them, in their frame.

use std::io::{Read, Seek};
use std::path::Path;

use super::read::{Meaning, decode_channels, open};
use crate::files::memory;
use crate::film::primaries;
use crate::film::{FilmError, Picture, Window};

/// Colours in the frame of a file: its display window.
#[derive(Clone, Debug, PartialEq)]
pub struct Framed<T> {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Rows from the top; zero where the file has no pixels.
    pub pixels: Vec<T>,
    /// What is odd about the file.
    pub notes: Vec<String>,
}

/// Reads the colours alone: width, height and linear Rec. 709 of the data window. `Y` alone stands
/// for all three, `Y RY BY` are luminance and chroma.
///
/// # Errors
/// As for [`super::read`], and [`FilmError::Invalid`] if there are no colours.
pub fn read_rgb(path: &Path) -> Result<(usize, usize, Vec<[f32; 3]>), FilmError> {
    let (file, length) = open(path)?;
    let (picture, meaning) = decode_channels(file, length, path, is_colour)?;
    Ok((picture.width(), picture.height(), colours(&picture, meaning, path)?))
}

/// The colours of a file of `length` bytes from anywhere, as [`read_rgb`], but in the whole frame;
/// `path` is for messages.
///
/// # Errors
/// As [`read_rgb`].
pub fn decode_rgb(
    source: impl Read + Seek,
    length: u64,
    path: &Path,
) -> Result<Framed<[f32; 3]>, FilmError> {
    let (picture, meaning) = decode_channels(source, length, path, is_colour)?;
    let pixels = colours(&picture, meaning, path)?;
    frame(&picture, pixels, meaning, path)
}

/// The same with alpha, which colours are multiplied by; 1 where the file has none.
///
/// # Errors
/// As [`read_rgb`].
pub fn decode_rgba(
    source: impl Read + Seek,
    length: u64,
    path: &Path,
) -> Result<Framed<[f32; 4]>, FilmError> {
    let wanted = |name: &str| is_colour(name) || name == "A";
    let (picture, meaning) = decode_channels(source, length, path, wanted)?;
    let colours = colours(&picture, meaning, path)?;
    let with = |([r, g, b], a): ([f32; 3], f32)| [r, g, b, a];
    let texels = match picture.channel("A") {
        Some(alpha) => colours.into_iter().zip(alpha.iter().copied()).map(with).collect(),
        None => colours.into_iter().map(|colour| with((colour, 1.0))).collect(),
    };
    frame(&picture, texels, meaning, path)
}

/// Whether a channel is of the colours, or of those that cannot be taken for grey.
fn is_colour(name: &str) -> bool {
    matches!(name, "R" | "G" | "B" | "Y" | "RY" | "BY" | "X" | "Z")
}

/// Linear Rec. 709 of the data window.
fn colours(picture: &Picture, meaning: Meaning, path: &Path) -> Result<Vec<[f32; 3]>, FilmError> {
    let Some(primaries) = meaning.primaries else { return picture.rgb(path) };
    let no_colours = || FilmError::invalid(path, "its chromaticities span no colours");
    let shares = primaries.luminance().ok_or_else(no_colours)?;
    let mut pixels = picture.rgb_by(shares, path)?;
    let matrix = primaries.to_rec_709().ok_or_else(no_colours)?;
    primaries::transform(&matrix, &mut pixels);
    Ok(pixels)
}

/// Puts the pixels of the data window into the display window.
fn frame<T: Copy + Default>(
    picture: &Picture,
    pixels: Vec<T>,
    meaning: Meaning,
    path: &Path,
) -> Result<Framed<T>, FilmError> {
    let mut notes = Vec::new();
    if meaning.is_cube {
        notes.push("says that it is a cube of directions, which is not honoured".to_owned());
    }
    if (meaning.pixel_aspect - 1.0).abs() > 1e-4 {
        let aspect = meaning.pixel_aspect;
        notes.push(format!(
            "its pixelAspectRatio is {aspect} and is not honoured: pixels count as square"
        ));
    }
    let (crop, frame) = (picture.crop, picture.frame);
    let shared = Window {
        x0: crop.x0.max(frame.x0),
        y0: crop.y0.max(frame.y0),
        x1: crop.x1.min(frame.x1),
        y1: crop.y1.min(frame.y1),
    };
    let whole = Framed { width: picture.width(), height: picture.height(), pixels, notes };
    if crop == frame {
        return Ok(whole);
    }
    if shared.x0 >= shared.x1 || shared.y0 >= shared.y1 {
        let mut whole = whole;
        whole
            .notes
            .push("its data window is outside of its display window: it alone counts".into());
        return Ok(whole);
    }
    let Framed { pixels, mut notes, .. } = whole;
    let (width, height) = (frame.width(), frame.height());
    let bytes = (width as u64).saturating_mul(height as u64).saturating_mul(size_of::<T>() as u64);
    memory::claim(bytes).map_err(|error| FilmError::invalid(path, error.to_string()))?;
    if shared != frame {
        let (w, h) = (shared.width(), shared.height());
        let (x, y) = (shared.x0.abs_diff(frame.x0), shared.y0.abs_diff(frame.y0));
        notes.push(format!(
            "holds {w}x{h} pixels at {x}, {y} of its frame of {width}x{height}: the rest is black"
        ));
    }
    if shared != crop {
        notes.push("has pixels outside of its display window, which are left out".to_owned());
    }
    let mut framed = vec![T::default(); width * height];
    for y in shared.y0..shared.y1 {
        let at = |window: Window, width: usize| {
            y.abs_diff(window.y0) as usize * width + shared.x0.abs_diff(window.x0) as usize
        };
        let (to, from) = (at(frame, width), at(crop, crop.width()));
        let count = shared.width();
        framed[to..to + count].copy_from_slice(&pixels[from..from + count]);
    }
    Ok(Framed { width, height, pixels: framed, notes })
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::super::encode;
    use super::*;

    fn decoded(picture: &Picture) -> Result<Framed<[f32; 3]>, FilmError> {
        let bytes = encode(picture).expect("encodes");
        decode_rgb(Cursor::new(&bytes), bytes.len() as u64, Path::new("a.exr"))
    }

    fn one_pixel(channels: &[(&str, f32)]) -> Picture {
        let window = Window::of_size(1, 1);
        let mut picture = Picture::new(window, window);
        for (name, value) in channels {
            picture.set_channel(*name, vec![*value]);
        }
        picture
    }

    #[test]
    fn luminance_and_chroma_are_colours() {
        let y = 0.2126 * 2.0 + 0.7152 + 0.0722 * 0.25;
        let chroma = [("Y", y), ("RY", (2.0 - y) / y), ("BY", (0.25 - y) / y)];
        let found = decoded(&one_pixel(&chroma)).expect("they are colours").pixels[0];
        let off = found.iter().zip([2.0, 1.0, 0.25]).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f32::max) < 1e-3, "{found:?}");
        let black = [("Y", 0.0), ("RY", 0.0), ("BY", 0.0)];
        assert_eq!(decoded(&one_pixel(&black)).expect("they are colours").pixels, [[0.0; 3]]);
        // With one of both alone nothing can be told.
        let error = decoded(&one_pixel(&chroma[..2])).expect_err("BY is missing").to_string();
        assert_eq!(error, "a.exr: has RY and no BY: its colours cannot be told");
    }

    #[test]
    fn xyz_is_refused_and_not_taken_for_grey() {
        let xyz = [("X", 0.9), ("Y", 1.0), ("Z", 1.1)];
        let error = decoded(&one_pixel(&xyz)).expect_err("is no RGB").to_string();
        assert!(error.starts_with("a.exr: the channels X, Y and Z are not supported"), "{error}");
        let error = decoded(&one_pixel(&xyz[..2])).expect_err("is no grey").to_string();
        assert!(error.starts_with("a.exr: has X and Y and no Z: its colours cannot"), "{error}");
        // A depth goes with grey.
        assert_eq!(decoded(&one_pixel(&xyz[1..])).expect("is grey").pixels, [[1.0; 3]]);
        // Beside colours they are something else.
        let both = [("X", 0.9), ("Y", 1.0), ("Z", 1.1), ("R", 0.1), ("G", 0.2), ("B", 0.3)];
        assert_eq!(decoded(&one_pixel(&both)).expect("has colours").pixels, [[0.1, 0.2, 0.3]]);
    }

    #[test]
    fn a_data_window_is_put_into_its_frame() {
        let crop = Window { x0: 6, y0: 5, x1: 8, y1: 6 };
        let mut picture = Picture::new(Window { x0: 5, y0: 4, x1: 9, y1: 6 }, crop);
        picture.set_channel("Y", vec![1.0, 2.0]);
        let Framed { width, height, pixels, notes } = decoded(&picture).expect("it is sound");
        assert_eq!((width, height), (4, 2));
        let grey: Vec<f32> = pixels.iter().map(|pixel| pixel[0]).collect();
        assert_eq!(grey, [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0]);
        assert_eq!(notes, ["holds 2x1 pixels at 1, 1 of its frame of 4x2: the rest is black"]);
        // Beyond the frame on one side.
        let mut picture = Picture::new(Window { x0: 7, y0: 5, x1: 8, y1: 6 }, crop);
        picture.set_channel("Y", vec![1.0, 2.0]);
        let framed = decoded(&picture).expect("it is sound");
        assert_eq!(framed.pixels, [[2.0; 3]]);
        assert_eq!(framed.notes, ["has pixels outside of its display window, which are left out"]);
        // Elsewhere altogether.
        let mut picture = Picture::new(Window::of_size(2, 2), crop);
        picture.set_channel("Y", vec![1.0, 2.0]);
        let framed = decoded(&picture).expect("it is sound");
        assert_eq!((framed.pixels, framed.notes.len()), (vec![[1.0; 3], [2.0; 3]], 1));
    }

    #[test]
    fn pixels_that_are_not_square_are_said() {
        use ::exr::prelude::*;
        let channels = SpecificChannels::rgb(|_| (1.0_f32, 0.5_f32, 0.25_f32));
        let mut image = ::exr::prelude::Image::from_channels((1, 1), channels);
        image.attributes.pixel_aspect = 2.0;
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("written");
        let bytes = bytes.into_inner();
        let found = decode_rgb(Cursor::new(&bytes), bytes.len() as u64, Path::new("a.exr"));
        let found = found.expect("it is sound");
        let said = "its pixelAspectRatio is 2 and is not honoured: pixels count as square";
        assert_eq!(found.notes, [said]);
        assert_eq!(found.pixels, [[1.0, 0.5, 0.25]]);
    }

    /// A file that says to be in Rec. 2020, as other programs write it.
    #[test]
    fn chromaticities_are_taken_to_rec_709() {
        use ::exr::meta::attribute::Chromaticities;
        use ::exr::prelude::*;
        let channels = SpecificChannels::rgb(|_| (1.0_f32, 0.0_f32, 0.0_f32));
        let mut image = ::exr::prelude::Image::from_channels((1, 1), channels);
        let wide = Chromaticities {
            red: Vec2(0.708, 0.292),
            green: Vec2(0.17, 0.797),
            blue: Vec2(0.131, 0.046),
            white: Vec2(0.3127, 0.329),
        };
        image.attributes.chromaticities = Some(wide);
        let mut bytes = Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("written");
        let bytes = bytes.into_inner();
        let found = decode_rgb(Cursor::new(&bytes), bytes.len() as u64, Path::new("a.exr"));
        let found = found.expect("it is sound").pixels[0];
        let off = found.iter().zip([1.6605, -0.1246, -0.0182]).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f32::max) < 1e-3, "{found:?}");
    }
}
