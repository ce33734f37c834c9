//! Images from files, each decoded once, within the memory that textures may take.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::time::SystemTime;

use rayon::prelude::*;

use super::cache::{CacheFigures, TileCache};
use super::image::{FileLevels, Image};
use crate::files::{Meter, memory};

/// Memory that decoded images may always take, and beyond it for each byte of their files.
const FREE_BYTES: u64 = 4 << 30;
const EXPANSION: u64 = 256;

/// Bytes of files that are kept from when their sizes are read until they are decoded; others are
/// read twice.
const KEPT_BYTES: u64 = 256 << 20;

/// An image of so many bytes is cut into tiles if it does not fit.
const SMALL_BYTES: u64 = 64 << 10;

/// Which file an image is from, and which part of it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ImageId {
    path: PathBuf,
    length: u64,
    modified: Option<SystemTime>,
    part: ImagePart,
}

/// Which part of a file an image is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImagePart {
    /// All of it.
    Whole,
    /// The buffer view of that number.
    View(usize),
    /// The image of that number, which is written into the document.
    Image(usize),
}

impl ImageId {
    /// That of a part of a file as the file is now; none if there is no such file.
    pub fn of(path: &Path, part: ImagePart) -> Option<Self> {
        let path = fs::canonicalize(path).ok()?;
        let metadata = fs::metadata(&path).ok()?;
        Some(Self { path, length: metadata.len(), modified: metadata.modified().ok(), part })
    }
}

/// An image's file, to be decoded.
pub struct ImageSource<'a> {
    /// Tells it from others; none: it is decoded for itself.
    pub id: Option<ImageId>,
    /// The name whose ending may tell the format.
    pub name: &'a str,
    /// Reads the file, or says why it cannot be read.
    pub read: Box<dyn Fn() -> Result<Cow<'a, [u8]>, String> + Send + Sync + 'a>,
}

/// An image and what is odd about its file, or why there is none.
pub type Decoded = Result<(Arc<Image>, Vec<String>), String>;

/// Images that scenes have, and what is odd about their files.
type Known = HashMap<ImageId, (Weak<Image>, Vec<String>)>;

/// What textures take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TextureFigures {
    /// Images that were decoded.
    pub images: u64,
    /// Those of them that are kept in tiles.
    pub tiled: u64,
    /// Bytes of the texels of images that are in memory.
    pub resident: u64,
    /// What the cache of tiles has done.
    pub cache: CacheFigures,
}

/// Decodes images and keeps them: in memory as long as all fit, else in tiles.
///
/// Which images are in tiles changes no bit of what is looked up.
pub struct TextureStore {
    limit: u64,
    resident: AtomicU64,
    is_full: AtomicBool,
    images: AtomicU64,
    tiled: AtomicU64,
    known: Mutex<Known>,
    cache: Arc<TileCache>,
    meter: Arc<Meter>,
    levels: FileLevels,
}

impl Default for TextureStore {
    /// Without a limit.
    fn default() -> Self {
        Self::new(u64::MAX)
    }
}

impl fmt::Debug for TextureStore {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TextureStore({} bytes, {:?})", self.limit, self.figures())
    }
}

impl TextureStore {
    /// An empty one, for textures that take no more than so many bytes of memory.
    pub fn new(limit: u64) -> Self {
        Self {
            limit,
            resident: AtomicU64::new(0),
            is_full: AtomicBool::new(false),
            images: AtomicU64::new(0),
            tiled: AtomicU64::new(0),
            known: Mutex::default(),
            cache: Arc::new(TileCache::new(limit)),
            meter: Arc::default(),
            levels: FileLevels::First,
        }
    }

    /// The same; a meter is told how many bytes of texels are decoded.
    pub fn metered(self, meter: Arc<Meter>) -> Self {
        Self { meter, ..self }
    }

    /// The same for textures that are looked up in smaller versions, too: see [`add_levels`].
    ///
    /// [`add_levels`]: super::add_levels
    pub fn with_levels(self) -> Self {
        Self { levels: FileLevels::All, ..self }
    }

