//! Writes a forest as binary glTF 2.0: a mesh for each kind, and EXT_mesh_gpu_instancing for its
//! copies, 32 bytes each.
//!
//! The document comes before the triangles and tells their bounds, so kinds are made twice: first
//! to be measured, then, one at a time, to be written.

use std::io::{self, Write};

use rayon::prelude::*;
use serde_json::{Value, json};

use super::kinds::{Kind, ground_material, materials};
use super::land::Land;
use super::piece::Piece;
use super::spread::Stand;
use crate::camera::flight::Pose;
use crate::generate::container::write_head;
use crate::generate::document::{Document, look, perspective};

/// Seconds of the camera's way.
const SECONDS: f32 = 24.0;

/// What is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Another number, other plants.
    pub seed: u64,
    /// The ground.
    pub land: &'a Land,
    /// What stands on it.
    pub kinds: &'a [Kind],
    /// Of each kind where its copies stand.
    pub stands: &'a [Vec<Stand>],
    /// The camera's way.
    pub flight: &'a [Pose],
}

/// What has been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenForest {
    /// In all meshes, each once.
    pub triangles: u64,
    /// Of all copies, and of the ground.
    pub placed: u64,
    /// Plants and stones.
    pub copies: u64,
    /// In all meshes.
    pub vertices: u64,
    /// Of the file.
    pub bytes: u64,
}

/// A piece's numbers.
struct Measure {
    material: usize,
    vertices: usize,
    triangles: usize,
    smooth: bool,
    bounds: [[f32; 3]; 2],
}

impl Measure {
    fn of(piece: &Piece) -> Self {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for position in &piece.positions {
            for (axis, &x) in position.iter().enumerate() {
                bounds[0][axis] = bounds[0][axis].min(x);
                bounds[1][axis] = bounds[1][axis].max(x);
            }
        }
        Self {
            material: piece.material,
            vertices: piece.positions.len(),
            triangles: piece.indices.len(),
            smooth: !piece.normals.is_empty(),
            bounds,
        }
    }
}

/// A document with its binary chunk laid out behind it.
struct Layout {
    document: Document,
    /// Bytes of the chunk so far.
    offset: u64,
}

impl Layout {
    /// Adds a view of so many bytes, and an accessor of it.
    fn accessor(&mut self, bytes: usize, target: Option<u32>, mut accessor: Value) -> usize {
        let mut view = json!({ "buffer": 0, "byteOffset": self.offset, "byteLength": bytes });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        self.offset += bytes as u64;
        accessor["bufferView"] = self.document.push("bufferViews", view).into();
        self.document.push("accessors", accessor)
    }

    fn primitive(&mut self, piece: &Measure) -> Value {
        const ARRAY: Option<u32> = Some(34962);
        const ELEMENTS: Option<u32> = Some(34963);
        let (count, [min, max]) = (piece.vertices, piece.bounds);
        let position = json!({
            "componentType": 5126, "count": count, "type": "VEC3", "min": min, "max": max,
        });
        let mut attributes = json!({ "POSITION": self.accessor(12 * count, ARRAY, position) });
        if piece.smooth {
            let normal = json!({ "componentType": 5126, "count": count, "type": "VEC3" });
            attributes["NORMAL"] = self.accessor(12 * count, ARRAY, normal).into();
        }
        let color =
            json!({ "componentType": 5121, "count": count, "type": "VEC4", "normalized": true });
        attributes["COLOR_0"] = self.accessor(4 * count, ARRAY, color).into();
        let corners = 3 * piece.triangles;
        let indices = json!({ "componentType": 5125, "count": corners, "type": "SCALAR" });
        let indices = self.accessor(4 * corners, ELEMENTS, indices);
        json!({ "attributes": attributes, "indices": indices, "material": piece.material })
    }

    fn mesh(&mut self, name: &str, pieces: &[Measure]) -> usize {
        let primitives: Vec<Value> = pieces.iter().map(|piece| self.primitive(piece)).collect();
        self.document.push("meshes", json!({ "name": name, "primitives": primitives }))
    }

    /// A node of copies of a mesh.
    fn copies(&mut self, name: &str, mesh: usize, count: usize) {
        let vector = json!({ "componentType": 5126, "count": count, "type": "VEC3" });
        let turn =
            json!({ "componentType": 5122, "count": count, "type": "VEC4", "normalized": true });
        let attributes = json!({
            "TRANSLATION": self.accessor(12 * count, None, vector.clone()),
            "ROTATION": self.accessor(8 * count, None, turn),
            "SCALE": self.accessor(12 * count, None, vector),
        });
        let instancing = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
        self.document.root(json!({ "name": name, "mesh": mesh, "extensions": instancing }));
    }

