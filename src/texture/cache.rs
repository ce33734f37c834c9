//! Tiles of textures that do not fit in memory: where they are kept, and those that are at hand.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::io;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use super::pack::{Packed, unpack};
use super::texels::{Depth, Texels};
use crate::files::Spool;

/// Of how many tiles a thread remembers where they are, at most.
pub(super) const MOST_AT_HAND: usize = 256;

/// Bytes of a shard that are worth a lock of their own.
const SHARD_BYTES: u64 = 4 << 20;

/// A tile of usual size, in bytes.
const USUAL_TILE: u64 = 4 << 10;

/// Where a tile is kept.
#[derive(Debug)]
pub(super) enum Place {
    /// In the temporary file.
    File {
        /// From this byte on.
        start: u64,
        /// Bytes there; as many as the tile has if it is not compressed.
        length: u32,
    },
    /// In memory, because there is no room for the file.
    Memory(Box<[u8]>),
}

/// What the cache has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CacheFigures {
    /// Bytes that decoded tiles may take.
    pub limit: u64,
    /// The most that they have taken.
    pub peak: u64,
    /// Bytes of all tiles as they are kept: in the temporary file or, where that is full, in
    /// memory.
    pub stored: u64,
    /// The part of it that is in memory.
    pub stored_in_memory: u64,
    /// Tiles that were decoded.
    pub decoded: u64,
    /// Tiles that were there when a thread asked for one that it did not have at hand.
    pub found: u64,
    /// Tiles that made room for others.
    pub evicted: u64,
}

/// Keeps tiles in a temporary file, and some of them decoded: as many as fit. All threads share it.
///
/// It is cut into shards, each with a lock. Who makes room in a shard is told by a clock (Corbató
/// 1968): a tile that was asked for since the hand last passed has a second chance.
#[derive(Debug)]
pub struct TileCache {
    shards: Vec<Mutex<Shard>>,
    limit: AtomicU64,
    at_hand: usize,
    spool: OnceLock<Option<Spool>>,
    failure: OnceLock<String>,
    bytes: AtomicU64,
    peak: AtomicU64,
    stored: AtomicU64,
    stored_in_memory: AtomicU64,
    decoded: AtomicU64,
    found: AtomicU64,
    evicted: AtomicU64,
}

#[derive(Debug, Default)]
struct Shard {
    slots: HashMap<u64, usize, BuildHasherDefault<KeyHasher>>,
    tiles: Vec<Slot>,
    hand: usize,
    bytes: u64,
}

#[derive(Debug)]
struct Slot {
    key: u64,
    tile: Arc<Texels>,
    asked_for: bool,
}

/// Keys are numbers that [`mix`] spreads.
#[derive(Debug, Default)]
struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(byte.into());
        }
    }

    fn write_u64(&mut self, key: u64) {
        self.0 = mix(self.0 ^ key);
    }
}

/// Spreads a key over all bits.
#[inline]
pub(super) fn mix(key: u64) -> u64 {
    let product = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    product ^ (product >> 32)
}

impl TileCache {
    /// An empty one that may hold so many bytes of decoded tiles; threads may hold an eighth more.
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
            decoded: AtomicU64::new(0),
            found: AtomicU64::new(0),
            evicted: AtomicU64::new(0),
        }
    }

    /// Changes how many bytes of decoded tiles it may hold.
    pub fn set_limit(&self, limit: u64) {
        self.limit.store(limit, Relaxed);
    }

    /// Of how many tiles a thread should remember where they are: a power of two.
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
            decoded: self.decoded.load(Relaxed),
            found: self.found.load(Relaxed),
            evicted: self.evicted.load(Relaxed),
        }
    }

    /// Why a tile could not be read back, if that has happened: what was looked up is wrong then.
    pub fn failure(&self) -> Option<&str> {
        self.failure.get().map(String::as_str)
    }

    /// Keeps tiles, in memory where the temporary file has no room, and forgets them in `packed`.
    pub(super) fn keep(&self, packed: &mut Packed) -> Vec<Place> {
        let bytes = packed.bytes().len() as u64;
        self.stored.fetch_add(bytes, Relaxed);
        let spool = self.spool.get_or_init(|| Spool::new().ok()).as_ref();
        let start = spool.and_then(|spool| spool.append(packed.bytes()).ok());
        if start.is_none() {
            self.stored_in_memory.fetch_add(bytes, Relaxed);
        }
        let mut from = 0;
        let place = |&length: &u32| {
            let tile = &packed.bytes()[from..from + length as usize];
            let place = match start {
                Some(start) => Place::File { start: start + from as u64, length },
                None => Place::Memory(tile.into()),
            };
            from += length as usize;
            place
        };
        let places = packed.lengths().iter().map(place).collect();
        packed.clear();
        places
    }

    /// The tile `key`, kept at `place`, of so many values.
    pub(super) fn tile(&self, key: u64, place: &Place, depth: Depth, count: usize) -> Arc<Texels> {
        let number = (mix(key) >> 48) as usize % self.shards.len();
        if let Some(tile) = lock(&self.shards[number]).find(key) {
            self.found.fetch_add(1, Relaxed);
            return tile;
        }
        // Two threads may decode one tile: that is rarer than waiting for each other would be.
        self.decoded.fetch_add(1, Relaxed);
        let mut texels = depth.zeros(count);
        if let Err(error) = self.read(place, texels.as_bytes_mut()) {
            let _ = self.failure.set(error.to_string());
        }
        let tile = Arc::new(texels);
        let limit = self.limit.load(Relaxed) / self.shards.len() as u64;
        let mut shard = lock(&self.shards[number]);
        let (added, removed, evicted) = shard.insert(key, Arc::clone(&tile), limit);
        // Counted under the lock, so that no more is counted than there is.
        let change = added.wrapping_sub(removed);
        let bytes = self.bytes.fetch_add(change, Relaxed).wrapping_add(change);
        self.peak.fetch_max(bytes, Relaxed);
        self.evicted.fetch_add(evicted, Relaxed);
        tile
    }

    /// Reads a tile's bytes from where they are kept.
    fn read(&self, place: &Place, bytes: &mut [u8]) -> io::Result<()> {
        match place {
            Place::Memory(packed) => unpack(packed, bytes),
            Place::File { start, length } => {
                let spool = self.spool.get().and_then(Option::as_ref);
                let spool = spool.ok_or_else(|| io::Error::other("there is no temporary file"))?;
                if *length as usize == bytes.len() {
                    return spool.read(*start, bytes);
                }
                SCRATCH.with_borrow_mut(|scratch| {
                    let length = *length as usize;
                    if scratch.len() < length {
                        scratch.resize(length, 0);
                    }
                    spool.read(*start, &mut scratch[..length])?;
                    unpack(&scratch[..length], bytes)
                })
            }
        }
    }
}

