//! Tiles, packed so that a texel is looked up without unpacking the rest.
//!
//! Of each byte of a texel (of each channel, where values have 8 bits) a block of 8 by 8 texels has
//! the lowest one, and what each is above it, in as few bits as the highest needs: a frame of
//! reference (Goldstein, Ramakrishnan and Shaft 1998). Neighbours are alike, so that few bits do,
//! also where nothing recurs.
//!
//! A tile begins with a head for each block, row by row from the top: where its bits begin, as two
//! bytes, the lowest bytes, and the numbers of bits. Then come the bits, row by row, byte by byte
//! of a texel: those of eight texels in so many bytes as each has bits. The two last bytes are
//! there so that reading two at once stays within the tile.

use std::io;

use fearless_simd::Level;

use crate::simd::vectorized;

/// Texels across and down a tile. Those beyond an image's edge are never looked at.
///
/// Paths that have bounced ask for tiles at random, so that a small one is the better one.
pub(super) const SIDE: u32 = 32;

/// Texels across and down a block.
const BLOCK: usize = 8;

/// Blocks across a tile.
const ACROSS: usize = SIDE as usize / BLOCK;

/// Rows of blocks of a tile.
const DOWN: usize = ACROSS;

/// Blocks of a tile.
const BLOCKS: usize = ACROSS * DOWN;

/// The most bytes that a texel has.
const MOST_BYTES: usize = 16;

/// One byte of each texel in a row of blocks.
type Plane = [[u8; SIDE as usize]; BLOCK];

/// A row of bytes, block by block.
type Words = [u64; ACROSS];

/// Bytes behind the last bits.
const BEHIND: usize = 2;

/// Bytes that a block has at the tile's beginning, of texels of so many bytes.
const fn head(texel: usize) -> usize {
    2 + 2 * texel
}

/// Tiles one after the other, packed.
#[derive(Debug)]
pub(super) struct Packed {
    /// The instruction set to pack by.
    level: Level,
    /// Room for what is being packed.
    planes: Box<[Plane; MOST_BYTES]>,
    /// The tiles, and room for more.
    bytes: Vec<u8>,
    /// Bytes of all tiles.
    length: usize,
    /// Where each of them ends.
    ends: Vec<u32>,
}

impl Packed {
    /// None yet.
    pub fn new() -> Self {
        let planes = Box::new([[[0; SIDE as usize]; BLOCK]; MOST_BYTES]);
        Self { level: Level::new(), planes, bytes: Vec::new(), length: 0, ends: Vec::new() }
    }

    /// Adds a tile: `bytes` begin with its first texel, its rows are `stride` bytes apart, and a
    /// texel has `texel` bytes, which is one to four values of 1, 2 or 4.
    pub fn push(&mut self, bytes: &[u8], stride: usize, texel: usize) {
        // Eight bytes are written at once, of which some may be too many.
        let most = BLOCKS * (head(texel) + BLOCK * BLOCK * texel) + size_of::<u64>();
        if self.bytes.len() < self.length + most {
            self.bytes.resize(self.length + most, 0);
        }
        let (tile, planes) = (&mut self.bytes[self.length..], &mut *self.planes);
        let mut at = BLOCKS * head(texel);
        for row in 0..DOWN {
            let bytes = &bytes[row * BLOCK * stride..];
            vectorized!(self.level, _simd => {
                match texel {
                    1 => take_apart::<1>(bytes, stride, planes),
                    2 => take_apart::<2>(bytes, stride, planes),
                    3 => take_apart::<3>(bytes, stride, planes),
                    4 => take_apart::<4>(bytes, stride, planes),
                    6 => take_apart::<6>(bytes, stride, planes),
                    8 => take_apart::<8>(bytes, stride, planes),
                    12 => take_apart::<12>(bytes, stride, planes),
                    _ => take_apart::<16>(bytes, stride, planes),
                }
                at = pack_row(&mut planes[..texel], tile, row * ACROSS, at);
            });
        }
        tile[at..at + BEHIND].fill(0);
        self.length += at + BEHIND;
        self.ends.push(self.length as u32);
    }

    /// All tiles.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// Where each of them ends.
    pub fn ends(&self) -> &[u32] {
        &self.ends
    }

    /// Forgets them; the room stays.
    pub fn clear(&mut self) {
        self.length = 0;
        self.ends.clear();
    }
}

