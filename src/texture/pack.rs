//! Tiles, compressed by LZ4.

use std::io;

/// Tiles one after the other, each compressed, or as it is if that is no larger.
#[derive(Debug, Default)]
pub(super) struct Packed {
    /// The tiles, and room for more.
    bytes: Vec<u8>,
    /// Bytes of all tiles.
    length: usize,
    /// Bytes of each.
    lengths: Vec<u32>,
}

impl Packed {
    /// Adds a tile.
    pub fn push(&mut self, tile: &[u8]) {
        let end = self.length + lz4_flex::block::get_maximum_output_size(tile.len());
        if self.bytes.len() < end {
            self.bytes.resize(end, 0);
        }
        let room = &mut self.bytes[self.length..end];
        let length = match lz4_flex::block::compress_into(tile, room) {
            Ok(length) if length < tile.len() => length,
            _ => {
                room[..tile.len()].copy_from_slice(tile);
                tile.len()
            }
        };
        self.length += length;
        self.lengths.push(length as u32);
    }

    /// All tiles.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// How many bytes each of them has.
    pub fn lengths(&self) -> &[u32] {
        &self.lengths
    }

    /// Forgets them; the room stays.
    pub fn clear(&mut self) {
        self.length = 0;
        self.lengths.clear();
    }
}

/// A tile as it was before [`Packed::push`].
pub(super) fn unpack(packed: &[u8], tile: &mut [u8]) -> io::Result<()> {
    if packed.len() == tile.len() {
        tile.copy_from_slice(packed);
        return Ok(());
    }
    match lz4_flex::block::decompress_into(packed, tile) {
        Ok(length) if length == tile.len() => Ok(()),
        Ok(_) => Err(io::Error::other("a tile in the temporary file is too short")),
        Err(error) => Err(io::Error::other(format!("a tile in the temporary file: {error}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_unpacked_as_they_were() {
        let mixed = |i: u32| {
            let x = i.wrapping_mul(0x9e37_79b9);
            let x = (x ^ (x >> 15)).wrapping_mul(0x85eb_ca6b);
            (x ^ (x >> 13)) as u8
        };
        let noise = (1..=1000).map(mixed);
        let (even, noise) = ([7; 1000], noise.collect::<Vec<u8>>());
        let mut packed = Packed::default();
        packed.push(&even);
        packed.push(&noise);
        let lengths = packed.lengths().to_vec();
        assert!(lengths[0] < 100 && lengths[1] == 1000, "{lengths:?}");
        let (first, second) = packed.bytes().split_at(lengths[0] as usize);
        for (from, expected) in [(first, &even[..]), (second, &noise)] {
            let mut tile = vec![0; 1000];
            unpack(from, &mut tile).expect("as it was packed");
            assert_eq!(tile, expected);
        }
        for wrong in [&[0xff; 10][..], &first[..first.len() / 2], &[]] {
            assert!(unpack(wrong, &mut [0; 1000]).is_err());
        }
        packed.clear();
        assert!(packed.bytes().is_empty() && packed.lengths().is_empty());
    }
}
