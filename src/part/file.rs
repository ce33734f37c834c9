//! A part: a file of tiles.

use std::io::{self, Read, Seek, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::container::{
    Entry, FORMAT, HEAD, INDEX, TILE, TRAILER, chunk_length, read_chunk, read_trailer, write_chunk,
    write_trailer,
};
use super::error::PartError;
use super::head::Head;
use super::tile_codec;
use crate::files;
use crate::film::Window;
use crate::render::{Tile, tile_windows};

/// The most bytes of a head: it holds a command line and settings.
const MOST_HEAD: u64 = 16 << 20;

/// A tile as it is in a part.
pub struct EncodedTile {
    /// All but its offset.
    entry: Entry,
    contents: Vec<u8>,
}

impl EncodedTile {
    /// The bytes of a tile.
    pub(crate) fn new(tile: &Tile) -> Self {
        let (range, finished) = (tile.range.clone(), tile.finished);
        let entry = Entry { offset: 0, range, finished, lost_count: tile.lost_count };
        Self { entry, contents: tile_codec::encode(tile) }
    }
}

/// Writes a part, tile by tile.
pub struct PartWriter<W> {
    out: W,
    offset: u64,
    index: Vec<u8>,
}

impl<W: Write> PartWriter<W> {
    /// Begins a part.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(mut out: W, head: &Head) -> io::Result<Self> {
        let json = serde_json::to_vec(head).map_err(io::Error::other)?;
        out.write_all(FORMAT)?;
        let offset = FORMAT.len() as u64 + write_chunk(&mut out, HEAD, &json)?;
        Ok(Self { out, offset, index: Vec::new() })
    }

    /// Adds the next tile of the crop.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn add(&mut self, tile: &EncodedTile) -> io::Result<()> {
        let entry = Entry { offset: self.offset, ..tile.entry.clone() };
        self.index.extend(entry.to_bytes());
        self.offset += write_chunk(&mut self.out, TILE, &tile.contents)?;
        Ok(())
    }

    /// Ends the part: all tiles of the crop have been added.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn finish(mut self) -> io::Result<()> {
        write_chunk(&mut self.out, INDEX, &self.index)?;
        write_trailer(&mut self.out, self.offset)
    }
}

/// What a part is read from.
trait Source: Read + Seek + Send {}

impl<T: Read + Seek + Send> Source for T {}

/// A part that can be read. Its head and index have been; tiles are read when they are asked for.
pub struct Part {
    path: PathBuf,
    file: Mutex<Box<dyn Source>>,
    /// What the samples belong to.
    pub head: Head,
    /// Bytes of the file.
    pub bytes: u64,
    windows: Vec<Window>,
    entries: Vec<Entry>,
    index: u64,
}

impl std::fmt::Debug for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Part").field("path", &self.path).finish_non_exhaustive()
    }
}

/// Whether a file begins as a part does.
pub fn is_part(path: &Path) -> bool {
    let mut found = [0; FORMAT.len()];
    let name = FORMAT.len() - 2; // without the number and the end of the line
    let read = files::open(path).and_then(|(mut file, _)| file.read_exact(&mut found));
    read.is_ok() && found[..name] == FORMAT[..name]
}

impl Part {
    /// Reads head and index of a part.
    ///
    /// # Errors
    /// [`PartError`], with the chunk that is wrong.
    pub fn open(path: &Path) -> Result<Self, PartError> {
        let io = |source| PartError::Open { path: path.to_owned(), source };
        let (file, bytes) = files::open(path).map_err(io)?;
        Self::read_from(path, file, bytes)
    }

