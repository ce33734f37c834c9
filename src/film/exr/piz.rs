//! Blocks of PIZ whose channels have a value for every pixel or fewer: codes by Huffman of wavelets
//! of numbers that a table leads back to values (OpenEXR's `ImfPizCompressor` and `ImfWav`).
//!
//! The crate `exr` decodes the codes: a block of one line of halves, and of a table that changes
//! nothing, is the codes alone. Wavelets and table, which it has for channels of one size, are
//! here.

use std::iter;

use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::BlockDescription;
use ::exr::meta::attribute::{ChannelDescription, IntegerBounds, SampleType, Text};
use ::exr::meta::header::Header;

use crate::files::guard;

/// Bytes of the set of values that there are: a bit for each of two bytes.
const SET_BYTES: usize = 1 << 13;

/// From so many values on, wavelets are those of 16 bits.
const MOST_OF_14_BITS: usize = 1 << 14;

/// The values of a channel within a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// Values in a line.
    pub width: usize,
    /// Lines.
    pub height: usize,
    /// Numbers of 16 bits that a value is made of: one or two.
    pub words: usize,
}

impl Plane {
    fn len(self) -> usize {
        self.width * self.height * self.words
    }
}

/// The 16-bit numbers of all planes, one after the other.
///
/// # Errors
/// What is wrong with the block, without its place.
pub(super) fn unpack(packed: &[u8], planes: &[Plane]) -> Result<Vec<u16>, &'static str> {
    const CUT: &str = "is cut";
    let half =
        |at: usize| packed.get(at..at + 2).map(|it| usize::from(it[0]) | (usize::from(it[1]) << 8));
    let (first, last) = (half(0).ok_or(CUT)?, half(2).ok_or(CUT)?);
    let mut set = vec![0; SET_BYTES];
    let mut at = 4;
    if first >= SET_BYTES || last >= SET_BYTES {
        return Err("has a set of values beyond all values");
    }
    if first <= last {
        let length = last - first + 1;
        set[first..=last].copy_from_slice(packed.get(at..at + length).ok_or(CUT)?);
        at += length;
    }
    let codes = packed.get(at + 4..).ok_or(CUT)?;
    // Zero is there, whatever the set says.
    let is_there =
        |value: &u16| *value == 0 || set[usize::from(value >> 3)] & (1 << (value & 7)) != 0;
    let table: Vec<u16> = (0..=u16::MAX).filter(is_there).collect();
    let mut numbers = decode_codes(codes, planes.iter().map(|plane| plane.len()).sum())?;
    let mut rest = &mut numbers[..];
    for plane in planes {
        let (values, after) = rest.split_at_mut(plane.len());
        for word in 0..plane.words {
            undo_wavelets(values, *plane, word, table.len() <= MOST_OF_14_BITS);
        }
        rest = after;
    }
    for number in &mut numbers {
        *number = table.get(usize::from(*number)).copied().unwrap_or(0);
    }
    Ok(numbers)
}

/// So many numbers out of the codes of their own table.
fn decode_codes(codes: &[u8], count: usize) -> Result<Vec<u16>, &'static str> {
    const DAMAGED: &str = "has codes that are damaged";
    if count == 0 {
        return Ok(Vec::new());
    }
    let channel = ChannelDescription::new(Text::from("Y"), SampleType::F16, false);
    let header = Header {
        compression: Compression::PIZ,
        blocks: BlockDescription::ScanLines,
        ..Header::new(Text::from(""), Vec2(count, 1), iter::once(channel).collect())
    };
    // The set of all values.
    let mut block = [&[0, 0][..], &(SET_BYTES as u16 - 1).to_le_bytes()].concat();
    block.resize(block.len() + SET_BYTES, u8::MAX);
    block.extend((codes.len() as u32).to_le_bytes());
    block.extend(codes);
    if block.len() == 2 * count {
        // That long it would be taken for what is not packed.
        block.push(0);
    }
    let line = IntegerBounds::new(Vec2(0, 0), Vec2(count, 1));
    let bytes = guard::run(DAMAGED, || {
        Compression::PIZ.decompress_image_section_from_le(&header, block, line, false).ok()
    });
    let bytes = bytes.ok().flatten().filter(|bytes| bytes.len() == 2 * count).ok_or(DAMAGED)?;
    Ok(bytes.as_chunks().0.iter().map(|word| u16::from_ne_bytes(*word)).collect())
}