    /// Whether textures get smaller versions of their images, for what is seen from afar.
    pub fn wants_levels(&self) -> bool {
        self.levels == FileLevels::All
    }

    /// Bytes that textures may take.
    pub fn limit(&self) -> u64 {
        self.limit
    }

    /// What textures take now.
    pub fn figures(&self) -> TextureFigures {
        TextureFigures {
            images: self.images.load(Relaxed),
            tiled: self.tiled.load(Relaxed),
            resident: self.resident.load(Relaxed),
            cache: self.cache.figures(),
        }
    }

    /// Why a part of a texture could not be read back, if that has happened: what was rendered
    /// since is wrong.
    pub fn failure(&self) -> Option<&str> {
        self.cache.failure()
    }

    /// Decodes images, each once however often it is among `sources` and if no scene has it yet.
    pub fn load(&self, sources: &[ImageSource]) -> Vec<Decoded> {
        // Of each source the first of the same image.
        let mut firsts = HashMap::new();
        let first = |(number, source): (usize, &ImageSource)| match &source.id {
            Some(id) => *firsts.entry(id.clone()).or_insert(number),
            None => number,
        };
        let first: Vec<usize> = sources.iter().enumerate().map(first).collect();
        let mut decoded: Vec<Option<Decoded>> = sources.iter().map(|it| self.find(it)).collect();
        let wanted = |&number: &usize| first[number] == number && decoded[number].is_none();
        let wanted: Vec<usize> = (0..sources.len()).filter(wanted).collect();
        let missing: Vec<&ImageSource> = wanted.iter().map(|&number| &sources[number]).collect();
        for (number, found) in wanted.into_iter().zip(self.decode(&missing)) {
            decoded[number] = Some(found);
        }
        let of = |number: usize| decoded[number].clone().or_else(|| decoded[first[number]].clone());
        let nothing = || Err("could not be decoded".to_owned());
        (0..sources.len()).map(|number| of(number).unwrap_or_else(nothing)).collect()
    }

    /// Decodes one image.
    ///
    /// # Errors
    /// Why there is none.
    pub fn load_one(&self, source: ImageSource) -> Decoded {
        self.load(&[source]).pop().unwrap_or_else(|| Err(String::new()))
    }

    /// Keeps an image that was made, not read.
    pub fn keep(&self, image: Image) -> Arc<Image> {
        let fits = self.reserve(image.texel_bytes());
        let image = if fits { image } else { image.into_tiles(&self.cache) };
        self.admit(image, fits)
    }

    /// The image of a source, if a scene has it.
    fn find(&self, source: &ImageSource) -> Option<Decoded> {
        let known = self.known();
        let (image, notes) = known.get(source.id.as_ref()?)?;
        Some(Ok((image.upgrade()?, notes.clone())))
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        lock(&self.known)
    }

