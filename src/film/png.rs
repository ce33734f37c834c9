//! PNG files: 8 bits per channel for looking at, and read back for comparing.

use super::tonemap::{Tonemap, linear_from_srgb};
use super::{FilmError, Picture, Window, png_label};
use crate::files::{self, Flush, memory};
use crate::math::Vec3;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageError, Limits};
use std::io;
use std::path::Path;

/// Writes the colours of a picture's crop, the denoised ones if there are such, brightened by
/// `exposure` stops and tone-mapped; RGBA with straight alpha if some pixel's alpha is below 1,
/// else RGB. A `label` says what the picture is of; see [`png_label::read`].
///
/// # Errors
/// [`FilmError::Write`]; [`FilmError::Invalid`] if the picture has no colours.
pub fn write(
    path: &Path,
    picture: &Picture,
    tonemap: Tonemap,
    exposure: f32,
    label: Option<&str>,
) -> Result<(), FilmError> {
    let bytes = encode(path, picture, tonemap, exposure, label)?;
    files::write(path, Flush::ToDisk, |file| io::Write::write_all(file, &bytes))
        .map_err(|source| FilmError::write(path, source))
}

/// The bytes of the same file.
///
/// # Errors
/// [`FilmError::Invalid`] if the picture, which `path` names for messages, has no colours.
pub fn encode(
    path: &Path,
    picture: &Picture,
    tonemap: Tonemap,
    exposure: f32,
    label: Option<&str>,
) -> Result<Vec<u8>, FilmError> {
    let (kind, bytes) = display_bytes(path, picture, tonemap, exposure)?;
    let mut file = Vec::new();
    encode_pixels(&mut file, picture.width(), picture.height(), kind, &bytes)
        .map_err(|error| FilmError::invalid(path, error.to_string()))?;
    if let Some(label) = label {
        png_label::insert(&mut file, label);
    }
    Ok(file)
}

/// The bytes of a file of 8-bit RGB pixels, row by row.
///
/// # Errors
/// [`io::Error`] for sides beyond PNG's.
pub fn encode_rgb8(width: usize, height: usize, pixels: &[[u8; 3]]) -> io::Result<Vec<u8>> {
    let mut file = Vec::new();
    let kind = ExtendedColorType::Rgb8;
    encode_pixels(&mut file, width, height, kind, pixels.as_flattened())?;
    Ok(file)
}

/// Writes 8-bit RGB pixels, row by row, as they are.
///
/// # Errors
/// [`FilmError::Write`].
pub fn write_rgb8(
    path: &Path,
    width: usize,
    height: usize,
    pixels: &[[u8; 3]],
) -> Result<(), FilmError> {
    let (kind, bytes) = (ExtendedColorType::Rgb8, pixels.as_flattened());
    files::write(path, Flush::ToDisk, |file| encode_pixels(file, width, height, kind, bytes))
        .map_err(|source| FilmError::write(path, source))
}

/// Writes pixels of any kind, row by row, as a PNG.
///
/// # Errors
/// [`io::Error`] for sides beyond PNG's, and those of `file`.
pub fn encode_pixels(
    file: &mut impl io::Write,
    width: usize,
    height: usize,
    kind: ExtendedColorType,
    bytes: &[u8],
) -> io::Result<()> {
    let side = |side: usize| u32::try_from(side).map_err(io::Error::other);
    image::codecs::png::PngEncoder::new(file)
        .write_image(bytes, side(width)?, side(height)?, kind)
        .map_err(|error| match error {
            ImageError::IoError(error) => error,
            error => io::Error::other(error),
        })
}

fn display_bytes(
    path: &Path,
    picture: &Picture,
    tonemap: Tonemap,
    exposure: f32,
) -> Result<(ExtendedColorType, Vec<u8>), FilmError> {
    let gain = libm::exp2f(exposure);
    let colours = picture.shown_rgb(path)?;
    let byte = |value: f32| (value * 255.0 + 0.5) as u8;
    let display = |colour: Vec3| tonemap.apply(colour * gain).to_array().map(byte);
    let alphas = picture.channel("A").filter(|alphas| alphas.iter().any(|&alpha| alpha < 1.0));
    let Some(alphas) = alphas else {
        let pixels = colours.iter().flat_map(|&colour| display(colour.into()));
        return Ok((ExtendedColorType::Rgb8, pixels.collect()));
    };
    let mut bytes = Vec::with_capacity(4 * colours.len());
    for (&colour, &alpha) in colours.iter().zip(alphas) {
        let alpha = alpha.clamp(0.0, 1.0);
        // PNG wants straight alpha. Where there is none, the colour is of no account.
        let straight = if alpha > 0.0 { Vec3::from(colour) / alpha } else { Vec3::ZERO };
        bytes.extend_from_slice(&display(straight));
        bytes.push(byte(alpha));
    }
    Ok((ExtendedColorType::Rgba8, bytes))
}

