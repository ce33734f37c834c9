//! Images in memory.

use std::fmt;

/// The colours of an image, row by row from the top, alpha not premultiplied.
#[derive(Clone, PartialEq)]
pub enum Texels {
    /// What nearly all files hold.
    Rgba8(Vec<[u8; 4]>),
    /// 16-bit PNG and TIFF.
    Rgba16(Vec<[u16; 4]>),
    /// Linear colours: Radiance HDR, OpenEXR, float TIFF.
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
