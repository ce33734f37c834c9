//! KTX 2.0 files with texels of Basis Universal: ETC1S, and UASTC with or without Zstandard.
//!
//! The container is read and checked here (KTX File Format 2.0, 3). A transcoder by others then
//! gets for each level that is used a file of this one alone, made anew of what was checked, so
//! that no offset or length of the original reaches it.

use std::ops::Range;
use std::sync::Arc;

use basisu::{DecodeFlags, TargetFormat, Transcoder};

use super::image::{FileLevels, Image};
use super::ktx2_keys;
use super::zstandard;
use crate::files::{guard, memory};

/// The first bytes.
const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Bytes before the list of levels, and of an entry of that list.
const HEADER: usize = 80;
const LEVEL_ENTRY: usize = 24;

/// Colour models of the data format descriptor (Khronos Data Format 1.4, 5.6).
const MODEL_ETC1S: u32 = 163;
const MODEL_UASTC: u32 = 166;

/// Bytes of a block of four by four texels of UASTC.
const UASTC_BLOCK: u64 = 16;

/// Blocks of ETC1S that a level may always have, and beyond them for each byte: runs of the same
/// are short, and whole pictures of one colour are small.
const FREE_BLOCKS: u64 = 1 << 20;
const BLOCKS_PER_BYTE: u64 = 1 << 13;

/// Whether a file begins as all KTX 2.0 files do.
pub fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// How the bytes of levels are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    /// Not at all.
    None,
    /// Endpoints and selectors of ETC1S, which all levels share, are elsewhere.
    BasisLz,
    /// Each level by itself.
    Zstandard,
}

/// A level of the pyramid.
#[derive(Clone, Copy, Debug)]
struct Level<'a> {
    /// 0: the image itself.
    number: u32,
    width: u32,
    height: u32,
    bytes: &'a [u8],
    /// Bytes once they are unpacked, as the file says.
    unpacked: u64,
}

impl Level<'_> {
    /// Blocks of four by four texels.
    fn blocks(&self) -> u64 {
        u64::from(self.width.div_ceil(4)) * u64::from(self.height.div_ceil(4))
    }

    /// Bytes of its texels.
    fn texel_bytes(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height) * 4
    }
}

/// A file whose container was checked, but for its levels.
struct Container<'a> {
    bytes: &'a [u8],
    packing: Packing,
    /// What tells the kind of texels, as it is in the file.
    descriptor: &'a [u8],
    /// Keys and values.
    keys: &'a [u8],
    /// What levels share, for ETC1S.
    shared: &'a [u8],
    /// Texels of the image itself.
    size: [u32; 2],
    /// How many levels there are.
    levels: u32,
    /// Which of them stands for the image: the first whose sides are within the limit.
    first: u32,
}

/// Decodes the first level of at most `max_size` texels a side, with `levels` also those below, and
/// says what is odd about them. A level that cannot be used ends them.
///
/// # Errors
/// What is wrong with the first, or that there is no memory for it.
pub fn decode(
    bytes: &[u8],
    max_size: u32,
    levels: FileLevels,
) -> Result<(Image, Vec<String>), String> {
    let container = Container::read(bytes, max_size)?;
    let first = container.level(container.first)?;
    // The texels twice, as bytes and as texels, and of each block its indices or its bytes.
    let claimed = first.texel_bytes() + first.blocks() * UASTC_BLOCK + bytes.len() as u64;
    let claimed = claimed + container.texel_bytes(levels);
    memory::claim(claimed).map_err(|error| error.to_string())?;
    let image = container.decode(first)?;
    let mut notes = ktx2_keys::notes(container.keys);
    if first.number > 0 {
        let Level { number, width, height, .. } = first;
        notes.push(format!(
            "has more than {max_size} texels a side: its level {number}, of {width} by {height}, \
             is used"
        ));
    }
    let mut below = Vec::new();
    for number in container.below(levels) {
        match container.level(number).and_then(|level| container.decode(level)) {
            Ok(image) => below.push(Arc::new(image)),
            Err(reason) => {
                notes.push(format!(
                    "has a level {number} that cannot be used ({reason}): it and those below are \
                     made from the one before"
                ));
                break;
            }
        }
    }
    Ok((image.with_file_levels(below), notes))
}

