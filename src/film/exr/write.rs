//! Pictures to OpenEXR files.
//!
//! Crate `exr` compresses the blocks and spells the attributes; the file is put together here,
//! because the crate keeps custom attributes in a hash map and would write them in another order
//! each time. Ours are sorted, so that one picture is one sequence of bytes.

use crate::files::{self, Flush};
use crate::film::{FilmError, Picture, Window};
use ::exr::block::chunk::Chunk;
use ::exr::block::lines::LineRefMut;
use ::exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::attribute::{
    self, AttributeValue, ChannelDescription, Chromaticities, IntegerBounds, LineOrder, SampleType,
    Text,
};
use ::exr::meta::header::{Header, ImageAttributes, LayerAttributes};
use ::exr::meta::{BlockDescription, MetaData, magic_number, sequence_end};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::Path;

/// Rec. 709 primaries and the white of D65, as in ITU-R BT.709.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

/// What a file holds, besides the values of its pixels.
#[derive(Clone, Debug)]
pub struct Layout<'a> {
    /// The display window.
    pub frame: Window,
    /// The data window.
    pub crop: Window,
    /// Header strings by name.
    pub strings: &'a BTreeMap<String, String>,
    /// The channels, sorted by name.
    pub channels: Vec<&'a str>,
}

impl<'a> Layout<'a> {
    /// That of a picture.
    fn of(picture: &'a Picture) -> Self {
        let channels = picture.channels().iter().map(|channel| &*channel.name).collect();
        let Picture { frame, crop, strings, .. } = picture;
        Self { frame: *frame, crop: *crop, strings, channels }
    }
}

/// Writes a picture: one part, scanlines, ZIP over 16 lines, float32; the display window is the
/// frame, the data window the crop. The file is whole or not there (`files::write`).
///
/// # Errors
/// [`FilmError::Write`]; [`FilmError::Invalid`] if the crop is empty, a channel is missing or a
/// string's name does not fit the format.
pub fn write(path: &Path, picture: &Picture) -> Result<(), FilmError> {
    let bytes = encode(picture).map_err(|message| FilmError::invalid(path, message))?;
    files::write(path, Flush::ToDisk, |file| file.write_all(&bytes))
        .map_err(|source| FilmError::write(path, source))
}

/// The bytes of the file that [`write()`] writes: the same for the same picture.
///
/// # Errors
/// What the format cannot hold: an empty crop, no channels, a bad string name.
pub fn encode(picture: &Picture) -> Result<Vec<u8>, String> {
    let mut bytes = Cursor::new(Vec::new());
    let width = picture.width();
    let lines = |window: Window| {
        let first = (window.y0 - picture.crop.y0) as usize * width;
        let lines = first..first + window.area();
        picture.channels().iter().map(|channel| channel.samples[lines.clone()].to_vec()).collect()
    };
    match write_to(&mut bytes, &Layout::of(picture), |window| Ok::<_, String>(lines(window))) {
        Ok(()) => Ok(bytes.into_inner()),
        Err(RowsError::Rows(message) | RowsError::Format(message)) => Err(message),
        Err(RowsError::Io(error)) => Err(format!("cannot be encoded: {error}")),
    }
}

/// Why a file of rows was not written.
#[derive(Debug)]
pub enum RowsError<E> {
    /// The rows could not be had.
    Rows(E),
    /// The format cannot hold such a picture.
    Format(String),
    /// The system's reason.
    Io(io::Error),
}

/// Writes a picture whose rows come from top to bottom, a few lines at a time: no more of it is in
/// memory. `rows` gives, of a window as wide as the crop, the values of each channel. The bytes are
/// those of [`encode`].
///
/// # Errors
/// [`RowsError`]; the file is whole or not there.
pub fn write_rows<E>(
    path: &Path,
    layout: &Layout<'_>,
    rows: impl FnMut(Window) -> Result<Vec<Vec<f32>>, E>,
) -> Result<(), RowsError<E>> {
    let is_special = std::fs::metadata(path).is_ok_and(|found| !found.is_file());
    let mut outcome = Ok(());
    let written = files::write(path, Flush::ToDisk, |file| {
        outcome = if is_special {
            // It cannot be written to out of order.
            let mut bytes = Cursor::new(Vec::new());
            write_to(&mut bytes, layout, rows)
                .and_then(|()| file.write_all(bytes.get_ref()).map_err(RowsError::Io))
        } else {
            write_to(file, layout, rows)
        };
        outcome.is_ok().then_some(()).ok_or_else(|| io::Error::other("not written"))
    });
    outcome.and(written.map_err(RowsError::Io))
}

/// Blocks that are compressed side by side.
const BATCH: usize = 16;

/// Lines in a block.
const LINES: i32 = 16;

