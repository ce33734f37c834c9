//! Images from the bytes of their files, within limits, straight into the memory that they keep.

use std::io::Cursor;
use std::path::Path;

use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::image::Image;
use super::ktx2;
use super::texels::{Texels, Value};
use crate::files::memory::{self, TooMuch};
use crate::film::radiance::{self, RadianceError, is_radiance};
use crate::film::{FilmError, exr};

/// Why an image could not be decoded; says what, not which file.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The decoder's own words, or those of a limit.
    #[error("{0}")]
    Decode(#[from] image::ImageError),
    /// The same of an OpenEXR file.
    #[error("{0}")]
    Exr(String),
    /// The same of a KTX 2.0 file.
    #[error("{0}")]
    Ktx2(String),
    /// The same of a Radiance picture.
    #[error("{0}")]
    Radiance(#[from] RadianceError),
    /// The first bytes are those of no format that dapple reads, nor does the name tell.
    #[error(
        "not an image that dapple reads (png, jpeg, webp, tga, bmp, gif, tiff, ktx2, hdr, exr)"
    )]
    UnknownFormat,
    /// A float image with infinities or NaNs in it.
    #[error("texel {x}, {y} is infinite or not a number")]
    NotFinite {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
    },
    /// No texels.
    #[error("the image has no texels")]
    Empty,
    /// Its header claims more than there is.
    #[error("{0}: make it smaller")]
    Memory(#[from] TooMuch),
    /// Its header claims more than any image may have.
    #[error("{0} by {1} texels are too many: at most 16384 a side")]
    TooLarge(u64, u64),
}

/// The largest width and height that are decoded.
const MAX_SIZE: u32 = 16384;

/// The most memory that a decoder may take.
const MAX_BYTES: u64 = 1 << 30;

impl Image {
    /// Decodes a file's bytes. The format is told by the first bytes; only where these are silent
    /// (tga has no signature) by the ending of `name`. Where an OpenEXR file has alpha, colours are
    /// divided by it, as textures have them.
    ///
    /// # Errors
    /// [`ImageError`]; among others beyond 16384 texels a side, 1 GiB, or what memory is left.
    pub fn decode(bytes: &[u8], name: &str) -> Result<Self, ImageError> {
        Ok(Self::decode_noting(bytes, name)?.0)
    }

    /// The same, and what is odd about the file.
    ///
    /// # Errors
    /// As for [`Image::decode`].
    pub fn decode_noting(bytes: &[u8], name: &str) -> Result<(Self, Vec<String>), ImageError> {
        if is_exr(bytes) {
            return decode_exr(bytes, name);
        }
        if ktx2::is_ktx2(bytes) {
            return ktx2::decode(bytes, MAX_SIZE).map_err(ImageError::Ktx2);
        }
        let image =
            if is_radiance(bytes) { decode_radiance(bytes) } else { decode_other(bytes, name) };
        Ok((image?, Vec::new()))
    }

    /// The memory that the texels of a file would take, by its header alone; for OpenEXR files the
    /// most that it can be.
    ///
    /// # Errors
    /// As for [`Image::decode`], as far as the header tells.
    pub fn decoded_bytes(bytes: &[u8], name: &str) -> Result<u64, ImageError> {
        if is_exr(bytes) {
            let (width, height) = exr_size(bytes)?;
            return Ok(width * height * size_of::<[f32; 4]>() as u64);
        }
        if ktx2::is_ktx2(bytes) {
            return ktx2::decoded_bytes(bytes, MAX_SIZE).map_err(ImageError::Ktx2);
        }
        if is_radiance(bytes) {
            let mut source = bytes;
            let (width, height) = radiance_size(&radiance::Header::read(&mut source)?)?;
            return Ok(width * height * size_of::<[f32; 3]>() as u64);
        }
        Ok(decoder(bytes, name)?.0.total_bytes())
    }
}

/// Decodes what the crate `image` reads.
fn decode_other(bytes: &[u8], name: &str) -> Result<Image, ImageError> {
    let (decoder, format) = decoder(bytes, name)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(ImageError::Empty);
    }
    memory::claim(peak_bytes(&decoder, format))?;
    let channels = decoder.color_type().channel_count();
    let texels = match decoder.color_type() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => read::<u8>(decoder)?,
        ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16 => {
            read::<u16>(decoder)?
        }
        ColorType::Rgb32F | ColorType::Rgba32F => {
            let texels = read::<f32>(decoder)?;
            check_finite(&texels, channels, width)?;
            texels
        }
        _ => return Err(ImageError::UnknownFormat),
    };
    Ok(Image::new(width, height, channels, texels))
}

fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01])
}

fn exr_size(bytes: &[u8]) -> Result<(u64, u64), ImageError> {
    let (width, height) = exr::size(bytes).map_err(ImageError::Exr)?;
    if width.max(height) > u64::from(MAX_SIZE) {
        return Err(ImageError::TooLarge(width, height));
    }
    Ok((width, height))
}

fn decode_exr(bytes: &[u8], name: &str) -> Result<(Image, Vec<String>), ImageError> {
    exr_size(bytes)?;
    let source = Cursor::new(bytes);
    let decoded = exr::decode_rgba(source, bytes.len() as u64, Path::new(name));
    let exr::Framed { width, height, pixels: mut texels, notes } =
        decoded.map_err(|error| match error {
            FilmError::Invalid { message, .. } => ImageError::Exr(message),
            other => ImageError::Exr(other.to_string()),
        })?;
    for [r, g, b, a] in texels.iter_mut().filter(|texel| texel[3] > 0.0 && texel[3] < 1.0) {
        (*r, *g, *b) = (*r / *a, *g / *a, *b / *a);
    }
    let (width, height) = (width as u32, height as u32);
    let channels = needed_channels(&texels);
    let texels = match channels {
        1 => Texels::F32(texels.iter().map(|texel| texel[0]).collect()),
        2 => Texels::F32(texels.iter().flat_map(|texel| [texel[0], texel[3]]).collect()),
        3 => Texels::F32(texels.iter().flat_map(|texel| [texel[0], texel[1], texel[2]]).collect()),
        _ => Texels::F32(texels.into_flattened()),
    };
    check_finite(&texels, channels, width)?;
    Ok((Image::new(width, height, channels, texels), notes))
}

/// The fewest channels that hold the same: OpenEXR files are read with all four.
fn needed_channels(texels: &[[f32; 4]]) -> u8 {
    let same = |a: f32, b: f32| a.to_bits() == b.to_bits();
    let grey = texels.iter().all(|&[r, g, b, _]| same(r, g) && same(g, b));
    let opaque = texels.iter().all(|texel| texel[3] == 1.0);
    match (grey, opaque) {
        (true, true) => 1,
        (true, false) => 2,
        (false, true) => 3,
        (false, false) => 4,
    }
}

/// Width and height, within the limits.
fn radiance_size(header: &radiance::Header) -> Result<(u64, u64), ImageError> {
    let (width, height) = (header.width as u64, header.height as u64);
    if width.max(height) > u64::from(MAX_SIZE) {
        return Err(ImageError::TooLarge(width, height));
    }
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_BYTES);
    limits.reserve(width * height * size_of::<[f32; 3]>() as u64)?;
    Ok((width, height))
}

fn decode_radiance(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut source = bytes;
    let header = radiance::Header::read(&mut source)?;
    let (width, height) = radiance_size(&header)?;
    // As they come, and upright.
    memory::claim(width * height * 2 * size_of::<[f32; 3]>() as u64)?;
    let pixels = radiance::read_pixels(&mut source, &header, bytes.len() as u64)?;
    let image = Image::of(width as u32, height as u32, pixels);
    check_finite(&image.texels(), image.channels(), image.width())?;
    Ok(image)
}

/// A decoder within the limits, and what it decodes.
fn decoder<'a>(
    bytes: &'a [u8],
    name: &str,
) -> Result<(impl ImageDecoder + use<'a>, ImageFormat), ImageError> {
    let format = image::guess_format(bytes)
        .or_else(|_| ImageFormat::from_path(name))
        .map_err(|_| ImageError::UnknownFormat)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIZE);
    limits.max_image_height = Some(MAX_SIZE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits.clone());
    let decoder = reader.into_decoder()?;
    limits.reserve(decoder.total_bytes())?;
    Ok((decoder, format))
}

/// Bytes on the way there: some decoders hold all of the image in a form of their own.
fn peak_bytes(decoder: &impl ImageDecoder, format: ImageFormat) -> u64 {
    let (width, height) = decoder.dimensions();
    let own = match format {
        ImageFormat::Png | ImageFormat::Bmp => 0,
        _ => decoder.total_bytes().max(u64::from(width) * u64::from(height) * 8),
    };
    decoder.total_bytes() + own
}

