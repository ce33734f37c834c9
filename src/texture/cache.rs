//! Tiles of textures that do not fit in memory: where they are kept, and those that are at hand.

use std::io;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use super::pack::{self, Packed};
use super::ring::{Ring, mix};
use crate::files::Spool;

/// How many tiles a thread has for itself, at most.
pub(super) const MOST_AT_HAND: usize = 1024;

/// Bytes of a shard that are worth a lock of their own.
const SHARD_BYTES: u64 = 4 << 20;

/// A tile of usual size, in bytes.
const USUAL_TILE: u64 = 4 << 10;

/// Where a row of tiles is kept.
#[derive(Debug)]
pub(super) struct Row {
    place: Place,
    tiles: Box<[Kept]>,
}

#[derive(Debug)]
enum Place {
    /// In the temporary file, from this byte on.
    File(u64),
    /// In memory, because there is no room for the file.
    Memory(Box<[u8]>),
}

/// A tile of a row.
#[derive(Debug)]
struct Kept {
    /// Where it ends in its row.
    end: u32,
    /// Its number when it was last brought to memory; changed under its shard's lock.
    number: AtomicU32,
}

impl Row {
    /// Which of its bytes are the tile in such a column.
    fn range(&self, column: usize) -> Range<usize> {
        let start = column.checked_sub(1).map_or(0, |before| self.tiles[before].end);
        start as usize..self.tiles[column].end as usize
    }
}

/// What the cache has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CacheFigures {
    /// Bytes that tiles in memory may take.
    pub limit: u64,
    /// The most that they have taken.
    pub peak: u64,
    /// Bytes of all tiles as they are kept: in the temporary file or, where that is full, in
    /// memory.
    pub stored: u64,
    /// The part of it that is in memory.
    pub stored_in_memory: u64,
    /// Tiles that were read.
    pub read: u64,
    /// Tiles that were there when a thread asked for one that it did not have at hand.
    pub found: u64,
    /// Tiles that made room for others.
    pub evicted: u64,
}

/// Keeps tiles in a temporary file, and some of them in memory: as many as fit. All threads share
/// it.
///
/// It is cut into shards, each with a lock.
#[derive(Debug)]
pub struct TileCache {
    shards: Vec<Mutex<Ring>>,
    limit: AtomicU64,
    at_hand: usize,
    spool: OnceLock<Option<Spool>>,
    failure: OnceLock<String>,
    bytes: AtomicU64,
    peak: AtomicU64,
    stored: AtomicU64,
    stored_in_memory: AtomicU64,
    read: AtomicU64,
    found: AtomicU64,
    evicted: AtomicU64,
}

impl TileCache {
    /// An empty one that may hold so many bytes of tiles; threads may hold an eighth more, as long
    /// as their tiles are of usual size: those of floats are up to four times as large.
    pub fn new(limit: u64) -> Self {
        let shards = (limit / SHARD_BYTES).clamp(1, 64);
        let threads = rayon::current_num_threads().max(1) as u64;
        let at_hand = (limit / 8 / threads / USUAL_TILE).clamp(4, MOST_AT_HAND as u64);
        Self {
            shards: (0..shards).map(|_| Mutex::default()).collect(),
            limit: AtomicU64::new(limit),
            at_hand: 1 << at_hand.ilog2(),
            spool: OnceLock::new(),
            failure: OnceLock::new(),
            bytes: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            stored: AtomicU64::new(0),
            stored_in_memory: AtomicU64::new(0),
            read: AtomicU64::new(0),
            found: AtomicU64::new(0),
            evicted: AtomicU64::new(0),
        }
    }

    /// Changes how many bytes of tiles it may hold.
    pub fn set_limit(&self, limit: u64) {
        self.limit.store(limit, Relaxed);
    }

    /// How many tiles a thread should have for itself: a power of two.
    #[inline]
    pub(super) fn at_hand(&self) -> usize {
        self.at_hand
    }

    /// What it has done so far.
    pub fn figures(&self) -> CacheFigures {
        CacheFigures {
            limit: self.limit.load(Relaxed),
            peak: self.peak.load(Relaxed),
            stored: self.stored.load(Relaxed),
            stored_in_memory: self.stored_in_memory.load(Relaxed),
            read: self.read.load(Relaxed),
            found: self.found.load(Relaxed),
            evicted: self.evicted.load(Relaxed),
        }
    }

    /// Why a tile could not be read back, if that has happened: what was looked up is wrong then.
    pub fn failure(&self) -> Option<&str> {
        self.failure.get().map(String::as_str)
    }

    /// Keeps a row of tiles, in memory where the temporary file has no room, and forgets it in
    /// `packed`.
    pub(super) fn keep(&self, packed: &mut Packed) -> Row {
        let bytes = packed.bytes().len() as u64;
        self.stored.fetch_add(bytes, Relaxed);
        let spool = self.spool.get_or_init(|| Spool::new().ok()).as_ref();
        let start = spool.and_then(|spool| spool.append(packed.bytes()).ok());
        let place = start.map_or_else(
            || {
                self.stored_in_memory.fetch_add(bytes, Relaxed);
                Place::Memory(packed.bytes().into())
            },
            Place::File,
        );
        let kept = |&end: &u32| Kept { end, number: AtomicU32::new(0) };
        let tiles = packed.ends().iter().map(kept).collect();
        packed.clear();
        Row { place, tiles }
    }