/// Undoes the wavelets of one of the words that values are made of, from the coarsest on.
fn undo_wavelets(values: &mut [u16], plane: Plane, word: usize, is_narrow: bool) {
    let Plane { width, height, words } = plane;
    let undo = if is_narrow { undo_14_bits } else { undo_16_bits };
    let place = |x: usize, y: usize| (y * width + x) * words + word;
    let mut pair = |a: usize, b: usize| (values[a], values[b]) = undo(values[a], values[b]);
    let Some(largest) = width.min(height).checked_ilog2() else { return };
    for level in (0..largest).rev() {
        let (step, half) = (2_usize << level, 1_usize << level);
        let (columns, rows) = (width / step * step, height / step * step);
        for y in (0..rows).step_by(step) {
            for x in (0..columns).step_by(step) {
                let [here, right] = [place(x, y), place(x + half, y)];
                let [below, across] = [place(x, y + half), place(x + half, y + half)];
                pair(here, below);
                pair(right, across);
                pair(here, right);
                pair(below, across);
            }
            if width & half != 0 {
                pair(place(columns, y), place(columns, y + half));
            }
        }
        if height & half != 0 {
            for x in (0..columns).step_by(step) {
                pair(place(x, rows), place(x + half, rows));
            }
        }
    }
}

/// Two numbers of less than 14 bits from their mean and their difference.
fn undo_14_bits(mean: u16, difference: u16) -> (u16, u16) {
    let (mean, difference) = (i32::from(mean as i16), i32::from(difference as i16));
    let first = mean + (difference & 1) + (difference >> 1);
    (first as u16, (first - difference) as u16)
}

/// Two of 16 bits, by arithmetic that goes round.
fn undo_16_bits(mean: u16, difference: u16) -> (u16, u16) {
    let second = mean.wrapping_sub(difference >> 1);
    (difference.wrapping_add(second).wrapping_sub(1 << 15), second)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes of one block of lines, as the crate packs and as it is made of, for channels of
    /// one size.
    fn packed(planes: &[(SampleType, Vec<u16>)], width: usize, height: usize) -> Vec<u8> {
        let names = ["A", "B", "C"];
        let channels = planes
            .iter()
            .zip(names)
            .map(|((kind, _), name)| ChannelDescription::new(Text::from(name), *kind, false));
        let header = Header {
            compression: Compression::PIZ,
            blocks: BlockDescription::ScanLines,
            ..Header::new(Text::from(""), Vec2(width, height), channels.collect())
        };
        let mut bytes = Vec::new();
        for y in 0..height {
            for (_, words) in planes {
                let line = words.len() / height;
                bytes.extend(words[y * line..][..line].iter().flat_map(|it| it.to_ne_bytes()));
            }
        }
        let section = IntegerBounds::new(Vec2(0, 0), Vec2(width, height));
        Compression::PIZ.compress_image_section_to_le(&header, bytes, section).expect("is packed")
    }

    #[test]
    fn blocks_of_the_crate_are_unpacked_as_they_were() {
        // Few values, which take 14 bits, and many.
        for (width, height, slope) in [(13, 31, 1), (40, 17, 3), (200, 1, 1), (1000, 31, 40)] {
            let words = |count: usize| -> Vec<u16> {
                let at = |at: usize| {
                    let (x, y) = (at / count % width, at / count / width);
                    let noise = (at as u32).wrapping_mul(2_654_435_761) >> 30;
                    (x * slope + y) as u16 + noise as u16
                };
                (0..count * width * height).map(at).collect()
            };
            let planes = [(SampleType::F16, words(1)), (SampleType::F32, words(2))];
            let block = packed(&planes, width, height);
            let expected = [&planes[0].1[..], &planes[1].1].concat();
            assert!(block.len() < 2 * expected.len(), "it is packed");
            let [narrow, wide] = [1, 2].map(|words| Plane { width, height, words });
            let found = unpack(&block, &[narrow, wide]).expect("it is sound");
            assert!(found == expected, "{width} {height} {slope}");
        }
    }

    #[test]
    fn damaged_blocks_are_refused_or_read() {
        let values = (0..63).map(|at| at * 3 % 17).collect();
        let block = packed(&[(SampleType::F16, values)], 9, 7);
        let plane = Plane { width: 9, height: 7, words: 1 };
        for end in 0..block.len() {
            let _ = unpack(&block[..end], &[plane]);
        }
        assert!(unpack(&block[..20], &[plane]).is_err());
        for at in 0..block.len() {
            for flip in [1, 0x10, 0x80, 0xff] {
                let mut damaged = block.clone();
                damaged[at] ^= flip;
                let _ = unpack(&damaged, &[plane]);
            }
        }
        assert!(unpack(&[0xff; 64], &[plane]).is_err());
    }
}