/// All values.
fn read<T: Value>(decoder: impl ImageDecoder) -> Result<Texels, ImageError> {
    let mut values = vec![T::zeroed(); decoder.total_bytes() as usize / size_of::<T>()];
    decoder.read_image(bytemuck::cast_slice_mut(&mut values))?;
    Ok(T::wrap(values))
}

/// Refuses floats that are no numbers; `width` texels of so many channels are a row.
fn check_finite(texels: &Texels, channels: u8, width: u32) -> Result<(), ImageError> {
    let Texels::F32(values) = texels else { return Ok(()) };
    match values.iter().position(|value| !value.is_finite()) {
        Some(at) => {
            let at = (at / usize::from(channels)) as u32;
            Err(ImageError::NotFinite { x: at % width, y: at / width })
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use image::{DynamicImage, ImageBuffer};

    use super::*;
    use crate::film::{Picture, Window};

    fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), format).expect("encodes");
        bytes
    }

    fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
        encoded(&image.into(), ImageFormat::Png)
    }

    #[test]
    fn channels_and_bits_are_those_of_the_file() {
        let buffer = |channels: usize| (0..2 * channels as u16).map(|v| v * 1000 + 7).collect();
        let deep: [DynamicImage; 4] = [
            DynamicImage::ImageLuma16(ImageBuffer::from_raw(2, 1, buffer(1)).expect("two")),
            DynamicImage::ImageLumaA16(ImageBuffer::from_raw(2, 1, buffer(2)).expect("two")),
            DynamicImage::ImageRgb16(ImageBuffer::from_raw(2, 1, buffer(3)).expect("two")),
            DynamicImage::ImageRgba16(ImageBuffer::from_raw(2, 1, buffer(4)).expect("two")),
        ];
        for image in deep {
            let channels = image.color().channel_count();
            let bytes = png(image.clone());
            let decoded = Image::decode(&bytes, "").expect("decodes");
            let expected = Texels::U16(image.as_bytes().chunks_exact(2).map(native).collect());
            assert!(decoded == Image::new(2, 1, channels, expected), "{:?}", image.color());
            assert_eq!(Image::decoded_bytes(&bytes, "").expect("tells"), 4 * u64::from(channels));
            let rgba: Vec<[u16; 4]> = image.to_rgba16().pixels().map(|pixel| pixel.0).collect();
            assert_eq!(decoded.rgba::<u16>(), Some(rgba));

            let shallow = DynamicImage::from(image.to_luma8());
            for image in [shallow, image.to_luma_alpha8().into(), image.to_rgb8().into()] {
                let channels = image.color().channel_count();
                let expected = Texels::U8(image.as_bytes().to_vec());
                let rgba: Vec<[u8; 4]> = image.to_rgba8().pixels().map(|pixel| pixel.0).collect();
                let decoded = Image::decode(&png(image), "").expect("decodes");
                assert!(decoded == Image::new(2, 1, channels, expected));
                assert_eq!(decoded.rgba::<u8>(), Some(rgba));
            }
        }
    }

    fn native(bytes: &[u8]) -> u16 {
        u16::from_ne_bytes([bytes[0], bytes[1]])
    }

    #[test]
    fn a_png_that_claims_to_be_huge_is_refused_before_it_is_allocated() {
        let grey = image::GrayImage::from_raw(1, 1, vec![7]).expect("one texel");
        let mut bytes = png(grey);
        bytes[16..20].copy_from_slice(&60000_u32.to_be_bytes()); // the width in IHDR
        assert!(Image::decode(&bytes, "a.png").is_err());
    }

    #[test]
    fn bytes_of_no_format_are_named_so() {
        let error = Image::decode(b"hello", "a.txt").expect_err("is no image");
        assert!(matches!(error, ImageError::UnknownFormat), "{error}");
    }

    #[test]
    fn what_has_no_signature_is_told_by_its_ending() {
        let mut tga = vec![0; 18];
        (tga[2], tga[12], tga[14], tga[16]) = (2, 1, 1, 24); // colours, 1 by 1 of 24 bits
        tga.extend([1, 2, 3]);
        let decoded = Image::decode(&tga, "a.tga").expect("decodes");
        assert!(decoded == Image::of(1, 1, vec![[3_u8, 2, 1]]));
        assert!(matches!(Image::decode(&tga, "a"), Err(ImageError::UnknownFormat)));
    }

    #[test]
    fn radiance_files_are_floats() {
        let texels = vec![4.0, 0.5, 0.0, 0.25, 0.25, 0.25];
        let image = image::Rgb32FImage::from_raw(2, 1, texels).expect("two texels");
        let bytes = encoded(&image.into(), ImageFormat::Hdr);
        let decoded = Image::decode(&bytes, "a.hdr").expect("decodes");
        let expected = vec![[4.0_f32, 0.5, 0.0], [0.25, 0.25, 0.25]];
        assert!(decoded == Image::of(2, 1, expected));
        assert_eq!(Image::decoded_bytes(&bytes, "a.hdr").expect("tells"), 24);

        // Of another program, under an exposure.
        let mut other = b"#?RGBE\nEXPOSURE=4\n\n-Y 2 +X 1\n".to_vec();
        other.extend([128, 128, 128, 129, 128, 128, 128, 129]);
        let decoded = Image::decode(&other, "a").expect("the first bytes tell");
        assert!(decoded == Image::of(1, 2, vec![[0.25_f32; 3]; 2]));
        let error = Image::decode(&other[..other.len() - 1], "a").expect_err("is cut");
        assert_eq!(error.to_string(), "the file ends in row 2 of 2");
        let huge = b"#?RGBE\n\n-Y 16384 +X 16384\n";
        assert!(Image::decode(huge, "a").is_err() && Image::decoded_bytes(huge, "a").is_err());
    }

    /// As a picture of a part of its frame: what is beyond is clear, and that is said.
    #[test]
    fn a_part_of_a_frame_is_at_its_place() {
        let mut picture =
            Picture::new(Window::of_size(2, 2), Window { x0: 1, y0: 1, x1: 2, y1: 2 });
        picture.set_channel("Y", vec![1.0]);
        let bytes = exr::encode(&picture).expect("encodes");
        let (image, notes) = Image::decode_noting(&bytes, "a.exr").expect("decodes");
        let expected = vec![[0.0_f32; 2], [0.0; 2], [0.0; 2], [1.0; 2]];
        assert!(image == Image::of(2, 2, expected), "grey with alpha");
        assert_eq!(notes.len(), 1);
        assert_eq!(Image::decoded_bytes(&bytes, "a.exr").expect("tells"), 64);
    }

    fn exr_of(channels: &[(&str, [f32; 2])]) -> Vec<u8> {
        let window = Window::of_size(2, 1);
        let mut picture = Picture::new(window, window);
        for (name, values) in channels {
            picture.set_channel(*name, values.to_vec());
        }
        exr::encode(&picture).expect("encodes")
    }

    #[test]
    fn open_exr_files_are_floats_and_their_alpha_is_taken_out() {
        let coloured = exr_of(&[
            ("R", [8.0, 0.5]),
            ("G", [1.0, 0.25]),
            ("B", [0.0, 0.125]),
            ("A", [1.0, 0.5]),
            ("depth.Z", [f32::INFINITY; 2]),
        ]);
        let decoded = Image::decode(&coloured, "a.exr").expect("decodes");
        let expected = vec![[8.0_f32, 1.0, 0.0, 1.0], [1.0, 0.5, 0.25, 0.5]];
        assert!(decoded == Image::of(2, 1, expected));
        assert_eq!(Image::decoded_bytes(&coloured, "a.exr").expect("tells"), 32);

        let grey = exr_of(&[("Y", [3.0, 0.5])]);
        let decoded = Image::decode(&grey, "a.png").expect("the first bytes tell");
        assert!(decoded == Image::of(2, 1, vec![[3.0_f32], [0.5]]));

        let broken = exr_of(&[("Y", [3.0, f32::NAN])]);
        let error = Image::decode(&broken, "a.exr").expect_err("is NaN");
        assert!(matches!(error, ImageError::NotFinite { x: 1, y: 0 }), "{error}");
        let error = Image::decode(&exr_of(&[("Z", [1.0; 2])]), "a.exr").expect_err("no colours");
        assert_eq!(error.to_string(), "no channels R, G, B and no Y; it has Z");
        let is_refused = |length: usize| Image::decode(&coloured[..length], "a.exr").is_err();
        assert!((0..coloured.len()).all(is_refused));
    }
}
