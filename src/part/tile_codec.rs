//! A tile as bytes, and back.
//!
//! The numbers of a tile stand by columns: the same byte of the same number of all pixels, one
//! after the other, for neighbours have like exponents; then they are deflated. Last come the means
//! that the tile remembers, if it does.

use std::io::{Read, Write};

use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;

use crate::film::Window;
use crate::render::{Earlier, LostSample, Tile};

/// Bytes before the numbers, and of each lost sample that is listed.
const FIXED: usize = 42;
const LOST: usize = 16;

/// The bytes of a tile.
///
/// # Errors
/// None of its own: memory is written to.
pub fn encode(tile: &Tile) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    bytes.extend(tile.range.start.to_le_bytes());
    bytes.extend(tile.range.end.to_le_bytes());
    bytes.extend(tile.lost_count.to_le_bytes());
    bytes.extend(tile.earlier.samples.to_le_bytes());
    bytes.extend(tile.earlier.error.to_le_bytes());
    bytes.push(tile.finished.into());
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
    let words = Tile::words_of_pixel(tile.range.clone());
    let mut columns = vec![0; 8 * pixels * words];
    for (pixel, words) in tile.words().enumerate() {
        for (word, bits) in words.enumerate() {
            for (byte, value) in bits.to_le_bytes().into_iter().enumerate() {
                columns[(word * 8 + byte) * pixels + pixel] = value;
            }
        }
    }
    for channel in 0..3 {
        for byte in 0..4 {
            let value = |mean: &[f32; 3]| mean[channel].to_le_bytes()[byte];
            columns.extend(tile.earlier.means.iter().map(value));
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
    let (range, lost_count) = (number(0)..number(8), number(16));
    let (samples, error) = (number(24), f64::from_bits(number(32)));
    let (finished, listed) = (fixed[40], usize::from(fixed[41]));
    if range.start > range.end || range.end > 1 << 32 || !range.start.is_multiple_of(16) {
        return Err("has samples that there are not");
    }
    if finished > 1 || listed > 10 || lost_count < listed as u64 {
        return Err("has lost samples that there are not");
    }
    if error.is_nan() || samples > range.end {
        return Err("remembers what there was not");
    }
    let (lost, deflated) = rest.split_at_checked(listed * LOST).ok_or("is too short")?;
    let pixels = window.area();
    let words = Tile::words_of_pixel(range.clone());
    let remembered = if samples > 0 { 12 * pixels } else { 0 };
    let columns = inflate(deflated, 8 * pixels * words + remembered)?;
    let (columns, means) = columns.split_at(8 * pixels * words);
    let word = move |pixel: usize, word: usize| {
        let byte = |byte: usize| columns[(word * 8 + byte) * pixels + pixel];
        u64::from_le_bytes(std::array::from_fn(byte))
    };
    let of_pixel = |pixel: usize| (0..words).map(move |at| word(pixel, at));
    let tile = Tile::from_words(window, range, (0..pixels).map(of_pixel));
    let mut tile = tile.ok_or("has sums that no samples have")?;
    let means = (0..means.len() / 12).map(|pixel| read_mean(means, pixel, pixels)).collect();
    tile.earlier = Earlier { error, samples, means };
    tile.finished = finished == 1;
    tile.lost_count = lost_count;
    tile.lost = lost.chunks_exact(LOST).map(read_lost).collect();
    Ok(tile)
}

/// Inflates what must be so many bytes.
fn inflate(deflated: &[u8], length: usize) -> Result<Vec<u8>, &'static str> {
    let mut bytes = vec![0; length];
    let mut inflate = ZlibDecoder::new(deflated);
    inflate.read_exact(&mut bytes).map_err(|_| "cannot be inflated")?;
    match inflate.read(&mut [0]) {
        Ok(0) => Ok(bytes),
        Ok(_) => Err("has more numbers than samples"),
        Err(_) => Err("cannot be inflated"),
    }
}

fn read_mean(columns: &[u8], pixel: usize, pixels: usize) -> [f32; 3] {
    std::array::from_fn(|channel| {
        let byte = |byte: usize| columns[(channel * 4 + byte) * pixels + pixel];
        f32::from_le_bytes(std::array::from_fn(byte))
    })
}

fn read_lost(bytes: &[u8]) -> LostSample {
    let side = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
    let sample = u64::from_le_bytes(bytes[8..16].try_into().expect("8 bytes"));
    LostSample { x: side(0), y: side(4), sample }
}
