//! OpenEXR files in which channels have fewer values than there are pixels, as chroma often has;
//! the crate `exr` refuses them.
//!
//! One part of scanlines, without compression or with RLE, ZIP or PIZ. Between the values of a
//! channel that are there, others are interpolated linearly. OpenEXR's own library smooths over 27
//! values, which differs at edges alone.

use std::io::{Read, Seek, SeekFrom};

use ::exr::math::Vec2;
use ::exr::meta::attribute::ChannelDescription;
use ::exr::meta::header::Header;
use ::exr::meta::{BlockDescription, MetaData};

use super::plane::Plane;
use super::unpack::unpacker;
use crate::film::Window;

/// A file's only part, and where its pixels begin.
pub(super) struct Part {
    pub header: Header,
    /// Of the table of blocks.
    start: u64,
}

/// The part of a file that has such channels; none if it has not, or is not sound.
pub(super) fn find(source: &mut (impl Read + Seek)) -> Option<Part> {
    let mut counted = Counted { source, count: 0 };
    let meta = MetaData::read_from_buffered(&mut counted, false).ok()?;
    let start = counted.count;
    let [header] = &meta.headers[..] else { return None };
    let is_full = |channel: &ChannelDescription| channel.sampling == Vec2(1, 1);
    let has = !header.channels.list.iter().all(is_full);
    let is_plain = !header.deep && header.blocks == BlockDescription::ScanLines;
    (has && is_plain).then(|| Part { header: header.clone(), start })
}

struct Counted<'a, R> {
    source: &'a mut R,
    count: u64,
}

impl<R: Read> Read for Counted<'_, R> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.source.read(bytes)?;
        self.count += count as u64;
        Ok(count)
    }
}

impl Part {
    /// The wanted channels in full size, in the header's order, of a file of `length` bytes.
    /// Callers have checked the picture's size.
    ///
    /// # Errors
    /// What is damaged or not supported.
    pub fn read(
        &self,
        source: &mut (impl Read + Seek),
        length: u64,
        crop: Window,
        wanted: impl Fn(&str) -> bool,
    ) -> Result<Vec<Option<Vec<f32>>>, String> {
        let Header { compression, channels, .. } = &self.header;
        let unpack = unpacker(*compression)?;
        let planes = channels
            .list
            .iter()
            .map(|channel| Plane::new(channel, crop, wanted(&channel.name.to_string())));
        let mut planes: Vec<Plane> = planes.collect::<Result<_, _>>()?;
        let lines = compression.scan_lines_per_block();
        let cut = |error: std::io::Error| format!("cut short: {error}");
        let count = crop.height().div_ceil(lines);
        if count as u64 > length / 8 {
            return Err(format!("cut short: {count} blocks in a file of {length} bytes"));
        }
        let mut table = vec![0; 8 * count];
        source.seek(SeekFrom::Start(self.start)).map_err(cut)?;
        source.read_exact(&mut table).map_err(cut)?;
        for (top, offset) in (crop.y0..crop.y1).step_by(lines).zip(table.as_chunks().0) {
            source.seek(SeekFrom::Start(u64::from_le_bytes(*offset))).map_err(cut)?;
            let bottom = i64::from(crop.y1).min(i64::from(top) + lines as i64);
            let rows = i64::from(top)..bottom;
            let of_line = |y: i64| planes.iter().map(|plane| plane.line_bytes(y)).sum::<usize>();
            let size = rows.clone().map(of_line).sum();
            let damaged = || format!("damaged: the block at line {top} cannot be decompressed");
            let block = match read_block(source, top, size)? {
                plain if plain.len() == size => plain,
                packed => unpack(&packed, &planes, rows.clone(), size).ok_or_else(damaged)?,
            };
            let mut rest = &block[..];
            for y in rows {
                for plane in &mut planes {
                    let (line, after) = rest.split_at(plane.line_bytes(y));
                    rest = after;
                    plane.push(line);
                }
            }
        }
        Ok(planes.into_iter().map(|plane| plane.enlarge(crop)).collect())
    }
}