/// The memory that the texels take of the levels that [`decode`] decodes.
///
/// # Errors
/// As [`decode`], as far as the container tells.
pub fn decoded_bytes(bytes: &[u8], max_size: u32, levels: FileLevels) -> Result<u64, String> {
    let container = Container::read(bytes, max_size)?;
    container.level(container.first)?;
    Ok(container.texel_bytes(levels))
}

impl<'a> Container<'a> {
    fn read(bytes: &'a [u8], max_size: u32) -> Result<Self, String> {
        if bytes.len() < HEADER || !is_ktx2(bytes) {
            return Err("the file ends in its header".to_owned());
        }
        let field = |at: usize| word(bytes, at).unwrap_or(0);
        if field(12) != 0 {
            return Err("its texels are not those of Basis Universal (ETC1S or UASTC)".to_owned());
        }
        let size = [field(20), field(24)];
        let [width, height] = size;
        if width == 0 || height == 0 || field(28) != 0 || field(32) > 1 || field(36) != 1 {
            return Err("is not one flat image".to_owned());
        }
        let packing = match field(44) {
            0 => Packing::None,
            1 => Packing::BasisLz,
            2 => Packing::Zstandard,
            other => return Err(format!("its levels are packed in an unknown way ({other})")),
        };
        let levels = field(40).max(1);
        if levels > 32 - width.max(height).leading_zeros() {
            return Err(format!("has {levels} levels, more than its size allows"));
        }
        let within = |&number: &u32| (width.max(height) >> number) <= max_size;
        let first = (0..levels).find(within).ok_or_else(|| {
            format!("{width} by {height} texels are too many: at most {max_size} a side")
        })?;
        let long = |at: usize| long_word(bytes, at).unwrap_or(0);
        let descriptor = range(bytes, field(48).into(), field(52).into(), "format descriptor")?;
        let keys = range(bytes, field(56).into(), field(60).into(), "list of keys and values")?;
        let shared = range(bytes, long(64), long(72), "data that levels share")?;
        Ok(Self { bytes, packing, descriptor, keys, shared, size, levels, first })
    }

    /// Columns and rows of a level.
    fn level_size(&self, number: u32) -> [u32; 2] {
        self.size.map(|side| (side >> number).max(1))
    }

    /// The numbers of the levels below the first that is used, if they are asked for.
    fn below(&self, levels: FileLevels) -> Range<u32> {
        match levels {
            FileLevels::First => 0..0,
            FileLevels::All => self.first + 1..self.levels,
        }
    }

    /// Bytes of the texels of the levels that are used.
    fn texel_bytes(&self, levels: FileLevels) -> u64 {
        let bytes = |number| {
            let [width, height] = self.level_size(number);
            u64::from(width) * u64::from(height) * 4
        };
        bytes(self.first) + self.below(levels).map(bytes).sum::<u64>()
    }

