//! Pictures to OpenEXR files.
//!
//! Crate `exr` compresses the blocks and spells the attributes; the file is put together here,
//! because the crate keeps custom attributes in a hash map and would write them in another order
//! each time. Ours are sorted, so that one picture is one sequence of bytes.

use crate::files::{self, Flush};
use crate::film::{FilmError, Picture, Window};
use ::exr::block::chunk::Chunk;
use ::exr::block::lines::LineRefMut;
use ::exr::block::{UncompressedBlock, enumerate_ordered_header_block_indices};
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
use std::io::Write;
use std::path::Path;

/// Rec. 709 primaries and the white of D65, as in ITU-R BT.709.
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

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
    let headers = [header(picture)?];
    let requirements = MetaData::validate(&headers, true)
        .map_err(|error| format!("cannot be encoded: {error}"))?;
    let chunks =
        compress(picture, &headers).map_err(|error| format!("cannot be encoded: {error}"))?;

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
    head(&mut bytes).map_err(|error| format!("cannot be encoded: {error}"))?;

    let mut offset = bytes.len() + chunks.len() * size_of::<u64>();
    for chunk in &chunks {
        bytes.extend_from_slice(&(offset as u64).to_le_bytes());
        offset += chunk.len();
    }
    for chunk in &chunks {
        bytes.extend_from_slice(chunk);
    }
    Ok(bytes)
}

fn header(picture: &Picture) -> Result<Header, String> {
    if picture.crop.area() == 0 || picture.frame.area() == 0 {
        return Err("an EXR file cannot hold a picture without pixels".to_owned());
    }
    if picture.channels().is_empty() {
        return Err("an EXR file cannot hold a picture without channels".to_owned());
    }
    let describe = |name: &str| {
        // `true` only tells lossy compressions how to round; ours is lossless.
        ChannelDescription::new(text(name), SampleType::F32, false)
    };
    let channels = picture.channels().iter().map(|channel| describe(&channel.name)).collect();
    let size = Vec2(picture.width(), picture.height());
    let mut own = LayerAttributes {
        layer_position: Vec2(picture.crop.x0, picture.crop.y0),
        software_name: Some(text(concat!("dapple ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in &picture.strings {
        own.other.insert(text(name), AttributeValue::Text(text(value)));
    }
    let mut shared = ImageAttributes::new(bounds(picture.frame));
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

/// The blocks of 16 lines, compressed, each as it stands in the file.
fn compress(picture: &Picture, headers: &[Header; 1]) -> ::exr::error::Result<Vec<Vec<u8>>> {
    let blocks: Vec<_> = enumerate_ordered_header_block_indices(headers).collect();
    let width = picture.width();
    blocks
        .into_par_iter()
        .map(|(_, index)| {
            let block = UncompressedBlock::from_lines(
                &headers[0].channels,
                index,
                |line: LineRefMut<'_>| {
                    let at = line.location;
                    let start = at.position.y() * width + at.position.x();
                    let samples = &picture.channels()[at.channel].samples;
                    let samples = &samples[start..start + at.sample_count];
                    line.value.copy_from_slice(bytemuck::cast_slice(samples));
                },
            );
            let chunk: Chunk = block.compress_to_chunk(headers)?;
            let mut bytes = Vec::new();
            chunk.write(&mut bytes, 1)?;
            bytes.flush()?;
            Ok(bytes)
        })
        .collect()
}
