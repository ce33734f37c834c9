//! A tile as bytes, and back.
//!
//! The numbers of a tile stand by columns: the same number of all pixels, one after the other, as
//! [`planes`] of bytes. Last come the means that the tile remembers, if it does.

use super::planes;
use crate::film::Window;
use crate::render::{Earlier, LostSample, Tile};

/// Bytes before the numbers, and of each lost sample that is listed.
const FIXED: usize = 42;
const LOST: usize = 16;

/// The bytes of a tile.
pub fn encode(tile: &Tile) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(1 << 15);
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
    let pixels = tile.window.area();
    for column in columns(tile).chunks_exact(pixels) {
        planes::encode(column, &mut bytes);
    }
    for channel in 0..if tile.earlier.means.is_empty() { 0 } else { 3 } {
        let bits = |mean: &[f32; 3]| u64::from(mean[channel].to_bits());
        planes::encode(&tile.earlier.means.iter().map(bits).collect::<Vec<_>>(), &mut bytes);
    }
    bytes
}

/// The numbers of all pixels, by columns.
fn columns(tile: &Tile) -> Vec<u64> {
    let pixels = tile.window.area();
    let mut columns = vec![0; pixels * Tile::words_of_pixel(tile.range.clone())];
    for (pixel, words) in tile.words().enumerate() {
        let mut place = pixel;
        words.for_each(|bits| {
            columns[place] = bits;
            place += pixels;
        });
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
    let (lost, mut rest) = rest.split_at_checked(listed * LOST).ok_or("is too short")?;
    let pixels = window.area();
    let words = Tile::words_of_pixel(range.clone());
    let remembered = if samples > 0 { 3 } else { 0 };
    let mut columns = vec![0; pixels * (words + remembered)];
    for column in columns.chunks_exact_mut(pixels) {
        rest = planes::decode(column, rest).ok_or("has numbers that cannot be read")?;
    }
    if !rest.is_empty() {
        return Err("has more numbers than samples");
    }
    let (columns, means) = columns.split_at(pixels * words);
    let of_pixel = |pixel: usize| (0..words).map(move |word| columns[word * pixels + pixel]);
    let tile = Tile::from_words(window, range, (0..pixels).map(of_pixel));
    let mut tile = tile.ok_or("has sums that no samples have")?;
    let means: Option<Vec<[f32; 3]>> =
        (0..means.len() / 3).map(|pixel| read_mean(means, pixel, pixels)).collect();
    let means = means.ok_or("remembers what there was not")?;
    tile.earlier = Earlier { error, samples, means };
    tile.finished = finished == 1;
    tile.lost_count = lost_count;
    tile.lost = lost.chunks_exact(LOST).map(read_lost).collect();
    Ok(tile)
}

fn read_mean(columns: &[u64], pixel: usize, pixels: usize) -> Option<[f32; 3]> {
    let bits = |channel: usize| u32::try_from(columns[channel * pixels + pixel]).ok();
    Some([bits(0)?, bits(1)?, bits(2)?].map(f32::from_bits))
}

fn read_lost(bytes: &[u8]) -> LostSample {
    let side = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
    let sample = u64::from_le_bytes(bytes[8..16].try_into().expect("8 bytes"));
    LostSample { x: side(0), y: side(4), sample }
}