/// Reads a PNG as a picture in linear light (8 or 16 bits, grey or coloured, all taken as sRGB;
/// colours are multiplied by their alpha). What is seen is compared, so no tone map is undone.
///
/// # Errors
/// [`FilmError::Read`]; [`FilmError::Invalid`] for a damaged file or one of over 2^28 pixels.
pub fn read(path: &Path) -> Result<Picture, FilmError> {
    let failed = |error: ImageError| match error {
        ImageError::IoError(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
            FilmError::read(path, source)
        }
        error => FilmError::invalid(path, format!("not a sound PNG file: {error}")),
    };
    let (file, _) = files::open(path).map_err(|error| FilmError::read(path, error))?;
    let mut reader =
        image::ImageReader::with_format(io::BufReader::new(file), image::ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(1 << 30);
    (limits.max_image_width, limits.max_image_height) = (Some(1 << 24), Some(1 << 24));
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    // As they are in the file, as 16 bits, as floats, and those once more by channel.
    let bytes = u64::from(width) * u64::from(height) * (8 + 8 + 12 + 16);
    memory::claim(bytes).map_err(|error| FilmError::invalid(path, error.to_string()))?;
    let image = DynamicImage::from_decoder(decoder).map_err(failed)?.into_rgba16();

    let window = Window::of_size(image.width() as usize, image.height() as usize);
    let mut picture = Picture::new(window, window);
    let value = |value: u16| f32::from(value) / 65535.0;
    let colours: Vec<_> = image
        .pixels()
        .map(|pixel| {
            let [r, g, b, a] = pixel.0.map(value);
            [r, g, b].map(|it| linear_from_srgb(it) * a)
        })
        .collect();
    picture.set_aov("", "RGB", &colours);
    picture.set_channel("A", image.pixels().map(|pixel| value(pixel.0[3])).collect());
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(colours: &[[f32; 3]], alphas: &[f32]) -> Picture {
        let window = Window::of_size(colours.len(), 1);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", colours);
        picture.set_channel("A", alphas.to_vec());
        picture
    }

    #[test]
    fn opaque_pictures_are_rgb_and_exposure_counts_in_stops() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        let colours = [[0.0, 0.5, 1.0], [0.108, 0.25, 0.0]];
        write(&path, &picture(&colours, &[1.0, 1.0]), Tonemap::Srgb, 1.0, None).expect("written");
        let back = image::open(&path).expect("read");
        assert_eq!(back.color(), image::ColorType::Rgb8);
        assert_eq!(back.as_bytes(), [0, 255, 255, 128, 188, 0]);
    }

    #[test]
    fn alpha_becomes_straight() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        let colours = [[0.5, 0.0, 0.0], [0.0; 3]];
        write(&path, &picture(&colours, &[0.5, 0.0]), Tonemap::Srgb, 0.0, None).expect("written");
        let back = image::open(&path).expect("read");
        assert_eq!(back.as_bytes(), [255, 0, 0, 128, 0, 0, 0, 0]);
        let linear = read(&path).expect("read").rgb(&path).expect("colours");
        assert!((linear[0][0] - 0.502).abs() < 1e-3 && linear[1] == [0.0; 3], "{linear:?}");
    }

    #[test]
    fn damaged_files_are_errors_that_name_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.png");
        write(&path, &picture(&[[0.5; 3]; 9], &[1.0; 9]), Tonemap::Agx, 0.0, None)
            .expect("written");
        let bytes = std::fs::read(&path).expect("read");
        for length in 0..bytes.len() - 12 {
            std::fs::write(&path, &bytes[..length]).expect("cut");
            let error = read(&path).expect_err("cut short");
            assert!(error.exit_code() == 3 && error.to_string().contains("a.png"), "{error}");
        }
    }
}
