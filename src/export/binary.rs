//! The document under construction, and the binary chunk behind it.

use std::io::{self, Write};

use serde_json::{Value, json};

use crate::generate::{Document, write_head};
use crate::math::{Vec2, Vec3, Vec4};

/// Part of the binary chunk. What the scene has is written from where it is.
pub enum Chunk<'a> {
    /// Places or directions.
    Vec3(&'a [Vec3]),
    /// Texture coordinates.
    Vec2(&'a [Vec2]),
    /// Tangents or colours.
    Vec4(&'a [Vec4]),
    /// Corners of triangles.
    Indices(&'a [[u32; 3]]),
    /// A file, padded to whole words.
    File(Vec<u8>),
}

impl Chunk<'_> {
    fn len(&self) -> u64 {
        let words = match self {
            Self::Vec3(all) => 3 * all.len(),
            Self::Vec2(all) => 2 * all.len(),
            Self::Vec4(all) => 4 * all.len(),
            Self::Indices(all) => 3 * all.len(),
            Self::File(bytes) => bytes.len().div_ceil(4),
        };
        4 * words as u64
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Vec3(all) => floats(out, bytemuck::cast_slice(all)),
            Self::Vec2(all) => floats(out, bytemuck::cast_slice(all)),
            Self::Vec4(all) => {
                // Not cast: a vector of four may be aligned, but is four numbers in any case.
                all.iter().try_for_each(|v| floats(out, &v.to_array()))
            }
            Self::Indices(all) => {
                all.as_flattened().iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
            }
            Self::File(bytes) => {
                out.write_all(bytes)?;
                out.write_all(&[0; 3][..bytes.len().next_multiple_of(4) - bytes.len()])
            }
        }
    }
}

fn floats(out: &mut dyn Write, all: &[f32]) -> io::Result<()> {
    if cfg!(target_endian = "little") {
        return out.write_all(bytemuck::cast_slice(all));
    }
    all.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
}

/// A file under construction.
#[derive(Default)]
pub struct Binary<'a> {
    /// Its first half.
    pub document: Document,
    chunks: Vec<Chunk<'a>>,
    offset: u64,
}

/// What a view is for (`bufferView.target`).
const VERTICES: u32 = 34962;
const CORNERS: u32 = 34963;

impl<'a> Binary<'a> {
    /// Adds a part of the chunk; returns its view.
    pub fn view(&mut self, chunk: Chunk<'a>) -> usize {
        let length = match &chunk {
            Chunk::File(bytes) => bytes.len() as u64,
            other => other.len(),
        };
        let mut view = json!({ "buffer": 0, "byteOffset": self.offset, "byteLength": length });
        match &chunk {
            Chunk::File(_) => {}
            Chunk::Indices(_) => view["target"] = CORNERS.into(),
            _ => view["target"] = VERTICES.into(),
        }
        self.offset += chunk.len();
        self.chunks.push(chunk);
        self.document.push("bufferViews", view)
    }

    /// Adds an accessor of all that is in `chunk`; `None` if that is nothing.
    pub fn accessor(&mut self, chunk: Chunk<'a>) -> Option<usize> {
        let (count, kind, component) = match &chunk {
            Chunk::Vec3(all) => (all.len(), "VEC3", 5126),
            Chunk::Vec2(all) => (all.len(), "VEC2", 5126),
            Chunk::Vec4(all) => (all.len(), "VEC4", 5126),
            Chunk::Indices(all) => (3 * all.len(), "SCALAR", 5125),
            Chunk::File(_) => (0, "", 0),
        };
        if count == 0 {
            return None;
        }
        let view = self.view(chunk);
        let accessor = json!({
            "bufferView": view, "componentType": component, "count": count, "type": kind,
        });
        Some(self.document.push("accessors", accessor))
    }

    /// Says of an accessor what its least and greatest values are.
    pub fn bound(&mut self, accessor: usize, [min, max]: [Vec3; 2]) {
        let accessor: &mut Value = &mut self.document.list("accessors")[accessor];
        accessor["min"] = json!(min.to_array());
        accessor["max"] = json!(max.to_array());
    }

    /// Writes the file; returns its length.
    ///
    /// # Errors
    /// Those of `out`, and a file that would exceed the 4 GiB of the format.
    pub fn write(self, out: &mut dyn Write) -> io::Result<u64> {
        let generator = concat!("dapple ", env!("CARGO_PKG_VERSION"));
        let buffer = json!({ "byteLength": self.offset });
        let document = self.document.finish(generator, buffer);
        let bytes = write_head(out, &document, self.offset)?;
        self.chunks.iter().try_for_each(|chunk| chunk.write(out))?;
        Ok(bytes)
    }
}