    /// The same of what has been opened already, and is so many bytes long; `path` is for messages.
    ///
    /// # Errors
    /// As [`Part::open`].
    pub fn read_from(
        path: &Path,
        mut file: impl Read + Seek + Send + 'static,
        bytes: u64,
    ) -> Result<Self, PartError> {
        read_format(&mut file, path)?;
        let damaged =
            |chunk: &'static str| move |reason: String| PartError::damaged(path, chunk, reason);
        let index = read_trailer(&mut file, bytes).map_err(damaged("the end"))?;
        let start = FORMAT.len() as u64;
        let head_length = chunk_length(&mut file, start).map_err(damaged("the head"))?;
        if head_length > MOST_HEAD.min(bytes) {
            return Err(damaged("the head")("is longer than a head can be".to_owned()));
        }
        let json =
            read_chunk(&mut file, HEAD, start..start + head_length).map_err(damaged("the head"))?;
        let head = Head::from_json(&json).map_err(damaged("the head"))?;
        let contents = read_chunk(&mut file, INDEX, index..bytes.saturating_sub(TRAILER))
            .map_err(damaged("the index"))?;
        let (entries, rest) = contents.as_chunks::<{ Entry::BYTES }>();
        let entries: Vec<Entry> = entries.iter().map(Entry::from_bytes).collect();
        // The crop is not trusted before the index is known to have an entry for each of its tiles.
        let tiles = head.crop().area() / 256;
        let windows = if tiles <= entries.len() { tile_windows(head.crop()) } else { Vec::new() };
        let first = entries.first().map(|entry| entry.offset);
        let in_order = entries.windows(2).all(|pair| pair[0].offset < pair[1].offset);
        if windows.len() != entries.len()
            || !rest.is_empty()
            || first != Some(start + head_length)
            || !in_order
            || !entries.iter().all(Entry::has_samples)
            || entries.last().is_some_and(|entry| entry.offset >= index)
        {
            return Err(damaged("the index")("does not fit the head".to_owned()));
        }
        let (path, file) = (path.to_owned(), Mutex::new(Box::new(file) as Box<dyn Source>));
        Ok(Self { path, file, head, bytes, windows, entries, index })
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The windows of its tiles, row by row.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The samples of a tile's pixels.
    pub fn range(&self, tile: usize) -> Range<u64> {
        self.entries[tile].range.clone()
    }

    /// Whether a tile takes no more samples, for its noise is low enough.
    pub fn is_finished(&self, tile: usize) -> bool {
        self.entries[tile].finished
    }

    /// How many of its samples were not finite.
    pub fn lost_count(&self) -> u64 {
        self.entries.iter().map(|entry| entry.lost_count).sum()
    }

    /// The fewest and the most samples of a pixel.
    pub fn sample_counts(&self) -> (u64, u64) {
        let counts = || self.entries.iter().map(|it| it.range.end.saturating_sub(it.range.start));
        (counts().min().unwrap_or(0), counts().max().unwrap_or(0))
    }

    /// Whether all samples that were asked for are there.
    pub fn is_complete(&self) -> bool {
        let end = self.head.samples().end;
        self.entries.iter().all(|entry| entry.finished || entry.range.end >= end)
    }

    /// Reads a tile.
    ///
    /// # Errors
    /// [`PartError::Damaged`].
    pub fn read(&self, tile: usize) -> Result<Tile, PartError> {
        let (window, entry) = (self.windows[tile], &self.entries[tile]);
        let damaged =
            |reason: &str| PartError::damaged(&self.path, &format!("the tile {window}"), reason);
        let end = self.entries.get(tile + 1).map_or(self.index, |next| next.offset);
        let contents = {
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            read_chunk(&mut **file, TILE, entry.offset..end)
        };
        let tile = tile_codec::decode(window, &contents.map_err(|reason| damaged(&reason))?)
            .map_err(damaged)?;
        let is_as_told = tile.range == entry.range
            && tile.finished == entry.finished
            && tile.lost_count == entry.lost_count;
        if is_as_told { Ok(tile) } else { Err(damaged("is not what the index says")) }
    }

    /// Reads all tiles and forgets them again: to make sure that they are whole.
    ///
    /// # Errors
    /// [`PartError::Damaged`] of the first that is not.
    pub fn verify(&self) -> Result<(), PartError> {
        (0..self.windows.len()).try_for_each(|tile| self.read(tile).map(drop))
    }
}

/// Reads the first bytes.
fn read_format(file: &mut impl Read, path: &Path) -> Result<(), PartError> {
    let mut found = [0; FORMAT.len()];
    let is_read = file.read_exact(&mut found).is_ok();
    if is_read && found == *FORMAT {
        return Ok(());
    }
    let words = "dapple part ".len();
    if is_read && found[..words] == FORMAT[..words] {
        let number = |bytes: &[u8]| String::from_utf8_lossy(&bytes[words..]).trim().to_owned();
        let (found, known) = (number(&found), number(FORMAT));
        return Err(PartError::Format { path: path.to_owned(), found, known });
    }
    Err(PartError::NotAPart(path.to_owned()))
}