/// Takes a row of blocks apart: a plane of bytes for each byte of a texel.
#[inline(always)]
fn take_apart<const N: usize>(bytes: &[u8], stride: usize, planes: &mut [Plane; MOST_BYTES]) {
    for row in 0..BLOCK {
        // Not as a constant: a loop of known length is unrolled to single bytes, at half the speed.
        let side = std::hint::black_box(SIDE as usize);
        let texels: &[[u8; N]] = bytes[row * stride..][..side * N].as_chunks().0;
        for i in 0..N {
            for (byte, texel) in planes[i][row].iter_mut().zip(texels) {
                *byte = texel[i];
            }
        }
    }
}

/// Writes the heads of a row of blocks, whose first has the number `first`, and their bits from the
/// tile's byte `at` on; returns where they end.
#[inline(always)]
fn pack_row(planes: &mut [Plane], tile: &mut [u8], first: usize, mut at: usize) -> usize {
    let mut lows = [[0_u8; MOST_BYTES]; ACROSS];
    let mut widths = [[0_u8; MOST_BYTES]; ACROSS];
    for (i, plane) in planes.iter_mut().enumerate() {
        let mut low = plane[0];
        for row in &plane[1..] {
            low = lower(low, *row);
        }
        for turn in [32, 16, 8] {
            let turned = bytemuck::cast::<_, Words>(low).map(|word| word.rotate_right(turn));
            low = lower(low, bytemuck::cast(turned));
        }
        // All bytes above the lowest, together: their highest bit is that of the highest.
        let mut all: Words = [0; ACROSS];
        for row in plane.iter_mut() {
            for x in 0..SIDE as usize {
                row[x] -= low[x];
            }
            let above: Words = bytemuck::cast(*row);
            all = std::array::from_fn(|block| all[block] | above[block]);
        }
        let all = all.map(|word| [32, 16, 8].iter().fold(word, |all, by| all | all >> by) & 0xff);
        let width = all.map(|all| u64::from(u64::BITS - all.leading_zeros()));
        for row in plane {
            let words: Words = bytemuck::cast(*row);
            let bits = |block| squeeze(u64::from_le(words[block]), width[block]).to_le();
            *row = bytemuck::cast::<Words, _>(std::array::from_fn(bits));
        }
        for block in 0..ACROSS {
            (lows[block][i], widths[block][i]) = (low[block * BLOCK], width[block] as u8);
        }
    }
    let texel = planes.len();
    for block in 0..ACROSS {
        let head = &mut tile[(first + block) * head(texel)..][..head(texel)];
        head[..2].copy_from_slice(&(at as u16).to_le_bytes());
        head[2..2 + texel].copy_from_slice(&lows[block][..texel]);
        head[2 + texel..].copy_from_slice(&widths[block][..texel]);
        for row in 0..BLOCK {
            for i in 0..texel {
                let bits = &planes[i][row][block * BLOCK..][..BLOCK];
                tile[at..at + BLOCK].copy_from_slice(bits);
                at += usize::from(widths[block][i]);
            }
        }
    }
    at
}

/// The lower one of each two bytes.
#[inline(always)]
fn lower<const N: usize>(a: [u8; N], b: [u8; N]) -> [u8; N] {
    std::array::from_fn(|i| a[i].min(b[i]))
}

/// Brings the lowest `width` bits of each byte together, in the order of the bytes.
#[inline(always)]
fn squeeze(bytes: u64, width: u64) -> u64 {
    const BYTES: u64 = 0x00ff_00ff_00ff_00ff;
    const PAIRS: u64 = 0x0000_ffff_0000_ffff;
    let pairs = bytes & BYTES | (bytes >> 8 & BYTES) << width;
    let fours = pairs & PAIRS | (pairs >> 16 & PAIRS) << (2 * width);
    fours & 0xffff_ffff | (fours >> 32) << (4 * width)
}

/// Whether bytes can be a tile of texels of so many bytes: it ends where its last block does. A
/// look-up into what is damaged in another way gives other texels, and none beyond its end.
pub(super) fn check(tile: &[u8], texel: usize) -> io::Result<()> {
    let head = head(texel);
    let ends = |block: &[u8]| {
        let start = usize::from(u16::from_le_bytes([block[0], block[1]]));
        let row: usize = block[2 + texel..].iter().map(|&width| usize::from(width)).sum();
        start + BLOCK * row + BEHIND
    };
    match tile.get((BLOCKS - 1) * head..BLOCKS * head).map(ends) {
        Some(end) if end == tile.len() => Ok(()),
        _ => Err(io::Error::other("a tile in the temporary file is damaged")),
    }
}

