//! Images from the bytes of their files, within limits, straight into the memory that they keep.

use std::io::Cursor;
use std::path::Path;

use image::{ColorType, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::image::{FileLevels, Image};
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
        Ok(Self::decode_noting(bytes, name, FileLevels::First)?.0)
    }

    /// The same with those levels of the file that are asked for, and what is odd about the file.
    ///
    /// # Errors
    /// As for [`Image::decode`].
    pub fn decode_noting(
        bytes: &[u8],
        name: &str,
        levels: FileLevels,
    ) -> Result<(Self, Vec<String>), ImageError> {
        Self::decode_into(Vec::new(), bytes, name, levels)
    }

    /// The same into memory that is at hand, whatever is in it, if it suffices and fits.
    pub(super) fn decode_into(
        room: Vec<u8>,
        bytes: &[u8],
        name: &str,
        levels: FileLevels,
    ) -> Result<(Self, Vec<String>), ImageError> {
        if is_exr(bytes) {
            return decode_exr(bytes, name);
        }
        if ktx2::is_ktx2(bytes) {
            return ktx2::decode(bytes, MAX_SIZE, levels).map_err(ImageError::Ktx2);
        }
        if is_radiance(bytes) {
            return decode_radiance(bytes);
        }
        Ok((decode_other(room, bytes, name)?, Vec::new()))
    }

    /// The memory that the texels of a file would take, by its header alone; for OpenEXR files the
    /// most that it can be.
    ///
    /// # Errors
    /// As for [`Image::decode`], as far as the header tells.
    pub fn decoded_bytes(bytes: &[u8], name: &str, levels: FileLevels) -> Result<u64, ImageError> {
        if is_exr(bytes) {
            let (width, height) = exr_size(bytes)?;
            return Ok(width * height * size_of::<[f32; 4]>() as u64);
        }
        if ktx2::is_ktx2(bytes) {
            return ktx2::decoded_bytes(bytes, MAX_SIZE, levels).map_err(ImageError::Ktx2);
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
fn decode_other(room: Vec<u8>, bytes: &[u8], name: &str) -> Result<Image, ImageError> {
    let (decoder, format) = decoder(bytes, name)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err(ImageError::Empty);
    }
    memory::claim(peak_bytes(&decoder, format))?;
    let channels = decoder.color_type().channel_count();
    let texels = match decoder.color_type() {
        ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8 => {
            Texels::U8(read_into(room, decoder)?)
        }
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

fn decode_radiance(bytes: &[u8]) -> Result<(Image, Vec<String>), ImageError> {
    let mut source = bytes;
    let header = radiance::Header::read(&mut source)?;
    let (width, height) = radiance_size(&header)?;
    // As they come, and upright.
    memory::claim(width * height * 2 * size_of::<[f32; 3]>() as u64)?;
    let pixels = radiance::read_pixels(&mut source, &header, bytes.len() as u64)?;
    let image = Image::of(width as u32, height as u32, pixels);
    check_finite(&image.texels(), image.channels(), image.width())?;
    Ok((image, header.notes()))
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

/// All values of 8 bits, in `room` if it is large enough.
fn read_into(mut room: Vec<u8>, decoder: impl ImageDecoder) -> Result<Vec<u8>, ImageError> {
    let length = decoder.total_bytes() as usize;
    // Zeros throughout: decoders leave out what a damaged file lacks. Those of new memory take none
    // until something is decoded.
    if room.capacity() < length {
        room = vec![0; length];
    } else {
        room.clear();
        room.resize(length, 0);
    }
    decoder.read_image(&mut room)?;
    Ok(room)
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
mod tests;