    /// Decodes images side by side.
    fn decode(&self, sources: &[&ImageSource]) -> Vec<Decoded> {
        // Sizes are known before anything is decoded, so that many small files are no bomb either.
        let kept = AtomicU64::new(0);
        let files: Vec<Result<SizedFile, String>> =
            sources.par_iter().map(|source| SizedFile::read(source, &kept, self.levels)).collect();
        let sizes = files.iter().flatten().fold((0_u64, 0_u64), |sum, file| {
            (sum.0.saturating_add(file.length), sum.1.saturating_add(file.decoded))
        });
        let (encoded, total) = sizes;
        self.meter.expect(total);
        let fits = self.reserve(total);
        let too_many = if total > FREE_BYTES.saturating_add(encoded.saturating_mul(EXPANSION)) {
            Some(format!("all images together take {total} bytes, far beyond their files"))
        } else if fits {
            memory::claim(total).err().map(|error| format!("all images together: {error}"))
        } else {
            None
        };
        // New memory costs time as decoding does: that of images that were cut is used again.
        let spare = Mutex::new(Vec::new());
        let decode = |(source, file): (&&ImageSource, Result<SizedFile, String>)| {
            let SizedFile { bytes, decoded, .. } = file?;
            if let Some(reason) = &too_many {
                return Err(reason.clone());
            }
            let bytes = match bytes {
                Some(bytes) => bytes,
                None => (source.read)()?,
            };
            // One that may stay whole has its own.
            let room = if decoded < SMALL_BYTES { None } else { lock(&spare).pop() };
            let room = room.unwrap_or_default();
            let decoded = Image::decode_into(room, &bytes, source.name, self.levels);
            drop(bytes);
            let (image, notes) = decoded.map_err(|error| error.to_string())?;
            let image = if fits { image } else { self.cut(image, &spare) };
            let image = self.admit(image, fits);
            if let Some(id) = &source.id {
                self.known().insert(id.clone(), (Arc::downgrade(&image), notes.clone()));
            }
            Ok((image, notes))
        };
        let decode = |(source, file): (&&ImageSource, Result<SizedFile, String>)| {
            let size = file.as_ref().map_or(0, |file| file.decoded);
            let decoded = decode((source, file));
            self.meter.finish(size);
            if fits && decoded.is_err() {
                self.resident.fetch_sub(size, Relaxed);
            }
            decoded
        };
        sources.par_iter().zip(files).map(decode).collect()
    }

    /// Sets memory aside for images, if all of it is there: an eighth is left for the cache. Once
    /// some do not fit, none is asked for any more: the cache has what is left.
    fn reserve(&self, bytes: u64) -> bool {
        let most = self.limit - self.limit / 8;
        let add = |resident: u64| resident.checked_add(bytes).filter(|&all| all <= most);
        let fits = !self.is_full.load(Relaxed)
            && self.resident.fetch_update(Relaxed, Relaxed, add).is_ok();
        if fits {
            self.leave_the_rest_to_the_cache();
        } else {
            self.is_full.store(true, Relaxed);
        }
        fits
    }

    fn leave_the_rest_to_the_cache(&self) {
        let rest = self.limit.saturating_sub(self.resident.load(Relaxed));
        self.cache.set_limit(rest.max(self.limit / 8));
    }

    /// An image in tiles; the memory that it was in is spared.
    fn cut(&self, image: Image, spare: &Mutex<Vec<Vec<u8>>>) -> Image {
        let (image, room) = image.into_tiles_and_room(&self.cache);
        lock(spare).extend(room);
        image
    }

    fn admit(&self, image: Image, fits: bool) -> Arc<Image> {
        for image in image.file_levels().iter().map(|level| &**level).chain([&image]) {
            if !fits && !image.is_tiled() {
                self.resident.fetch_add(image.texel_bytes(), Relaxed);
                self.leave_the_rest_to_the_cache();
            }
            self.images.fetch_add(1, Relaxed);
            self.tiled.fetch_add(image.is_tiled().into(), Relaxed);
        }
        Arc::new(image)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file whose size is known.
struct SizedFile<'a> {
    length: u64,
    /// Bytes of its texels; 0 if it cannot be decoded, which decoding will tell.
    decoded: u64,
    /// All of it, unless there is too much of all.
    bytes: Option<Cow<'a, [u8]>>,
}

impl<'a> SizedFile<'a> {
    fn read(
        source: &ImageSource<'a>,
        kept: &AtomicU64,
        levels: FileLevels,
    ) -> Result<Self, String> {
        let bytes = (source.read)()?;
        let length = bytes.len() as u64;
        let decoded = Image::decoded_bytes(&bytes, source.name, levels).unwrap_or(0);
        let keep = matches!(bytes, Cow::Borrowed(_))
            || kept.fetch_add(length, Relaxed).saturating_add(length) <= KEPT_BYTES;
        Ok(Self { length, decoded, bytes: keep.then_some(bytes) })
    }
}

#[cfg(test)]
mod tests;
