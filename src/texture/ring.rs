//! Tiles that are at hand: one after the other in a ring of bytes, the oldest first.
//!
//! A new one takes the place of the oldest, whether that was asked for of late or not: paths that
//! have bounced ask at random, and those from the camera ask again at once or never. So there is
//! nothing to allocate or to sort, and memory is what the ring has.

use std::collections::VecDeque;

/// One part in so many of all memory goes to what is remembered of tiles.
const ENTRIES_PART: usize = 32;

/// A ring of bytes, with what is remembered of its tiles.
#[derive(Debug, Default)]
pub(super) struct Ring {
    /// Bytes that it may have, and all that is remembered.
    limit: usize,
    bytes: Vec<u8>,
    /// Tiles from the oldest on.
    entries: VecDeque<Entry>,
    /// The number of the oldest. Tiles are numbered as they come.
    first: u32,
    /// Where the newest ends.
    end: usize,
}

#[derive(Debug)]
struct Entry {
    key: u64,
    start: usize,
    length: u32,
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

/// Spreads a key over all bits.
#[inline]
pub(super) fn mix(key: u64) -> u64 {
    let product = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    product ^ (product >> 32)
}

impl Ring {
    /// The bytes of a tile that came with such a number, if it is still here.
    pub fn find(&self, key: u64, number: u32) -> Option<&[u8]> {
        let entry = self.entries.get(number.wrapping_sub(self.first) as usize)?;
        (entry.key == key).then(|| &self.bytes[entry.start..][..entry.length as usize])
    }

    /// Adds a tile, and says its number. All tiles, and what is remembered of them, take no more
    /// than `limit` bytes: one that is larger is not kept, and all go if the limit is another than
    /// before.
    pub fn insert(&mut self, key: u64, tile: &[u8], limit: usize) -> (u32, Change) {
        let mut change = Change::default();
        if self.limit != limit {
            self.restart(limit, &mut change);
        }
        let number = || self.first.wrapping_add(self.entries.len() as u32);
        if tile.len() > self.bytes.capacity() {
            return (number(), change);
        }
        self.make_room(tile.len(), &mut change);
        let start = self.end;
        self.end += tile.len();
        let over = self.end.min(self.bytes.len()) - start;
        self.bytes[start..start + over].copy_from_slice(&tile[..over]);
        self.bytes.extend_from_slice(&tile[over..]);
        self.entries.push_back(Entry { key, start, length: tile.len() as u32 });
        change.added = tile.len() as u64;
        (self.first.wrapping_add(self.entries.len() as u32 - 1), change)
    }

    /// Empties it, and sets memory aside: none if there is too little, so that no tile is kept.
    fn restart(&mut self, limit: usize, change: &mut Change) {
        while !self.entries.is_empty() {
            self.pop(change);
        }
        *self = Self { limit, first: self.first, ..Self::default() };
        let most = limit / ENTRIES_PART / size_of::<Entry>();
        if most > 0 && self.entries.try_reserve_exact(most).is_ok() {
            // Without it, its capacity is none.
            let _ = self.bytes.try_reserve_exact(limit - most * size_of::<Entry>());
        }
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
            } else {
                self.pop(change);
            }
        }
    }

    /// Takes the oldest away.
    fn pop(&mut self, change: &mut Change) {
        if let Some(entry) = self.entries.pop_front() {
            self.first = self.first.wrapping_add(1);
            change.removed += u64::from(entry.length);
            change.evicted += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    /// Bytes that tell a tile.
    fn tile(key: u64) -> Vec<u8> {
        (0..100 + key * 37 % 1500).map(|i| (key + i) as u8).collect()
    }

    #[test]
    fn tiles_are_as_they_came_and_within_the_limit() {
        let (mut ring, mut state, mut here) = (Ring::default(), 1_u64, 0);
        let (mut numbers, mut found, mut gone) = (HashMap::new(), 0, 0);
        for _ in 0..20_000 {
            state = mix(state + 1);
            let key = state >> 57;
            let number = numbers.get(&key).copied().unwrap_or(0);
            if let Some(bytes) = ring.find(key, number) {
                assert_eq!(bytes, tile(key));
                found += 1;
            } else {
                let (number, change) = ring.insert(key, &tile(key), 40_000);
                numbers.insert(key, number);
                assert_eq!(change.added, tile(key).len() as u64);
                (here, gone) = (here + change.added - change.removed, gone + change.evicted);
                assert_eq!(ring.find(key, number), Some(&tile(key)[..]));
            }
            let all: u64 = ring.entries.iter().map(|entry| u64::from(entry.length)).sum();
            assert!(here == all && ring.bytes.len() <= ring.bytes.capacity());
            let remembered = ring.entries.capacity() * size_of::<Entry>();
            assert!(ring.bytes.capacity() + remembered <= 40_000);
        }
        assert!(found > 2000 && gone > 2000, "{found} {gone}");
        let kept = ring.entries.len() as u64;
        let (number, change) = ring.insert(1 << 40, &[1; 10], 5000);
        assert_eq!(change, Change { added: 10, removed: here, evicted: kept });
        assert!(ring.find(1 << 40, number) == Some(&[1; 10]) && ring.entries.len() == 1);
    }

    #[test]
    fn the_oldest_goes_first() {
        let mut ring = Ring::default();
        // Room for four tiles of 960 bytes.
        for key in 0..4 {
            let change = Change { added: 960, ..Change::default() };
            assert_eq!(ring.insert(key, &[key as u8; 960], 4096), (key as u32, change));
        }
        let change = Change { added: 960, removed: 960, evicted: 1 };
        assert_eq!(ring.insert(4, &[4; 960], 4096), (4, change));
        assert!(ring.find(0, 0).is_none() && ring.find(4, 4) == Some(&[4; 960]));
        assert!(ring.find(1, 1) == Some(&[1; 960]) && ring.find(1, 2).is_none());
        // Too large for all of it, and no room at all.
        assert_eq!(ring.insert(5, &[5; 4096], 4096).1, Change::default());
        let all = Change { added: 0, removed: 4 * 960, evicted: 4 };
        let (number, change) = ring.insert(5, &[5; 10], 700);
        assert!(change == all && ring.find(5, number).is_none());
    }
}