thread_local! {
    /// Room for a tile as it is kept.
    static SCRATCH: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

fn lock(shard: &Mutex<Shard>) -> MutexGuard<'_, Shard> {
    shard.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shard {
    fn find(&mut self, key: u64) -> Option<Arc<Texels>> {
        let slot = &mut self.tiles[*self.slots.get(&key)?];
        slot.asked_for = true;
        Some(Arc::clone(&slot.tile))
    }

    /// Adds a tile, and makes room for it within `limit` bytes; the last one stays, whatever its
    /// size. Returns bytes added, bytes removed and tiles removed.
    fn insert(&mut self, key: u64, tile: Arc<Texels>, limit: u64) -> (u64, u64, u64) {
        if self.slots.contains_key(&key) {
            return (0, 0, 0);
        }
        let bytes = tile.as_bytes().len() as u64;
        let (mut removed, mut evicted) = (0, 0);
        while !self.tiles.is_empty() && self.bytes + bytes > limit {
            self.hand %= self.tiles.len();
            let slot = &mut self.tiles[self.hand];
            if std::mem::take(&mut slot.asked_for) {
                self.hand += 1;
                continue;
            }
            let old = self.tiles.swap_remove(self.hand);
            self.slots.remove(&old.key);
            if let Some(moved) = self.tiles.get(self.hand) {
                self.slots.insert(moved.key, self.hand);
            }
            let freed = old.tile.as_bytes().len() as u64;
            self.bytes -= freed;
            removed += freed;
            evicted += 1;
        }
        self.slots.insert(key, self.tiles.len());
        self.tiles.push(Slot { key, tile, asked_for: false });
        self.bytes += bytes;
        (bytes, removed, evicted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tile(number: u8) -> Vec<u8> {
        // Every other cannot be compressed.
        let noise = |i: u64| (mix(i * 256 + u64::from(number)) >> 9) as u8;
        (0..1024).map(|i| if number.is_multiple_of(2) { number } else { noise(i) }).collect()
    }

    #[test]
    fn tiles_come_back_as_they_were_and_stay_within_the_limit() {
        let cache = TileCache::new(8 << 10);
        let tiles: Vec<Vec<u8>> = (0..64).map(tile).collect();
        let mut packed = Packed::default();
        for tile in &tiles {
            packed.push(tile);
        }
        let places = cache.keep(&mut packed);
        assert!(packed.bytes().is_empty());
        for round in 0..3_u64 {
            for i in (0..64).map(|i| (i * (2 * round + 1)) % 64) {
                let found = cache.tile(i, &places[i as usize], Depth::U8, 1024);
                assert_eq!(found.as_bytes(), tiles[i as usize]);
            }
        }
        let again = cache.tile(9, &places[9], Depth::U8, 1024);
        let figures = cache.figures();
        assert!(Arc::ptr_eq(&again, &cache.tile(9, &places[9], Depth::U8, 1024)));
        assert_eq!(cache.figures().found, figures.found + 1);
        assert_eq!((figures.limit, figures.peak), (8 << 10, 8 << 10));
        assert!(figures.stored > 32 << 10 && figures.stored < 40 << 10, "{figures:?}");
        assert_eq!(figures.decoded - figures.evicted, 8);
        assert_eq!((cache.failure(), figures.stored_in_memory), (None, 0));
    }

    #[test]
    fn what_is_asked_for_again_stays() {
        let mut shard = Shard::default();
        let tile = || Arc::new(Texels::U8(vec![0; 100]));
        for key in 0..4 {
            shard.insert(key, tile(), 400);
        }
        assert!(shard.find(0).is_some() && shard.find(2).is_some());
        assert_eq!(shard.insert(4, tile(), 400), (100, 100, 1));
        assert!(shard.find(1).is_none() && shard.find(0).is_some() && shard.find(4).is_some());
        assert_eq!(shard.insert(5, Arc::new(Texels::U8(vec![0; 999])), 400), (999, 400, 4));
        assert!(shard.find(5).is_some() && shard.tiles.len() == 1);
    }

    #[test]
    fn a_tile_that_cannot_be_read_is_told() {
        let cache = TileCache::new(1 << 20);
        let mut packed = Packed::default();
        packed.push(&[1; 100]);
        cache.keep(&mut packed);
        let beyond = Place::File { start: 1 << 30, length: 50 };
        assert_eq!(*cache.tile(1, &beyond, Depth::U8, 100), Texels::U8(vec![0; 100]));
        assert!(cache.failure().is_some());
    }
}
