//! OpenEXR files to pictures.
//!
//! What a header claims is checked against the length of the file before anything is allocated,
//! and only the channels that are asked for are kept.

use super::subsampled;
use crate::files::{self, memory};
use crate::film::picture::no_colours;
use crate::film::primaries::Primaries;
use crate::film::{FilmError, Picture, Window};
use crate::math::DVec2;
use ::exr::block::UncompressedBlock;
use ::exr::block::lines::LineRef;
use ::exr::block::reader::{AllChunksReader, ChunksReader};
use ::exr::compression::Compression;
use ::exr::math::Vec2;
use ::exr::meta::MetaData;
use ::exr::meta::attribute::{AttributeValue, EnvironmentMap, IntegerBounds, SampleType};
use ::exr::meta::header::Header;
use ::exr::prelude::f16;
use rayon::prelude::*;
use std::collections::HashSet;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

/// The most pixels that a picture may have: 16384 x 16384.
const MAX_PIXELS: u64 = 1 << 28;
/// Claims of up to this many bytes are taken without asking how long the file is.
const FREE_BYTES: u64 = 1 << 28;
/// No compression of ordinary pixels shrinks them more than this; it is the limit of deflate.
const MAX_RATIO: u64 = 1100;
/// Chunks that are decompressed at a time, by all threads.
const BATCH: usize = 64;

/// What a header tells of the colours, beyond the channels' names.
#[derive(Clone, Copy, Debug)]
pub(super) struct Meaning {
    /// What red, green and blue are; none: those of Rec. 709.
    pub primaries: Option<Primaries>,
    /// Whether the picture holds the six sides of a cube of directions.
    pub is_cube: bool,
    /// How many times as wide as high its pixels are.
    pub pixel_aspect: f32,
}

impl Meaning {
    fn of(header: &Header) -> Self {
        let point = |it: Vec2<f32>| DVec2::new(f64::from(it.x()), f64::from(it.y()));
        let primaries = header.shared_attributes.chromaticities.map(|it| Primaries {
            red: point(it.red),
            green: point(it.green),
            blue: point(it.blue),
            white: point(it.white),
        });
        let primaries = primaries.filter(|it| !it.is_rec_709());
        let is_cube = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
        Self { primaries, is_cube, pixel_aspect: header.shared_attributes.pixel_aspect }
    }
}

/// Reads all channels of a flat EXR file, scanlines or tiles, of any sample type, as floats.
///
/// Of several parts the first with colours counts, else the first; of several resolutions the
/// largest. Texts of the header that the format does not itself define become strings.
///
/// # Errors
/// [`FilmError::Read`]; [`FilmError::Invalid`] for a damaged file, deep data, a compression that
/// is not supported, or more pixels than can be meant.
pub fn read(path: &Path) -> Result<Picture, FilmError> {
    let (file, length) = open(path)?;
    Ok(decode_channels(file, length, path, |_| true)?.0)
}

/// Width and height of what [`decode`] would read, or of the frame around it if that is larger, by
/// the header alone; the largest of its parts.
///
/// # Errors
/// What is wrong with the header.
pub fn size(bytes: &[u8]) -> Result<(u64, u64), String> {
    let meta = MetaData::read_from_unbuffered(Cursor::new(bytes), false);
    let meta = meta.map_err(|error| format!("not a sound EXR file: {error}"))?;
    let sizes = meta.headers.iter().map(frame_size);
    let largest = sizes.max_by_key(|(width, height)| width.saturating_mul(*height));
    largest.ok_or("has no parts".to_owned())
}

/// Width and height of a part or of the frame around it, whichever is larger.
pub fn frame_size(header: &Header) -> (u64, u64) {
    let (own, frame) = (header.layer_size, header.shared_attributes.display_window.size);
    (own.x().max(frame.x()) as u64, own.y().max(frame.y()) as u64)
}

/// Reads a file that is in memory; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn decode(bytes: &[u8], path: &Path) -> Result<Picture, FilmError> {
    Ok(decode_channels(Cursor::new(bytes), bytes.len() as u64, path, |_| true)?.0)
}

pub(super) fn open(path: &Path) -> Result<(BufReader<File>, u64), FilmError> {
    let (file, length) = files::open(path).map_err(|source| FilmError::read(path, source))?;
    Ok((BufReader::new(file), length))
}