/// Makes `tile` one of zeros.
pub(super) fn clear(tile: &mut Vec<u8>, texel: usize) {
    tile.clear();
    tile.resize(BLOCKS * head(texel) + BEHIND, 0);
}

/// Looks up the bytes of the texel in column `x` and row `y` of a tile.
#[inline(always)]
pub(super) fn texel(tile: &[u8], [x, y]: [u32; 2], bytes: &mut [u8]) {
    let (x, y, count) = (x as usize, y as usize, bytes.len());
    let block = y / BLOCK * ACROSS + x / BLOCK;
    let Some(head) = tile.get(block * head(count)..(block + 1) * head(count)) else { return };
    let start = usize::from(u16::from_le_bytes([head[0], head[1]]));
    let (lows, widths) = (&head[2..2 + count], &head[2 + count..]);
    let row: usize = widths.iter().map(|&width| usize::from(width)).sum();
    let mut at = start + y % BLOCK * row;
    for i in 0..count {
        let width = usize::from(widths[i]);
        let bit = x % BLOCK * width;
        let two = tile.get(at + bit / 8..at + bit / 8 + 2).map_or([0; 2], |two| [two[0], two[1]]);
        let bits = u16::from_le_bytes(two) >> (bit % 8) & ((1 << (width & 15)) - 1);
        bytes[i] = lows[i].wrapping_add(bits as u8);
        at += width;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXELS: usize = (SIDE * SIDE) as usize;

    /// Bytes of texels: even ones, a ramp, and noise, tile by tile.
    fn tiles(texel: usize) -> [Vec<u8>; 3] {
        let mixed = |i: usize| {
            let x = (i as u32).wrapping_mul(0x9e37_79b9);
            let x = (x ^ (x >> 15)).wrapping_mul(0x85eb_ca6b);
            (x ^ (x >> 13)) as u8
        };
        let all = 0..TEXELS * texel;
        [
            all.clone().map(|i| (i % texel) as u8 + 7).collect(),
            all.clone().map(|i| (i / texel / 32) as u8 * 5).collect(),
            all.map(mixed).collect(),
        ]
    }

    #[test]
    fn every_texel_is_looked_up_as_it_was() {
        for size in [1, 2, 3, 4, 6, 8, 12, 16] {
            let tiles = tiles(size);
            let mut packed = Packed::new();
            for tile in &tiles {
                packed.push(tile, SIDE as usize * size, size);
            }
            let mut start = 0;
            for (tile, &end) in tiles.iter().zip(packed.ends()) {
                let kept = &packed.bytes()[start..end as usize];
                start = end as usize;
                check(kept, size).expect("as it was packed");
                for (i, expected) in tile.chunks_exact(size).enumerate() {
                    let mut found = vec![0; size];
                    texel(kept, [i as u32 % SIDE, i as u32 / SIDE], &mut found);
                    assert_eq!(found, expected, "{i} of {size} bytes");
                }
            }
            packed.clear();
            assert!(packed.bytes().is_empty() && packed.ends().is_empty());
        }
    }

    #[test]
    fn what_is_alike_takes_few_bytes() {
        let mut packed = Packed::new();
        for tile in &tiles(3) {
            packed.push(tile, SIDE as usize * 3, 3);
        }
        let heads = BLOCKS * head(3) + BEHIND;
        // Seven steps of five are 35: six bits.
        let ends = [0, TEXELS * 3 * 6 / 8, TEXELS * 3];
        let lengths = ends.map(|bits| bits + heads);
        let expected = [lengths[0], lengths[0] + lengths[1], lengths.iter().sum()];
        assert_eq!(packed.ends(), expected.map(|end| end as u32));
    }

    #[test]
    fn what_is_damaged_is_told_or_looked_up_all_the_same() {
        let mut packed = Packed::new();
        packed.push(&tiles(3)[2], SIDE as usize * 3, 3);
        let tile = packed.bytes();
        let mut none = Vec::new();
        clear(&mut none, 3);
        let mut found = [1; 3];
        texel(&none, [31, 31], &mut found);
        assert_eq!(found, [0; 3]);
        assert!(check(tile, 3).is_ok());
        for length in [0, 1, BLOCKS * head(3), tile.len() - 1] {
            assert!(check(&tile[..length], 3).is_err(), "{length}");
            texel(&tile[..length], [31, 31], &mut found);
        }
        let mut wrong = tile.to_vec();
        wrong[..BLOCKS * head(3)].fill(0xff);
        assert!(check(&wrong, 3).is_err());
        for i in 0..SIDE * SIDE {
            texel(&wrong, [i % SIDE, i / SIDE], &mut found);
        }
    }
}
