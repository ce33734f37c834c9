//! Images in memory, and how they get there from a file's bytes.

use std::fmt;
use std::io::Cursor;

use image::{DynamicImage, ImageFormat, ImageReader, Limits};

/// The colours of an image, row by row from the top, alpha not premultiplied.
#[derive(Clone, PartialEq)]
pub enum Texels {
    /// What nearly all files hold.
    Rgba8(Vec<[u8; 4]>),
    /// 16-bit PNG and TIFF.
    Rgba16(Vec<[u16; 4]>),
    /// Linear colours: Radiance HDR, float TIFF.
    Rgba32F(Vec<[f32; 4]>),
}

/// An image of at least one texel.
#[derive(Clone, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    texels: Texels,
    opaque: bool,
}

/// Why an image could not be decoded; says what, not which file.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The decoder's own words, or those of a limit.
    #[error("{0}")]
    Decode(#[from] image::ImageError),
    /// The first bytes are those of no format that dapple reads, nor does the name tell.
    #[error("not an image that dapple reads (png, jpeg, webp, tga, bmp, gif, tiff, hdr)")]
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
}

/// The largest width and height that are decoded.
const MAX_SIZE: u32 = 16384;

/// The most memory that a decoder may take.
const MAX_BYTES: u64 = 1 << 30;

impl Image {
    /// An image of `width` times `height` texels.
    ///
    /// # Panics
    /// If there are none or their number is another.
    pub fn new(width: u32, height: u32, texels: Texels) -> Self {
        let (count, opaque) = match &texels {
            Texels::Rgba8(all) => (all.len(), all.iter().all(|texel| texel[3] == u8::MAX)),
            Texels::Rgba16(all) => (all.len(), all.iter().all(|texel| texel[3] == u16::MAX)),
            Texels::Rgba32F(all) => (all.len(), all.iter().all(|texel| texel[3] >= 1.0)),
        };
        assert!(count > 0 && count as u64 == u64::from(width) * u64::from(height));
        Self { width, height, texels, opaque }
    }

    /// Decodes a file's bytes. The format is told by the first bytes; only where these are silent
    /// (tga has no signature) by the ending of `name`.
    ///
    /// # Errors
    /// [`ImageError`]; among others beyond 16384 texels a side or 1 GiB.
    pub fn decode(bytes: &[u8], name: &str) -> Result<Self, ImageError> {
        Self::from_dynamic(reader(bytes, name)?.decode()?)
    }

    /// The memory that 8-bit texels of a file would take, by its header alone.
    ///
    /// # Errors
    /// As for [`Image::decode`], as far as the header tells.
    pub fn decoded_bytes(bytes: &[u8], name: &str) -> Result<u64, ImageError> {
        let (width, height) = reader(bytes, name)?.into_dimensions()?;
        Ok(u64::from(width) * u64::from(height) * 4)
    }

    fn from_dynamic(image: DynamicImage) -> Result<Self, ImageError> {
        let (width, height) = (image.width(), image.height());
        if width == 0 || height == 0 {
            return Err(ImageError::Empty);
        }
        let texels = match image {
            DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_) => {
                Texels::Rgba16(image.into_rgba16().pixels().map(|pixel| pixel.0).collect())
            }
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                let texels: Vec<_> = image.into_rgba32f().pixels().map(|pixel| pixel.0).collect();
                let odd = |texel: &[f32; 4]| texel.iter().any(|value| !value.is_finite());
                if let Some(at) = texels.iter().position(odd) {
                    let at = at as u32;
                    return Err(ImageError::NotFinite { x: at % width, y: at / width });
                }
                Texels::Rgba32F(texels)
            }
            _ => Texels::Rgba8(bytemuck::cast_vec(image.into_rgba8().into_raw())),
        };
        Ok(Self::new(width, height, texels))
    }

    /// Texels in a row.
    #[inline]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    #[inline]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The texels, row by row from the top.
    #[inline]
    pub fn texels(&self) -> &Texels {
        &self.texels
    }

    /// Whether alpha is one everywhere.
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        match &self.texels {
            Texels::Rgba8(all) => size_of_val(&**all),
            Texels::Rgba16(all) => size_of_val(&**all),
            Texels::Rgba32F(all) => size_of_val(&**all),
        }
    }
}

fn reader<'a>(bytes: &'a [u8], name: &str) -> Result<ImageReader<Cursor<&'a [u8]>>, ImageError> {
    let format = image::guess_format(bytes)
        .or_else(|_| ImageFormat::from_path(name))
        .map_err(|_| ImageError::UnknownFormat)?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIZE);
    limits.max_image_height = Some(MAX_SIZE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    Ok(reader)
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match &self.texels {
            Texels::Rgba8(_) => "8 bit",
            Texels::Rgba16(_) => "16 bit",
            Texels::Rgba32F(_) => "float",
        };
        write!(f, "Image({} x {}, {kind})", self.width, self.height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(image: &DynamicImage) -> Vec<u8> {
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), ImageFormat::Png).expect("encodes");
        bytes
    }

    #[test]
    fn grey_becomes_grey_and_16_bits_stay() {
        let grey = image::GrayImage::from_raw(2, 1, vec![7, 200]).expect("two texels");
        let decoded = Image::decode(&png(&grey.into()), "").expect("decodes");
        let expected = Texels::Rgba8(vec![[7, 7, 7, 255], [200, 200, 200, 255]]);
        assert!(decoded == Image::new(2, 1, expected));
        assert!(decoded.is_opaque());

        let deep = image::ImageBuffer::from_raw(1, 1, vec![1_u16, 2, 3, 4]).expect("one texel");
        let decoded = Image::decode(&png(&DynamicImage::ImageRgba16(deep)), "").expect("decodes");
        assert!(decoded == Image::new(1, 1, Texels::Rgba16(vec![[1, 2, 3, 4]])));
        assert!(!decoded.is_opaque());
    }

    #[test]
    fn a_png_that_claims_to_be_huge_is_refused_before_it_is_allocated() {
        let grey = image::GrayImage::from_raw(1, 1, vec![7]).expect("one texel");
        let mut bytes = png(&grey.into());
        bytes[16..20].copy_from_slice(&60000_u32.to_be_bytes()); // the width in IHDR
        assert!(Image::decode(&bytes, "a.png").is_err());
    }

    #[test]
    fn bytes_of_no_format_are_named_so() {
        let error = Image::decode(b"hello", "a.txt").expect_err("is no image");
        assert!(matches!(error, ImageError::UnknownFormat), "{error}");
    }
}