/// Reads the channels that are `wanted`.
///
/// # Errors
/// As [`read`].
pub(super) fn decode_channels(
    mut source: impl Read + Seek,
    length: u64,
    path: &Path,
    wanted: impl Fn(&str) -> bool,
) -> Result<(Picture, Meaning), FilmError> {
    let invalid = |message: String| FilmError::invalid(path, message);
    let subsampled = subsampled::find(&mut source);
    source.rewind().map_err(|error| FilmError::read(path, error))?;
    if let Some(part) = subsampled {
        let (mut picture, names) = prepare(&part.header, length, path, &wanted)?;
        let planes = part.read(&mut source, length, picture.crop, wanted).map_err(invalid)?;
        set_channels(&mut picture, names, planes);
        return Ok((picture, Meaning::of(&part.header)));
    }
    let reader = ::exr::block::read(source, false).map_err(|error| read_error(path, error))?;
    let part = reader.headers().iter().position(has_colours).unwrap_or(0);
    for header in reader.headers() {
        check_chunks(header, length).map_err(invalid)?;
    }
    let header = &reader.headers()[part];
    let (compression, meaning) = (header.compression, Meaning::of(header));
    let (mut picture, names) = prepare(header, length, path, &wanted)?;
    let mut planes: Vec<Option<Vec<f32>>> =
        names.iter().map(|name| wanted(name).then(|| vec![0.0; picture.crop.area()])).collect();
    let chunks = reader.all_chunks(false).map_err(|error| read_error(path, error))?;
    fill(chunks, part, &mut planes).map_err(|error| match read_error(path, error) {
        FilmError::Invalid { path, message } => {
            FilmError::Invalid { path, message: format!("{message} ({compression})") }
        }
        other => other,
    })?;
    set_channels(&mut picture, names, planes);
    Ok((picture, meaning))
}

/// A picture without channels yet, and the names of all that the file has.
///
/// # Errors
/// What cannot be meant or held; if nothing is wanted of the file.
fn prepare(
    header: &Header,
    length: u64,
    path: &Path,
    wanted: impl Fn(&str) -> bool,
) -> Result<(Picture, Vec<String>), FilmError> {
    let invalid = |message: String| FilmError::invalid(path, message);
    check_part(header, length).map_err(invalid)?;
    let frame = window(header.shared_attributes.display_window);
    let mut picture = Picture::new(frame, window(header.data_window()));
    collect_strings(header, &mut picture);
    let names: Vec<_> =
        header.channels.list.iter().map(|channel| channel.name.to_string()).collect();
    let kept = names.iter().filter(|name| wanted(name)).count();
    if kept == 0 {
        return Err(invalid(no_colours(names.iter().map(String::as_str))));
    }
    // Once as planes, and once more in what is made of them.
    let bytes = (picture.crop.area() as u64).saturating_mul(8 * kept as u64);
    memory::claim(bytes).map_err(|error| invalid(error.to_string()))?;
    Ok((picture, names))
}

fn set_channels(picture: &mut Picture, names: Vec<String>, planes: Vec<Option<Vec<f32>>>) {
    for (name, plane) in names.into_iter().zip(planes) {
        if let Some(samples) = plane {
            picture.set_channel(name, samples);
        }
    }
}

/// Decompresses all chunks of a part and puts their lines where they belong.
fn fill<R: Read + Seek>(
    mut chunks: AllChunksReader<R>,
    part: usize,
    planes: &mut [Option<Vec<f32>>],
) -> ::exr::error::Result<()> {
    let meta = chunks.meta_data().clone();
    let header = &meta.headers[part];
    let mut seen = HashSet::new();
    let mut covered = 0;
    loop {
        let batch: Vec<_> = chunks.by_ref().take(BATCH).collect::<Result<_, _>>()?;
        if batch.is_empty() {
            break;
        }
        let blocks: Vec<_> = batch
            .into_par_iter()
            .filter(|chunk| chunk.layer_index == part)
            .map(|chunk| UncompressedBlock::decompress_chunk(chunk, &meta, false))
            .collect::<Result<_, _>>()?;
        for block in blocks.iter().filter(|block| block.index.level == Vec2(0, 0)) {
            let position = block.index.pixel_position;
            if !seen.insert((position.x(), position.y())) {
                return Err(::exr::error::Error::Invalid("a block of pixels occurs twice".into()));
            }
            covered += block.index.pixel_size.area();
            for line in block.lines(&header.channels) {
                let channel = line.location.channel;
                if let Some(plane) = &mut planes[channel] {
                    let kind = header.channels.list[channel].sample_type;
                    copy_line(&line, kind, header.layer_size.width(), plane)?;
                }
            }
        }
    }
    if covered != header.layer_size.area() {
        return Err(::exr::error::Error::Invalid("blocks of pixels are missing".into()));
    }
    Ok(())
}