/// The bytes of a block as they are in the file, of which there are `size` once they are
/// decompressed.
fn read_block(source: &mut impl Read, top: i32, size: usize) -> Result<Vec<u8>, String> {
    let cut = |error: std::io::Error| format!("cut short: {error}");
    let mut head = [[0; 4]; 2];
    source.read_exact(head.as_flattened_mut()).map_err(cut)?;
    let [y, packed] = head.map(i32::from_le_bytes);
    let packed = usize::try_from(packed).ok().filter(|&packed| packed <= size && y == top);
    let packed = packed.ok_or_else(|| format!("damaged: the block at line {top} is not there"))?;
    let mut bytes = vec![0; packed];
    source.read_exact(&mut bytes).map_err(cut)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Write};
    use std::path::Path;

    use flate2::Compression as Level;
    use flate2::write::ZlibEncoder;

    use super::super::decode;

    /// A file of 4 by 4 pixels from (2, -2) on, whose `RY` and `BY` have one value for 2 by 2.
    fn file(compression: u8, values: &[[f32; 16]; 3]) -> Vec<u8> {
        let mut bytes = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
        let mut attribute = |name: &str, kind: &str, value: &[u8]| {
            bytes.extend(format!("{name}\0{kind}\0").as_bytes());
            bytes.extend((value.len() as u32).to_le_bytes());
            bytes.extend(value);
        };
        let mut channels = Vec::new();
        for (name, step) in [("BY", 2_u32), ("RY", 2), ("Y", 1)] {
            channels.extend(format!("{name}\0").as_bytes());
            channels.extend([2_u32, 0, step, step].iter().flat_map(|it| it.to_le_bytes()));
        }
        channels.push(0);
        let window: Vec<u8> = [2_i32, -2, 5, 1].iter().flat_map(|it| it.to_le_bytes()).collect();
        attribute("channels", "chlist", &channels);
        attribute("compression", "compression", &[compression]);
        attribute("dataWindow", "box2i", &window);
        attribute("displayWindow", "box2i", &window);
        attribute("lineOrder", "lineOrder", &[0]);
        attribute("pixelAspectRatio", "float", &1.0_f32.to_le_bytes());
        attribute("screenWindowCenter", "v2f", &[0; 8]);
        attribute("screenWindowWidth", "float", &1.0_f32.to_le_bytes());
        bytes.push(0);
        // Lines in blocks: one each, or all in one.
        let lines: Vec<Vec<u8>> = (0..4)
            .map(|y| {
                let row = |k: usize, step: usize| {
                    let row = values[k][4 * y..4 * y + 4].iter().step_by(step);
                    row.flat_map(|it| it.to_le_bytes()).collect::<Vec<u8>>()
                };
                let chroma = |k| if y % 2 == 0 { row(k, 2) } else { Vec::new() };
                [chroma(0), chroma(1), row(2, 1)].concat()
            })
            .collect();
        let blocks = if compression == 3 { vec![pack(&lines.concat())] } else { lines };
        let mut offset = bytes.len() + 8 * blocks.len();
        for block in &blocks {
            bytes.extend((offset as u64).to_le_bytes());
            offset += 8 + block.len();
        }
        for (k, block) in blocks.iter().enumerate() {
            bytes.extend((k as i32 - 2).to_le_bytes());
            bytes.extend((block.len() as u32).to_le_bytes());
            bytes.extend(block);
        }
        bytes
    }

    /// As ZIP has it.
    fn pack(plain: &[u8]) -> Vec<u8> {
        let even = plain.iter().step_by(2);
        let mut halves: Vec<u8> = even.chain(plain.iter().skip(1).step_by(2)).copied().collect();
        for at in (1..halves.len()).rev() {
            halves[at] = halves[at].wrapping_sub(halves[at - 1]).wrapping_add(128);
        }
        let mut encoder = ZlibEncoder::new(Vec::new(), Level::best());
        encoder.write_all(&halves).expect("memory is there");
        encoder.finish().expect("memory is there")
    }

    fn colours(bytes: &[u8]) -> Result<Vec<[f32; 3]>, String> {
        let path = Path::new("a.exr");
        let picture = decode(bytes, path).map_err(|error| error.to_string())?;
        picture.rgb(path).map_err(|error| error.to_string())
    }

    #[test]
    fn chroma_of_fewer_values_is_colour() {
        let y = 0.2126 * 2.0 + 0.7152 + 0.0722 * 0.25;
        let values = [[(0.25 - y) / y; 16], [(2.0 - y) / y; 16], [y; 16]];
        for compression in [0, 3] {
            for [r, g, b] in colours(&file(compression, &values)).expect("it is sound") {
                let off = (r - 2.0).abs().max((g - 1.0).abs()).max((b - 0.25).abs());
                assert!(off < 1e-3, "{r} {g} {b}");
            }
        }
    }

    /// The same pixels as OpenEXR's own library packs them.
    #[test]
    fn packed_files_hold_the_same_as_one_another() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/image");
        let read = |name: &str| {
            let bytes = std::fs::read(folder.join(name)).expect("is part of the project");
            colours(&bytes).expect(name)
        };
        let plain = read("ok-chroma-plain.exr");
        assert_eq!(plain.len(), 20 * 12);
        // Its first value of luminance is .25, its chroma -.25 and .125.
        let [r, g, b] = plain[0];
        let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        assert!((luminance - 0.25).abs() < 1e-4, "{luminance}");
        assert!((r - 0.1875).abs() < 1e-4 && (b - 0.28125).abs() < 1e-4, "{r} {b}");
        for name in ["ok-chroma-piz.exr", "ok-chroma-rle.exr", "ok-chroma-zip.exr"] {
            assert!(read(name) == plain, "{name}");
        }
    }

    #[test]
    fn between_values_they_are_interpolated() {
        let mut values = [[0.0; 16]; 3];
        // Those at the even places of each line and column are there.
        values[1] = std::array::from_fn(|at| (at % 4) as f32 + 10.0 * (at / 4) as f32);
        let bytes = file(0, &values);
        let cursor = Cursor::new(&bytes);
        let (picture, _) =
            super::super::read::decode_channels(cursor, bytes.len() as u64, Path::new("a"), |_| {
                true
            })
            .expect("it is sound");
        let found = picture.channel("RY").expect("it is there");
        // Beyond the last value it counts on.
        let lines = [0.0, 10.0, 20.0, 20.0];
        let expected: Vec<f32> =
            lines.iter().flat_map(|y| [0.0, 1.0, 2.0, 2.0].map(|x| x + y)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn what_is_cut_or_damaged_or_unknown_is_an_error() {
        let values = [[0.5; 16]; 3];
        for compression in [0, 3] {
            let bytes = file(compression, &values);
            for length in 0..bytes.len() {
                let error = colours(&bytes[..length]).expect_err("it is cut");
                assert!(error.starts_with("a.exr: "), "{error}");
            }
            for at in 0..bytes.len() {
                for flip in [1, 0x80, 0xff] {
                    let mut bytes = bytes.clone();
                    bytes[at] ^= flip;
                    let _ = colours(&bytes);
                }
            }
        }
        let error = colours(&file(5, &values)).expect_err("PXR24");
        assert!(error.contains("a.exr: pxr24 compression of channels with fewer"), "{error}");
    }
}