fn write_to<E>(
    out: &mut (impl Write + Seek),
    layout: &Layout<'_>,
    mut rows: impl FnMut(Window) -> Result<Vec<Vec<f32>>, E>,
) -> Result<(), RowsError<E>> {
    let headers = [header(layout).map_err(RowsError::Format)?];
    let head = encode_head(&headers).map_err(RowsError::Format)?;
    let blocks: Vec<_> = enumerate_ordered_header_block_indices(&headers).collect();
    let mut offsets = Vec::with_capacity(blocks.len());
    let mut offset = (head.len() + blocks.len() * size_of::<u64>()) as u64;
    out.write_all(&head).map_err(RowsError::Io)?;
    out.write_all(&vec![0; blocks.len() * size_of::<u64>()]).map_err(RowsError::Io)?;
    let starts: Vec<i32> = (layout.crop.y0..layout.crop.y1).step_by(LINES as usize).collect();
    for (blocks, starts) in blocks.chunks(BATCH).zip(starts.chunks(BATCH)) {
        let window = |y0: i32| Window { y0, y1: (y0 + LINES).min(layout.crop.y1), ..layout.crop };
        let planes: Vec<_> = starts
            .iter()
            .map(|&y0| rows(window(y0)))
            .collect::<Result<_, E>>()
            .map_err(RowsError::Rows)?;
        let chunks: Result<Vec<Vec<u8>>, _> = (blocks.par_iter().zip(&planes))
            .map(|((_, index), planes)| compress(*index, planes, &headers))
            .collect();
        for chunk in chunks.map_err(|error| RowsError::Format(say(&error)))? {
            out.write_all(&chunk).map_err(RowsError::Io)?;
            offsets.push(offset);
            offset += chunk.len() as u64;
        }
    }
    let table: Vec<u8> = offsets.iter().flat_map(|offset| offset.to_le_bytes()).collect();
    out.seek(SeekFrom::Start(head.len() as u64))
        .and_then(|_| out.write_all(&table))
        .map_err(RowsError::Io)
}

fn say(error: &::exr::error::Error) -> String {
    format!("cannot be encoded: {error}")
}

/// All that stands before the table of offsets.
fn encode_head(headers: &[Header; 1]) -> Result<Vec<u8>, String> {
    let requirements = MetaData::validate(headers, true).map_err(|error| say(&error))?;
    let mut bytes = Vec::new();
    let head = |bytes: &mut Vec<u8>| -> ::exr::error::UnitResult {
        magic_number::write(bytes)?;
        requirements.write(bytes)?;
        // Sorted by name: the bytes may not depend on the order of a hash map.
        let sorted: BTreeMap<_, _> = headers[0].all_named_attributes().collect();
        for (name, value) in sorted {
            attribute::write(name, &value, bytes)?;
        }
        sequence_end::write(bytes)
    };
    head(&mut bytes).map_err(|error| say(&error))?;
    Ok(bytes)
}

fn header(layout: &Layout<'_>) -> Result<Header, String> {
    if layout.crop.area() == 0 || layout.frame.area() == 0 {
        return Err("an EXR file cannot hold a picture without pixels".to_owned());
    }
    if layout.channels.is_empty() {
        return Err("an EXR file cannot hold a picture without channels".to_owned());
    }
    let describe = |name: &str| {
        // `true` only tells lossy compressions how to round; ours is lossless.
        ChannelDescription::new(text(name), SampleType::F32, false)
    };
    let channels = layout.channels.iter().map(|name| describe(name)).collect();
    let size = Vec2(layout.crop.width(), layout.crop.height());
    let mut own = LayerAttributes {
        layer_position: Vec2(layout.crop.x0, layout.crop.y0),
        software_name: Some(text(concat!("dapple ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in layout.strings {
        own.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let mut shared = ImageAttributes::new(bounds(layout.frame));
    shared.chromaticities = Some(REC_709);
    Ok(Header::new(text(""), size, channels)
        .with_attributes(own)
        .with_shared_attributes(shared)
        .with_encoding(Compression::ZIP16, BlockDescription::ScanLines, LineOrder::Increasing))
}

fn bounds(window: Window) -> IntegerBounds {
    IntegerBounds::new(Vec2(window.x0, window.y0), Vec2(window.width(), window.height()))
}

/// Header texts hold bytes; ours are UTF-8, as the format's later versions ask for.
fn text(string: &str) -> Text {
    Text::from_slice_unchecked(string.as_bytes())
}

/// A block of lines, compressed, as it stands in the file.
fn compress(
    index: BlockIndex,
    planes: &[Vec<f32>],
    headers: &[Header; 1],
) -> ::exr::error::Result<Vec<u8>> {
    let first = index.pixel_position.y();
    let block =
        UncompressedBlock::from_lines(&headers[0].channels, index, |line: LineRefMut<'_>| {
            let at = line.location;
            let start = (at.position.y() - first) * index.pixel_size.width() + at.position.x();
            let samples = &planes[at.channel][start..start + at.sample_count];
            line.value.copy_from_slice(bytemuck::cast_slice(samples));
        });
    let chunk: Chunk = block.compress_to_chunk(headers)?;
    let mut bytes = Vec::new();
    chunk.write(&mut bytes, 1)?;
    bytes.flush()?;
    Ok(bytes)
}