fn copy_line(
    line: &LineRef<'_>,
    kind: SampleType,
    width: usize,
    plane: &mut [f32],
) -> ::exr::error::Result<()> {
    let at = line.location;
    let start = at.position.y() * width + at.position.x();
    let target = &mut plane[start..start + at.sample_count];
    match kind {
        SampleType::F16 => {
            for (target, value) in target.iter_mut().zip(line.read_samples::<f16>()) {
                *target = value?.to_f32();
            }
        }
        SampleType::F32 => {
            for (target, value) in target.iter_mut().zip(line.read_samples::<f32>()) {
                *target = value?;
            }
        }
        SampleType::U32 => {
            for (target, value) in target.iter_mut().zip(line.read_samples::<u32>()) {
                *target = value? as f32;
            }
        }
    }
    Ok(())
}

fn has_colours(header: &Header) -> bool {
    let has = |name: &[u8]| header.channels.list.iter().any(|it| it.name.as_slice() == name);
    (has(b"R") && has(b"G") && has(b"B")) || has(b"Y")
}

/// Each chunk has an entry of 8 bytes in a table of the file.
fn check_chunks(header: &Header, length: u64) -> Result<(), String> {
    let chunks = header.chunk_count as u64;
    if chunks.saturating_mul(8) > length {
        return Err(format!("cut short: {chunks} blocks of pixels in a file of {length} bytes"));
    }
    Ok(())
}

fn check_part(header: &Header, length: u64) -> Result<(), String> {
    let Vec2(width, height) = header.layer_size;
    let pixels = (width as u64).saturating_mul(height as u64);
    if pixels == 0 {
        return Err("no pixels: the data window is empty".to_owned());
    }
    if pixels > MAX_PIXELS {
        return Err(format!("{width}x{height} pixels are more than the limit of {MAX_PIXELS}"));
    }
    // As floats, whatever they are in the file: that is what we hold.
    let bytes = pixels.saturating_mul(4 * header.channels.list.len() as u64);
    if bytes > FREE_BYTES && bytes / MAX_RATIO > length {
        return Err(format!("damaged: {width}x{height} pixels in a file of {length} bytes"));
    }
    if matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
        // The crate's decoder trusts the counters of a chunk: a damaged one ends the process.
        return Err(format!("{} is not supported; convert it to ZIP or PIZ", header.compression));
    }
    Ok(())
}

/// Texts that are not among the format's standard attributes, such as ours.
fn collect_strings(header: &Header, picture: &mut Picture) {
    let custom = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
    for (name, value) in custom {
        if let AttributeValue::Text(value) = value {
            let string = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
            picture.strings.insert(string(name.as_slice()), string(value.as_slice()));
        }
    }
}

fn window(bounds: IntegerBounds) -> Window {
    let Vec2(x0, y0) = bounds.position;
    let end =
        |start: i32, size: usize| i32::try_from(i64::from(start) + size as i64).unwrap_or(i32::MAX);
    Window { x0, y0, x1: end(x0, bounds.size.width()), y1: end(y0, bounds.size.height()) }
}

fn read_error(path: &Path, error: ::exr::error::Error) -> FilmError {
    match error {
        ::exr::error::Error::Io(source) => FilmError::read(path, source),
        ::exr::error::Error::NotSupported(what) => {
            FilmError::invalid(path, format!("not supported: {what}; convert it to ZIP scanlines"))
        }
        error => FilmError::invalid(path, format!("not a sound EXR file: {error}")),
    }
}