    /// A level, checked.
    fn level(&self, number: u32) -> Result<Level<'a>, String> {
        let entry = HEADER + LEVEL_ENTRY * number as usize;
        let ends = || "the file ends in its list of levels".to_owned();
        let long = |at: usize| long_word(self.bytes, at).ok_or_else(ends);
        let (offset, length, unpacked) = (long(entry)?, long(entry + 8)?, long(entry + 16)?);
        let [width, height] = self.level_size(number);
        let bytes = range(self.bytes, offset, length, "level")?;
        let level = Level { number, width, height, bytes, unpacked };
        self.check_model(level)?;
        Ok(level)
    }

    /// The texels of a level.
    fn decode(&self, level: Level) -> Result<Image, String> {
        let single = self.single_level(level)?;
        let texels = guard::run("its texels cannot be decoded", || {
            let transcoder = Transcoder::new(&single).ok()?;
            transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).ok()
        })?;
        let texels = texels.ok_or("its texels cannot be decoded: they are damaged")?;
        let texels: Vec<[u8; 4]> = texels.as_chunks::<4>().0.to_vec();
        if texels.len() as u64 * 4 != level.texel_bytes() {
            return Err("its texels cannot be decoded: some are missing".to_owned());
        }
        Ok(Image::of(level.width, level.height, texels))
    }

    /// Whether kind of texels, packing and lengths go together.
    fn check_model(&self, level: Level) -> Result<(), String> {
        let model = word(self.descriptor, 12).ok_or("its format descriptor is cut")? & 0xff;
        let needed = level.blocks() * UASTC_BLOCK;
        let there = match (model, self.packing) {
            (MODEL_ETC1S, Packing::BasisLz) => return Self::check_expansion(level),
            (MODEL_UASTC, Packing::None) => level.bytes.len() as u64,
            (MODEL_UASTC, Packing::Zstandard) => level.unpacked,
            (MODEL_ETC1S | MODEL_UASTC, _) => {
                return Err("its texels are packed in a way that they cannot be".to_owned());
            }
            _ => {
                let message = "its texels are not those of Basis Universal (ETC1S or UASTC)";
                return Err(message.to_owned());
            }
        };
        if there != needed {
            return Err(format!("its level holds {there} bytes and needs {needed}"));
        }
        Ok(())
    }

    /// The decoder goes on after the end of a level as if there were zeros: a few bytes must not
    /// ask for a gigabyte.
    fn check_expansion(level: Level) -> Result<(), String> {
        let (blocks, bytes) = (level.blocks(), level.bytes.len() as u64);
        if blocks > FREE_BLOCKS && blocks > bytes.saturating_mul(BLOCKS_PER_BYTE) {
            return Err(format!("{blocks} blocks cannot come out of {bytes} bytes"));
        }
        Ok(())
    }

    /// A file of the level alone, without Zstandard.
    fn single_level(&self, level: Level) -> Result<Vec<u8>, String> {
        let unpacked = match self.packing {
            Packing::Zstandard => Some(zstandard::unpack(level.bytes, level.unpacked)?),
            Packing::None | Packing::BasisLz => None,
        };
        let texels = unpacked.as_deref().unwrap_or(level.bytes);
        let (shared, scheme) = match self.packing {
            Packing::BasisLz => (self.shared_of_level(level)?, 1_u32),
            Packing::None | Packing::Zstandard => (Vec::new(), 0),
        };
        let descriptor_at = HEADER + LEVEL_ENTRY;
        let shared_at = descriptor_at + self.descriptor.len();
        let texels_at = shared_at + shared.len();
        let mut file = MAGIC.to_vec();
        // No format of Vulkan's, one byte a number, the size, one layer, one face, one level.
        let Level { width, height, .. } = level;
        let descriptor_length = self.descriptor.len() as u32;
        let words = [
            0,
            1,
            width,
            height,
            0,
            0,
            1,
            1,
            scheme,
            descriptor_at as u32,
            descriptor_length,
            0,
            0,
        ];
        file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
        let unpacked_length = if scheme == 1 { 0 } else { texels.len() };
        let longs = [shared_at, shared.len(), texels_at, texels.len(), unpacked_length];
        file.extend(longs.iter().flat_map(|&long| (long as u64).to_le_bytes()));
        file.extend(self.descriptor);
        file.extend(&shared);
        file.extend(texels);
        Ok(file)
    }

    /// What levels of ETC1S share, with the description of the one level alone (3.12.2).
    fn shared_of_level(&self, level: Level) -> Result<Vec<u8>, String> {
        const HEAD: usize = 20;
        const DESCRIPTION: usize = 20;
        let cut = || "the data that its levels share are cut".to_owned();
        let head = self.shared.get(..HEAD).ok_or_else(cut)?;
        let described = HEAD + DESCRIPTION * level.number as usize;
        let description = self.shared.get(described..described + DESCRIPTION).ok_or_else(cut)?;
        let tables = HEAD + DESCRIPTION * self.levels as usize;
        let tables = self.shared.get(tables..).ok_or_else(cut)?;
        let lengths = [4, 8, 12].map(|at| u64::from(word(head, at).unwrap_or(0)));
        if lengths.iter().sum::<u64>() > tables.len() as u64 {
            return Err(cut());
        }
        for at in [4, 12] {
            let part = [at, at + 4].map(|at| u64::from(word(description, at).unwrap_or(0)));
            if part[0] + part[1] > level.bytes.len() as u64 {
                return Err("its level is cut".to_owned());
            }
        }
        Ok([head, description, tables].concat())
    }
}

/// The little-endian number at a place.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

fn long_word(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// A part of the file, called `what`.
fn range<'a>(bytes: &'a [u8], offset: u64, length: u64, what: &str) -> Result<&'a [u8], String> {
    let end = offset.checked_add(length).filter(|&end| end <= bytes.len() as u64);
    let end = end.ok_or_else(|| format!("its {what} is past the end of the file"))?;
    Ok(&bytes[offset as usize..end as usize])
}
