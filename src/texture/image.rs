//! Images: their texels in memory, or in tiles that a cache keeps.

use std::borrow::Cow;
use std::fmt;
use std::sync::{Arc, OnceLock};

use super::cache::TileCache;
use super::pack::SIDE;
use super::texels::{Depth, Texels, Value, spread};
use super::tiles::Tiles;
use crate::math::Digest;

/// An image of at least one texel.
pub struct Image {
    width: u32,
    height: u32,
    channels: u8,
    opaque: bool,
    store: Store,
    /// Its own smaller versions, from the file that it is from.
    file_levels: Vec<Arc<Image>>,
    digest: OnceLock<u64>,
}

/// Which levels of a file are decoded, if it has several: of what size the image is, and half as
/// wide and high, and so on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FileLevels {
    /// The image alone.
    #[default]
    First,
    /// Smaller versions too.
    All,
}

/// Where texels are.
pub enum Store {
    /// In memory, row by row from the top.
    Whole(Texels),
    /// In tiles.
    Tiles(Tiles),
}

impl Image {
    /// An image of `width` times `height` texels of so many channels.
    ///
    /// # Panics
    /// If there are none, their number is another, or there are more than four channels.
    pub fn new(width: u32, height: u32, channels: u8, texels: Texels) -> Self {
        let count = u64::from(width) * u64::from(height) * u64::from(channels);
        assert!(count > 0 && count == texels.len() as u64 && channels <= 4);
        let opaque = match &texels {
            Texels::U8(values) => is_opaque(values, channels),
            Texels::U16(values) => is_opaque(values, channels),
            Texels::F32(values) => is_opaque(values, channels),
        };
        let (store, digest) = (Store::Whole(texels), OnceLock::new());
        Self { width, height, channels, opaque, store, file_levels: Vec::new(), digest }
    }

    /// The same with smaller versions from its file: each half as wide and high as the one before,
    /// of the same kind of texels.
    #[must_use]
    pub(super) fn with_file_levels(self, file_levels: Vec<Arc<Self>>) -> Self {
        // What is clear from afar must be looked up.
        let opaque = self.opaque && file_levels.iter().all(|level| level.opaque);
        Self { opaque, file_levels, digest: OnceLock::new(), ..self }
    }

    /// The smaller versions that its file brought, from the largest on.
    pub fn file_levels(&self) -> &[Arc<Self>] {
        &self.file_levels
    }

    /// The same of texels that know their channels.
    ///
    /// # Panics
    /// As for [`Image::new`].
    pub fn of<T: Value, const N: usize>(width: u32, height: u32, texels: Vec<[T; N]>) -> Self {
        Self::new(width, height, N as u8, T::wrap(texels.into_flattened()))
    }

    /// The same image in tiles that `cache` keeps; one that is no larger than a tile stays whole.
    /// So do those of its file's smaller versions.
    #[must_use]
    pub fn into_tiles(self, cache: &Arc<TileCache>) -> Self {
        self.into_tiles_and_room(cache).0
    }

    /// The same with the memory that its texels were in, if they had 8 bits and are in tiles now.
    pub(super) fn into_tiles_and_room(self, cache: &Arc<TileCache>) -> (Self, Option<Vec<u8>>) {
        // While all of it is at hand.
        let digest = self.digest();
        let Some(tiles) = self.cut(cache) else { return (self, None) };
        let level = |level: &Arc<Self>| match level.cut(cache) {
            Some(tiles) => Arc::new(tiles),
            None => Arc::clone(level),
        };
        let file_levels = self.file_levels.iter().map(level).collect();
        let tiles = Self { opaque: self.opaque, file_levels, digest: digest.into(), ..tiles };
        match self.store {
            Store::Whole(Texels::U8(values)) => (tiles, Some(values)),
            _ => (tiles, None),
        }
    }

    /// Its texels in tiles, unless they are few or in tiles already.
    fn cut(&self, cache: &Arc<TileCache>) -> Option<Self> {
        let Self { width, height, channels, opaque, .. } = *self;
        let Store::Whole(texels) = &self.store else { return None };
        if u64::from(width) * u64::from(height) <= u64::from(SIDE * SIDE) {
            return None;
        }
        let store = Store::Tiles(Tiles::cut(texels, [width, height], channels, Arc::clone(cache)));
        let (file_levels, digest) = (Vec::new(), self.digest.clone());
        Some(Self { width, height, channels, opaque, store, file_levels, digest })
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

    /// How many channels it has, 1 to 4.
    #[inline]
    pub fn channels(&self) -> u8 {
        self.channels
    }

    /// Of what kind its values are.
    pub fn depth(&self) -> Depth {
        match &self.store {
            Store::Whole(texels) => texels.depth(),
            Store::Tiles(tiles) => tiles.depth(),
        }
    }

    /// Where its texels are.
    #[inline]
    pub(super) fn store(&self) -> &Store {
        &self.store
    }

    /// Whether it is kept in tiles.
    pub fn is_tiled(&self) -> bool {
        matches!(self.store, Store::Tiles(_))
    }

    /// The texels, row by row from the top; of an image in tiles a copy of all.
    pub fn texels(&self) -> Cow<'_, Texels> {
        match &self.store {
            Store::Whole(texels) => Cow::Borrowed(texels),
            Store::Tiles(tiles) => Cow::Owned(tiles.to_texels()),
        }
    }

    /// Red, green, blue and alpha of all texels, if their values are of this type.
    pub fn rgba<T: Value>(&self) -> Option<Vec<[T; 4]>> {
        let texels = self.texels();
        let values = T::unwrap(&texels)?;
        Some(values.chunks_exact(usize::from(self.channels)).map(spread).collect())
    }

    /// Whether alpha is one everywhere.
    pub fn is_opaque(&self) -> bool {
        self.opaque
    }

    /// Bytes of all texels, whether they are in memory or not.
    pub fn texel_bytes(&self) -> u64 {
        let count = u64::from(self.width) * u64::from(self.height) * u64::from(self.channels);
        count * u64::from(self.depth().bits() / 8)
    }

    /// A number that tells texels apart, and those of its file's smaller versions; the same in
    /// memory and in tiles.
    pub fn digest(&self) -> u64 {
        *self.digest.get_or_init(|| {
            let mut digest = Digest::default();
            digest.bytes(self.texels().as_bytes());
            self.file_levels.iter().for_each(|level| digest.word(level.digest()));
            digest.value()
        })
    }
}

impl PartialEq for Image {
    fn eq(&self, other: &Self) -> bool {
        let size = |image: &Self| [image.width, image.height, image.channels.into()];
        size(self) == size(other)
            && self.texels() == other.texels()
            && self.file_levels == other.file_levels
    }
}

/// Whether values of so many channels have no alpha, or one everywhere.
fn is_opaque<T: Value>(values: &[T], channels: u8) -> bool {
    let step = usize::from(channels);
    channels % 2 == 1 || values.iter().skip(step - 1).step_by(step).all(|&alpha| alpha >= T::ONE)
}

impl fmt::Debug for Image {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { width, height, channels, .. } = self;
        write!(f, "Image({width} x {height}, {channels} x {} bit)", self.depth().bits())
    }
}
