//! Tiles that are at hand: one after the other in a ring of bytes, the oldest first.
//!
//! A new one takes the place of the oldest. One that was asked for since it came, or came again,
//! comes again as the newest: a clock (Corbató 1968) whose hand is the end of the ring. So there is
//! nothing to allocate, and memory is what the ring has.

use std::collections::{HashMap, VecDeque};
use std::hash::{BuildHasherDefault, Hasher};

/// Bytes of what is remembered of a tile: its [`Entry`] and its number.
const ENTRY_BYTES: usize = 64;

/// One part in so many of all memory may go to what is remembered of tiles.
const ENTRIES_PART: usize = 16;

/// A ring of bytes, with what is remembered of its tiles.
#[derive(Debug, Default)]
pub(super) struct Ring {
    /// Bytes that it may have, and all that is remembered.
    limit: usize,
    bytes: Vec<u8>,
    /// Tiles from the oldest on.
    entries: VecDeque<Entry>,
    /// How many have gone: the number of the oldest.
    first: u64,
    /// The number of each tile.
    numbers: HashMap<u64, u64, BuildHasherDefault<KeyHasher>>,
    /// Where the newest ends.
    end: usize,
}

#[derive(Debug)]
struct Entry {
    key: u64,
    start: usize,
    length: u32,
    asked_for: bool,
}

/// What a new tile has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Change {
    /// Bytes of the new one.
    pub added: u64,
    /// Bytes of those that made room.
    pub removed: u64,
    /// How many these are.
    pub evicted: u64,
}

/// Keys are numbers that [`mix`] spreads.
#[derive(Debug, Default)]
pub(super) struct KeyHasher(u64);

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

impl Ring {
    /// The bytes of a tile, if it is here.
    pub fn find(&mut self, key: u64) -> Option<&[u8]> {
        let number = self.numbers.get(&key)?;
        let entry = self.entries.get_mut((number - self.first) as usize)?;
        entry.asked_for = true;
        Some(&self.bytes[entry.start..][..entry.length as usize])
    }

    /// Adds a tile. All tiles, and what is remembered of them, take no more than `limit` bytes: one
    /// that is larger is not kept, and all go if the limit is another than before.
    pub fn insert(&mut self, key: u64, tile: &[u8], limit: usize) -> Change {
        let mut change = Change::default();
        if self.limit != limit {
            change = self.restart(limit);
        }
        if tile.len() <= self.bytes.capacity() && !self.numbers.contains_key(&key) {
            self.make_room(tile.len(), &mut change);
            let end = self.end + tile.len();
            if self.bytes.len() < end {
                self.bytes.resize(end, 0);
            }
            self.bytes[self.end..end].copy_from_slice(tile);
            self.push(key, tile.len());
            change.added = tile.len() as u64;
        }
        change
    }

    /// Empties it, and sets memory aside: none if there is too little, so that no tile is kept.
    fn restart(&mut self, limit: usize) -> Change {
        let removed = self.entries.iter().map(|entry| u64::from(entry.length)).sum();
        let evicted = self.entries.len() as u64;
        *self = Self { limit, ..Self::default() };
        let most = limit / ENTRIES_PART / ENTRY_BYTES;
        let is_there = most > 0
            && self.entries.try_reserve_exact(most).is_ok()
            && self.numbers.try_reserve(most).is_ok();
        if is_there {
            // Without it, its capacity is none.
            let _ = self.bytes.try_reserve_exact(limit - most * ENTRY_BYTES);
        }
        Change { added: 0, removed, evicted }
    }

    /// Brings the end to where so many bytes are free.
    fn make_room(&mut self, length: usize, change: &mut Change) {
        let (room, most) = (self.bytes.capacity(), self.entries.capacity());
        loop {
            let Some(oldest) = self.entries.front().map(|oldest| oldest.start) else {
                self.end = 0;
                return;
            };
            // The oldest lies ahead, or all lie behind and the bytes end ahead.
            let free = if oldest < self.end { room } else { oldest } - self.end;
            if free >= length && self.entries.len() < most {
                return;
            }
            if free < length && oldest < self.end {
                self.end = 0;
                continue;
            }
            self.pop(change);
        }
    }

    /// Takes the oldest away; if it was asked for, it comes again.
    fn pop(&mut self, change: &mut Change) {
        let Some(Entry { key, start, length, asked_for }) = self.entries.pop_front() else {
            return;
        };
        self.first += 1;
        let length = length as usize;
        if !asked_for {
            self.numbers.remove(&key);
            change.removed += length as u64;
            change.evicted += 1;
            return;
        }
        if start < self.end && self.end + length > self.bytes.len() {
            self.end = 0;
        }
        self.bytes.copy_within(start..start + length, self.end);
        self.push(key, length);
    }

    /// What lies behind the end is the newest tile.
    fn push(&mut self, key: u64, length: usize) {
        self.numbers.insert(key, self.first + self.entries.len() as u64);
        let entry = Entry { key, start: self.end, length: length as u32, asked_for: false };
        self.entries.push_back(entry);
        self.end += length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that tell a tile.
    fn tile(key: u64) -> Vec<u8> {
        (0..100 + key * 37 % 1500).map(|i| (key + i) as u8).collect()
    }

    #[test]
    fn tiles_are_as_they_came_and_within_the_limit() {
        let (mut ring, mut state, mut here) = (Ring::default(), 1_u64, 0);
        let (mut found, mut gone) = (0, 0);
        for _ in 0..20_000 {
            state = mix(state + 1);
            // Some are asked for often.
            let key = if state.is_multiple_of(3) { state >> 60 } else { state >> 56 };
            match ring.find(key) {
                Some(bytes) => {
                    assert_eq!(bytes, tile(key));
                    found += 1;
                }
                None => {
                    let Change { added, removed, evicted } = ring.insert(key, &tile(key), 40_000);
                    assert_eq!(added, tile(key).len() as u64);
                    (here, gone) = (here + added - removed, gone + evicted);
                }
            }
            let all: u64 = ring.entries.iter().map(|entry| u64::from(entry.length)).sum();
            assert!(here == all && ring.bytes.len() <= ring.bytes.capacity());
            assert!(ring.bytes.capacity() + ring.entries.len() * ENTRY_BYTES <= 40_000);
        }
        assert!(found > 2000 && gone > 2000, "{found} {gone}");
        let kept = ring.entries.len() as u64;
        let change = ring.insert(1 << 40, &[1; 10], 5000);
        assert_eq!(change, Change { added: 10, removed: here, evicted: kept });
        assert!(ring.find(1 << 40) == Some(&[1; 10]) && ring.entries.len() == 1);
    }

    #[test]
    fn what_is_asked_for_again_stays() {
        let mut ring = Ring::default();
        // Room for four tiles of 960 bytes.
        (0..4).for_each(|key| assert_eq!(ring.insert(key, &[key as u8; 960], 4096).evicted, 0));
        assert!(ring.find(0).is_some() && ring.find(2).is_some());
        assert_eq!(ring.insert(4, &[4; 960], 4096).evicted, 1);
        assert!(ring.find(1).is_none() && ring.find(4) == Some(&[4; 960]));
        assert!(ring.find(0) == Some(&[0; 960]) && ring.find(2) == Some(&[2; 960]));
        // Too large for all of it, and no room at all.
        assert_eq!(ring.insert(5, &[5; 4096], 4096), Change::default());
        let all = Change { added: 0, removed: 4 * 960, evicted: 4 };
        assert_eq!(ring.insert(5, &[5; 10], 1000), all);
        assert!(ring.find(5).is_none());
    }
}