    /// Moves the camera, which is the last node, along a flight.
    fn animate_camera(&mut self, flight: &[Pose]) {
        let (node, count) = (self.document.list("nodes").len() - 1, flight.len());
        let time = json!({
            "componentType": 5126, "count": count, "type": "SCALAR",
            "min": [0.0], "max": [SECONDS],
        });
        let time = self.accessor(4 * count, None, time);
        let place = json!({ "componentType": 5126, "count": count, "type": "VEC3" });
        let place = self.accessor(12 * count, None, place);
        let turn = json!({ "componentType": 5126, "count": count, "type": "VEC4" });
        let turn = self.accessor(16 * count, None, turn);
        let channel = |sampler: usize, path: &str| {
            let target = json!({ "node": node, "path": path });
            json!({ "sampler": sampler, "target": target })
        };
        self.document.push(
            "animations",
            json!({
                "name": "walk",
                "samplers": [{ "input": time, "output": place }, { "input": time, "output": turn }],
                "channels": [channel(0, "translation"), channel(1, "rotation")],
            }),
        );
    }
}

/// Writes a forest.
///
/// # Errors
/// Those of `out`, and a file that would exceed the 4 GiB of the format.
pub fn write(forest: &Plan<'_>, out: &mut dyn Write) -> io::Result<WrittenForest> {
    let measure = |pieces: Vec<Piece>| pieces.iter().map(Measure::of).collect::<Vec<_>>();
    let ground = Measure::of(&forest.land.build(ground_material()));
    let kinds: Vec<Vec<Measure>> =
        forest.kinds.par_iter().map(|kind| measure(kind.build(forest.seed))).collect();
    let mut layout = Layout { document: Document::default(), offset: 0 };
    for material in materials() {
        layout.document.push("materials", material);
    }
    let mesh = layout.mesh("ground", std::slice::from_ref(&ground));
    layout.document.root(json!({ "name": "ground", "mesh": mesh }));
    for ((kind, pieces), stands) in forest.kinds.iter().zip(&kinds).zip(forest.stands) {
        let name = format!("{:?} {}", kind.sort, kind.number).to_lowercase();
        let mesh = layout.mesh(&name, pieces);
        if !stands.is_empty() {
            layout.copies(&name, mesh, stands.len());
        }
    }
    let view = forest.flight[0];
    layout.document.camera(view.eye, view.target, perspective(view.yfov.into(), 16.0 / 9.0));
    layout.animate_camera(forest.flight);
    let buffer = json!({ "byteLength": layout.offset });
    let generator = concat!("dapple ", env!("CARGO_PKG_VERSION"));
    let mut document = layout.document.finish(generator, buffer);
    document["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let bytes = write_head(out, &document, layout.offset)?;
    write_binary(forest, out)?;

    let of = |pieces: &[Measure], number: fn(&Measure) -> usize| -> u64 {
        pieces.iter().map(|piece| number(piece) as u64).sum()
    };
    let all = |number: fn(&Measure) -> usize| -> u64 {
        number(&ground) as u64 + kinds.iter().map(|pieces| of(pieces, number)).sum::<u64>()
    };
    let copies = |stands: &Vec<Stand>| stands.len() as u64;
    let placed = kinds.iter().zip(forest.stands);
    let placed = placed.map(|(pieces, stands)| of(pieces, |it| it.triangles) * copies(stands));
    Ok(WrittenForest {
        triangles: all(|piece| piece.triangles),
        placed: ground.triangles as u64 + placed.sum::<u64>(),
        copies: forest.stands.iter().map(copies).sum(),
        vertices: all(|piece| piece.vertices),
        bytes,
    })
}

/// The binary chunk, in the order of the layout.
fn write_binary(forest: &Plan<'_>, out: &mut dyn Write) -> io::Result<()> {
    let flight = forest.flight;
    write_piece(out, &forest.land.build(ground_material()))?;
    for (kind, stands) in forest.kinds.iter().zip(forest.stands) {
        for piece in kind.build(forest.seed) {
            write_piece(out, &piece)?;
        }
        write_floats(out, stands.iter().flat_map(|stand| stand.at))?;
        for turn in stands.iter().flat_map(|stand| stand.turn) {
            out.write_all(&turn.to_le_bytes())?;
        }
        write_floats(out, stands.iter().flat_map(|stand| [stand.scale; 3]))?;
    }
    let last = (flight.len() - 1) as f32;
    write_floats(out, (0..flight.len()).map(|key| SECONDS * key as f32 / last))?;
    write_floats(out, flight.iter().flat_map(|pose| pose.eye.to_array()))?;
    write_floats(out, flight.iter().flat_map(|pose| look(pose.eye, pose.target).to_array()))
}

fn write_piece(out: &mut dyn Write, piece: &Piece) -> io::Result<()> {
    write_floats(out, piece.positions.iter().copied().flatten())?;
    write_floats(out, piece.normals.iter().copied().flatten())?;
    out.write_all(piece.colors.as_flattened())?;
    piece.indices.iter().flatten().try_for_each(|index| out.write_all(&index.to_le_bytes()))
}

fn write_floats(out: &mut dyn Write, mut floats: impl Iterator<Item = f32>) -> io::Result<()> {
    floats.try_for_each(|float| out.write_all(&float.to_le_bytes()))
}
