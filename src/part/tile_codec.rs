//! A tile as bytes, and back.
//!
//! The numbers of a tile stand by columns: the same byte of the same number of all pixels, one after
//! the other, for neighbours have like exponents; then they are deflated.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::film::Window;
use crate::render::{LostSample, Tile};

/// Bytes before the numbers, and of each lost sample that is listed.
const FIXED: usize = 26;
const LOST: usize = 16;

/// The bytes of a tile.
///
/// # Errors
/// None of its own: memory is written to.
pub fn encode(tile: &Tile) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    bytes.extend(tile.range.start.to_le_bytes());
    bytes.extend(tile.range.end.to_le_bytes());
    bytes.push(tile.finished.into());
    bytes.extend(tile.lost_count.to_le_bytes());
    bytes.push(tile.lost.len() as u8);
    for lost in &tile.lost {
        bytes.extend(lost.x.to_le_bytes());
        bytes.extend(lost.y.to_le_bytes());
        bytes.extend(lost.sample.to_le_bytes());
    }
    let mut deflate = ZlibEncoder::new(bytes, Compression::fast());
    deflate.write_all(&shuffle(tile))?;
    deflate.finish()
}

/// The numbers of all pixels, by columns of bytes.
fn shuffle(tile: &Tile) -> Vec<u8> {
    let pixels = tile.window.area();
    let mut columns = vec![0; 8 * pixels * Tile::words_of_pixel(tile.range.clone())];
    for (pixel, words) in tile.words().enumerate() {
        for (word, bits) in words.enumerate() {
            for (byte, value) in bits.to_le_bytes().into_iter().enumerate() {
                columns[(word * 8 + byte) * pixels + pixel] = value;
            }
        }
    }
    columns
}

/// A tile of a window from its bytes.
///
/// # Errors
/// What is wrong with them.
pub fn decode(window: Window, bytes: &[u8]) -> Result<Tile, &'static str> {
    let (fixed, rest) = bytes.split_at_checked(FIXED).ok_or("is too short")?;
    let number = |at: usize| u64::from_le_bytes(fixed[at..at + 8].try_into().expect("8 bytes"));
    let (range, finished) = (number(0)..number(8), fixed[16]);
    if range.start > range.end || range.end > 1 << 32 || !range.start.is_multiple_of(16) {
        return Err("has samples that there are not");
    }
    let (lost_count, listed) = (number(17), usize::from(fixed[25]));
    let (lost, deflated) = rest.split_at_checked(listed * LOST).ok_or("is too short")?;
    let pixels = window.area();
    let words = Tile::words_of_pixel(range.clone());
    let mut columns = vec![0; 8 * pixels * words];
    let mut inflate = ZlibDecoder::new(deflated);
    inflate.read_exact(&mut columns).map_err(|_| "cannot be inflated")?;
    if inflate.read(&mut [0]).map_err(|_| "cannot be inflated")? > 0 {
        return Err("has more numbers than samples");
    }
    let columns = &columns;
    let word = move |pixel: usize, word: usize| {
        let byte = |byte: usize| columns[(word * 8 + byte) * pixels + pixel];
        u64::from_le_bytes(std::array::from_fn(byte))
    };
    let of_pixel = |pixel: usize| (0..words).map(move |at| word(pixel, at));
    let tile = Tile::from_words(window, range, (0..pixels).map(of_pixel));
    let mut tile = tile.ok_or("has sums that no samples have")?;
    let least_lost = listed as u64;
    if finished > 1 || listed > 10 || lost_count < least_lost {
        return Err("has lost samples that there are not");
    }
    tile.finished = finished == 1;
    tile.lost_count = lost_count;
    tile.lost = lost.chunks_exact(LOST).map(read_lost).collect();
    Ok(tile)
}

fn read_lost(bytes: &[u8]) -> LostSample {
    let side = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
    let sample = u64::from_le_bytes(bytes[8..16].try_into().expect("8 bytes"));
    LostSample { x: side(0), y: side(4), sample }
}