    /// Makes `tile` the one of such a key, which is in such a column of its row; a texel has so
    /// many bytes.
    pub(super) fn get(&self, key: u64, row: &Row, column: usize, texel: usize, tile: &mut Vec<u8>) {
        let shard = &self.shards[(mix(key) >> 48) as usize % self.shards.len()];
        let number = &row.tiles[column].number;
        if let Some(bytes) = lock(shard).find(key, number.load(Relaxed)) {
            tile.clear();
            tile.reserve_exact(bytes.len());
            tile.extend_from_slice(bytes);
            self.found.fetch_add(1, Relaxed);
            return;
        }
        // Two threads may read one tile: that is rarer than waiting for each other would be.
        self.read.fetch_add(1, Relaxed);
        if let Err(error) = self.read(row, row.range(column), texel, tile) {
            let _ = self.failure.set(error.to_string());
            pack::clear(tile, texel);
        }
        let limit = self.limit.load(Relaxed) / self.shards.len() as u64;
        let mut shard = lock(shard);
        if shard.find(key, number.load(Relaxed)).is_some() {
            return;
        }
        let (new, change) = shard.insert(key, tile, limit as usize);
        number.store(new, Relaxed);
        // Counted under the lock, so that no more is counted than there is.
        let more = change.added.wrapping_sub(change.removed);
        let bytes = self.bytes.fetch_add(more, Relaxed).wrapping_add(more);
        self.peak.fetch_max(bytes, Relaxed);
        self.evicted.fetch_add(change.evicted, Relaxed);
    }

    /// Reads a tile from where its row is kept.
    fn read(
        &self,
        row: &Row,
        range: Range<usize>,
        texel: usize,
        tile: &mut Vec<u8>,
    ) -> io::Result<()> {
        tile.reserve_exact(range.len().saturating_sub(tile.len()));
        tile.resize(range.len(), 0);
        match &row.place {
            Place::Memory(bytes) => tile.copy_from_slice(&bytes[range]),
            Place::File(start) => {
                let spool = self.spool.get().and_then(Option::as_ref);
                let spool = spool.ok_or_else(|| io::Error::other("there is no temporary file"))?;
                spool.read(start + range.start as u64, tile)?;
            }
        }
        pack::check(tile, texel)
    }
}

fn lock(shard: &Mutex<Ring>) -> MutexGuard<'_, Ring> {
    shard.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tile of grey: even if its number is, else noise.
    fn tile(number: u8) -> Vec<u8> {
        let noise = |i: u64| (mix(i * 256 + u64::from(number)) >> 9) as u8;
        (0..1024).map(|i| if number.is_multiple_of(2) { number } else { noise(i) }).collect()
    }

    /// What the cache gives as a tile.
    fn unpacked(tile: &[u8]) -> Vec<u8> {
        let at = |i: u32| {
            let mut byte = [0];
            pack::texel(tile, [i % 32, i / 32], &mut byte);
            byte[0]
        };
        (0..1024).map(at).collect()
    }

    #[test]
    fn tiles_come_back_as_they_were_and_stay_within_the_limit() {
        let cache = TileCache::new(16 << 10);
        let tiles: Vec<Vec<u8>> = (0..64).map(tile).collect();
        let mut packed = Packed::new();
        for tile in &tiles {
            packed.push(tile, 32, 1);
        }
        let row = cache.keep(&mut packed);
        assert!(packed.bytes().is_empty());
        let mut found = Vec::new();
        for round in 0..3_usize {
            for i in (0..64).map(|i| (i * (2 * round + 1)) % 64) {
                cache.get(i as u64, &row, i, 1, &mut found);
                assert_eq!(unpacked(&found), tiles[i]);
            }
        }
        cache.get(9, &row, 9, 1, &mut found);
        let figures = cache.figures();
        cache.get(9, &row, 9, 1, &mut found);
        assert_eq!(unpacked(&found), tiles[9]);
        assert_eq!(cache.figures().found, figures.found + 1);
        assert_eq!(figures.limit, 16 << 10);
        assert!(figures.peak <= 16 << 10 && figures.peak > 8 << 10, "{figures:?}");
        assert_eq!(figures.stored, 64 * (16 * 4 + 2) + 32 * 1024);
        assert_eq!(figures.read - figures.evicted, 21);
        assert_eq!((cache.failure(), figures.stored_in_memory), (None, 0));
    }

    #[test]
    fn a_tile_that_cannot_be_read_is_told() {
        let cache = TileCache::new(1 << 20);
        let mut packed = Packed::new();
        packed.push(&tile(1), 32, 1);
        let row = cache.keep(&mut packed);
        let beyond = Row { place: Place::File(1 << 30), ..row };
        let mut found = vec![7; 9];
        cache.get(1, &beyond, 0, 1, &mut found);
        assert_eq!(unpacked(&found), [0; 1024]);
        assert!(cache.failure().is_some());
    }
}
