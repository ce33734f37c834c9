//! The file around tiles.
//!
//! A line of text that names the format; chunks of a kind (four letters), a length, the bytes, and
//! a checksum (CRC-32) over all three; last, where the index begins. All integers are little
//! endian.
//! The chunks are `HEAD` (JSON), one `TILE` for each tile of the crop in their order, and `INDX`:
//! where each tile begins, its samples, whether it is finished and how many were lost. There is no
//! byte that is not checked.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;

/// What a part begins with.
pub const FORMAT: &[u8; 14] = b"dapple part 2\n";

/// Bytes of a chunk before and after its contents.
const FRAME: u64 = 4 + 8 + 4;

/// Bytes of the last entry: where the index begins, its checksum, and an end mark.
pub const TRAILER: u64 = 8 + 4 + 4;

/// What a part ends with.
const END: &[u8; 4] = b"end\n";

/// A kind of chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind(pub [u8; 4]);

/// What the samples belong to.
pub const HEAD: Kind = Kind(*b"HEAD");
/// Sums of a tile.
pub const TILE: Kind = Kind(*b"TILE");
/// Where the tiles are.
pub const INDEX: Kind = Kind(*b"INDX");

/// An entry of the index.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Where its chunk begins.
    pub offset: u64,
    /// The samples of each pixel.
    pub range: Range<u64>,
    /// Whether it takes no more.
    pub finished: bool,
    /// Samples that were not finite.
    pub lost_count: u64,
}

impl Entry {
    /// Bytes of an entry.
    pub const BYTES: usize = 33;

    /// Its bytes.
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let numbers = [self.offset, self.range.start, self.range.end, self.lost_count];
        for (place, number) in bytes.chunks_exact_mut(8).zip(numbers) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        bytes[32] = self.finished.into();
        bytes
    }

    /// Whether there are such samples.
    pub fn has_samples(&self) -> bool {
        let Range { start, end } = self.range;
        start <= end && end <= 1 << 32 && start.is_multiple_of(16)
    }

    /// An entry from its bytes.
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes"));
        let (range, lost_count) = (number(8)..number(16), number(24));
        Self { offset: number(0), range, finished: bytes[32] != 0, lost_count }
    }
}

/// Writes a chunk; returns how many bytes it takes.
///
/// # Errors
/// Those of `out`.
pub fn write_chunk(out: &mut impl Write, kind: Kind, contents: &[u8]) -> io::Result<u64> {
    let length = (contents.len() as u64).to_le_bytes();
    out.write_all(&kind.0)?;
    out.write_all(&length)?;
    out.write_all(contents)?;
    out.write_all(&checksum(kind, contents).to_le_bytes())?;
    Ok(contents.len() as u64 + FRAME)
}

/// Writes the end of a file whose index begins at `index`.
///
/// # Errors
/// Those of `out`.
pub fn write_trailer(out: &mut impl Write, index: u64) -> io::Result<()> {
    let bytes = index.to_le_bytes();
    out.write_all(&bytes)?;
    out.write_all(&crc32fast::hash(&bytes).to_le_bytes())?;
    out.write_all(END)
}

/// Reads the end of a file of some length: where the index begins.
///
/// # Errors
/// What is wrong with it.
pub fn read_trailer(file: &mut (impl Read + Seek + ?Sized), length: u64) -> Result<u64, String> {
    let at = length.checked_sub(TRAILER).ok_or("the file is cut short")?;
    let mut bytes = [0; TRAILER as usize];
    read_at(file, at, &mut bytes)?;
    let (index, rest) = bytes.split_at(8);
    let is_whole = rest[..4] == crc32fast::hash(index).to_le_bytes() && rest[4..] == *END;
    if !is_whole {
        return Err("the file is cut short, or its last bytes are others".to_owned());
    }
    Ok(u64::from_le_bytes(index.try_into().expect("8 bytes")))
}

/// Reads the contents of the chunk of a kind that fills a range of the file.
///
/// # Errors
/// What is wrong with it.
pub fn read_chunk(
    file: &mut (impl Read + Seek + ?Sized),
    kind: Kind,
    range: Range<u64>,
) -> Result<Vec<u8>, String> {
    let length = range.end.checked_sub(range.start).and_then(|bytes| bytes.checked_sub(FRAME));
    let length = length.ok_or("has no room")?;
    let mut frame = [0; 12];
    read_at(file, range.start, &mut frame)?;
    if frame[..4] != kind.0 || frame[4..] != length.to_le_bytes() {
        return Err("is not where the index says".to_owned());
    }
    let mut contents = Vec::new();
    let bytes = usize::try_from(length).map_err(|error| error.to_string())?;
    contents.try_reserve_exact(bytes).map_err(|error| error.to_string())?;
    contents.resize(bytes, 0);
    let mut sum = [0; 4];
    file.read_exact(&mut contents)
        .and_then(|()| file.read_exact(&mut sum))
        .map_err(|error| say(&error))?;
    if u32::from_le_bytes(sum) != checksum(kind, &contents) {
        return Err("its checksum is another".to_owned());
    }
    Ok(contents)
}

/// Reads the length of the chunk at a place: all of it, with its frame.
///
/// # Errors
/// What the system says.
pub fn chunk_length(file: &mut (impl Read + Seek + ?Sized), at: u64) -> Result<u64, String> {
    let mut frame = [0; 12];
    read_at(file, at, &mut frame)?;
    let length = u64::from_le_bytes(frame[4..].try_into().expect("8 bytes"));
    length.checked_add(FRAME).ok_or_else(|| "is longer than the file".to_owned())
}

fn read_at(
    file: &mut (impl Read + Seek + ?Sized),
    at: u64,
    bytes: &mut [u8],
) -> Result<(), String> {
    file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(bytes)).map_err(|error| say(&error))
}

fn say(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::UnexpectedEof => "the file is cut short".to_owned(),
        _ => error.to_string(),
    }
}

fn checksum(kind: Kind, contents: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(&kind.0);
    hasher.update(&(contents.len() as u64).to_le_bytes());
    hasher.update(contents);
    hasher.finalize()
}
