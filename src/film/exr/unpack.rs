//! Blocks of lines of OpenEXR files, unpacked, whose channels may have fewer values than there are
//! pixels.

use std::io::Read;
use std::ops::Range;

use ::exr::compression::Compression;
use flate2::read::ZlibDecoder;

use super::piz;
use super::plane::Plane;

/// Unpacks a block of some lines, which has so many bytes then; none if it is damaged.
pub(super) type Unpack = fn(&[u8], &[Plane], Range<i64>, usize) -> Option<Vec<u8>>;

/// What unpacks blocks that are packed.
///
/// # Errors
/// That such are not supported.
pub(super) fn unpacker(compression: Compression) -> Result<Unpack, String> {
    Ok(match compression {
        // Those of full length are as they are.
        Compression::Uncompressed => |_, _, _, _| None,
        Compression::RLE => |packed, _, _, size| join(unpack_runs(packed, size)?, size),
        Compression::ZIP1 | Compression::ZIP16 => |packed, _, _, size| {
            let mut plain = Vec::new();
            ZlibDecoder::new(packed).take(size as u64).read_to_end(&mut plain).ok()?;
            join(plain, size)
        },
        Compression::PIZ => |packed, planes, rows, _| unpack_piz(packed, planes, rows),
        other => {
            return Err(format!(
                "{other} of channels with fewer values than pixels is not supported; convert the \
                 file to ZIP or PIZ, or to R, G and B"
            ));
        }
    })
}

/// Bytes from their differences, whose two halves come between one another.
fn join(mut plain: Vec<u8>, size: usize) -> Option<Vec<u8>> {
    if plain.len() != size {
        return None;
    }
    for at in 1..size {
        plain[at] = plain[at - 1].wrapping_add(plain[at]).wrapping_sub(128);
    }
    let (even, odd) = plain.split_at(size.div_ceil(2));
    Some((0..size).map(|at| if at % 2 == 0 { even[at / 2] } else { odd[at / 2] }).collect())
}

/// A count below zero is followed by so many bytes, any other by one that comes once more than it
/// says.
fn unpack_runs(mut packed: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut plain = Vec::new();
    while let Some((&count, rest)) = packed.split_first() {
        let count = count as i8;
        let taken = if count < 0 { usize::from(count.unsigned_abs()) } else { 1 };
        let (bytes, after) = rest.split_at_checked(taken)?;
        let times = if count < 0 { 1 } else { usize::from(count.unsigned_abs()) + 1 };
        if plain.len() + taken * times > size {
            return None;
        }
        plain.extend(bytes.iter().cycle().take(taken * times));
        packed = after;
    }
    Some(plain)
}

/// Puts the channels, which come one after the other there, line by line.
fn unpack_piz(packed: &[u8], planes: &[Plane], rows: Range<i64>) -> Option<Vec<u8>> {
    let in_block = |plane: &Plane| piz::Plane {
        width: plane.size[0],
        height: rows.clone().filter(|&y| plane.line_bytes(y) > 0).count(),
        words: plane.kind.bytes_per_sample() / 2,
    };
    let shapes: Vec<piz::Plane> = planes.iter().map(in_block).collect();
    let words = piz::unpack(packed, &shapes).ok()?;
    let mut rest = &words[..];
    let mut channels = Vec::new();
    for shape in &shapes {
        let (channel, after) = rest.split_at(shape.width * shape.height * shape.words);
        channels.push(channel);
        rest = after;
    }
    let mut bytes = Vec::with_capacity(2 * words.len());
    for y in rows {
        for (plane, channel) in planes.iter().zip(&mut channels) {
            let (line, after) = channel.split_at(plane.line_bytes(y) / 2);
            bytes.extend(line.iter().flat_map(|word| word.to_le_bytes()));
            *channel = after;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_as_long_as_they_say() {
        let packed = [2, 7, 0xfe, 1, 2, 0, 9];
        assert_eq!(unpack_runs(&packed, 6), Some(vec![7, 7, 7, 1, 2, 9]));
        assert_eq!(unpack_runs(&packed, 5), None, "is too long");
        for end in [1, 3, 4, 6] {
            assert_eq!(unpack_runs(&packed[..end], 6), None, "{end}");
        }
        assert_eq!(unpack_runs(&[0x80; 100], 1000), None);
    }
}
