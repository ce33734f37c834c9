//! Writes a plan as binary glTF 2.0.
//!
//! The document comes before the triangles and tells their bounds, so parts are made twice: first
//! to be measured, then, some at a time, to be written. Only those are ever in memory.

use std::io::{self, Write};

use rayon::prelude::*;
use serde_json::{Map, Value, json};

use super::budget::Plan;
use super::container::write_head;
use super::document::Document;
use super::model::{Model, Part};
use super::tessellation::{Tessellation, Vertex};
use crate::math::DQuat;

/// What has been written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Written {
    /// In all meshes.
    pub triangles: u64,
    /// In all meshes.
    pub vertices: u64,
    /// Of the file.
    pub bytes: u64,
}

/// Triangles that are made before they are written.
const AT_ONCE: u64 = 1 << 19;

/// A part's numbers.
struct Measure {
    vertices: usize,
    triangles: usize,
    bounds: [[f32; 3]; 2],
}

/// Writes the scene of `model`, whose parts are in `plan`.
///
/// # Errors
/// Those of `out`, and a file that would exceed the 4 GiB of the format.
pub fn write(out: &mut dyn Write, model: &Model, plan: &Plan) -> io::Result<Written> {
    let measures: Vec<Measure> = plan.parts.par_iter().map(measure).collect();
    let (document, binary) = document(model, plan, &measures);
    let bytes = write_head(out, &document, binary)?;
    write_parts(out, plan, &measures)?;
    let sum = |of: fn(&Measure) -> usize| measures.iter().map(|m| of(m) as u64).sum();
    Ok(Written { triangles: sum(|m| m.triangles), vertices: sum(|m| m.vertices), bytes })
}

fn measure((part, level): &(Part, u32)) -> Measure {
    let made = part.shape.build(*level);
    Measure { vertices: made.vertices.len(), triangles: made.indices.len(), bounds: made.bounds() }
}

/// The document, and the length of the binary chunk.
fn document(model: &Model, plan: &Plan, measures: &[Measure]) -> (Value, u64) {
    let mut document = Document::default();
    for material in &model.materials {
        document.push("materials", material.clone());
    }
    for view in &model.cameras {
        document.camera(view.eye, view.target, view.lens.clone());
    }
    for lamp in &model.lights {
        document.light(lamp.light.clone(), lamp.at, lamp.towards);
    }
    let mut offset = 0;
    for ((part, _), measure) in plan.parts.iter().zip(measures) {
        let mesh = mesh(&mut document, part, measure, &mut offset);
        document.root(node(part, mesh));
    }
    let buffer = json!({ "byteLength": offset });
    (document.finish(concat!("dapple ", env!("CARGO_PKG_VERSION")), buffer), offset)
}

fn mesh(document: &mut Document, part: &Part, measure: &Measure, offset: &mut u64) -> usize {
    let mut view = |bytes: usize, target: u32, stride: Option<usize>| {
        let mut view = json!({
            "buffer": 0, "byteOffset": *offset, "byteLength": bytes, "target": target,
        });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        *offset += bytes as u64;
        document.push("bufferViews", view)
    };
    const ARRAY: u32 = 34962;
    const ELEMENTS: u32 = 34963;
    let stride = size_of::<Vertex>();
    let vertices = view(measure.vertices * stride, ARRAY, Some(stride));
    let indices = view(measure.triangles * 12, ELEMENTS, None);
    let position = document.push(
        "accessors",
        json!({
            "bufferView": vertices, "componentType": 5126, "count": measure.vertices,
            "type": "VEC3", "min": measure.bounds[0], "max": measure.bounds[1],
        }),
    );
    let normal = document.push(
        "accessors",
        json!({
            "bufferView": vertices, "byteOffset": 12, "componentType": 5126,
            "count": measure.vertices, "type": "VEC3",
        }),
    );
    let indices = document.push(
        "accessors",
        json!({
            "bufferView": indices, "componentType": 5125, "count": 3 * measure.triangles,
            "type": "SCALAR",
        }),
    );
    let primitive = json!({
        "attributes": { "POSITION": position, "NORMAL": normal },
        "indices": indices, "material": part.material,
    });
    document.push("meshes", json!({ "name": part.name, "primitives": [primitive] }))
}

fn node(part: &Part, mesh: usize) -> Value {
    let mut node = Map::new();
    node.insert("name".into(), part.name.clone().into());
    node.insert("mesh".into(), mesh.into());
    let (turn, shift) = (DQuat::from_mat3(&part.place.matrix3), part.place.translation);
    if turn != DQuat::IDENTITY {
        node.insert("rotation".into(), json!(turn.normalize().as_quat().to_array()));
    }
    node.insert("translation".into(), json!(shift.as_vec3().to_array()));
    Value::Object(node)
}

/// The binary chunk: of each part its vertices, then its indices.
fn write_parts(out: &mut dyn Write, plan: &Plan, measures: &[Measure]) -> io::Result<()> {
    let mut next = 0;
    while next < plan.parts.len() {
        let first = next;
        let mut triangles = 0;
        while next < plan.parts.len() && (next == first || triangles < AT_ONCE) {
            triangles += measures[next].triangles as u64;
            next += 1;
        }
        let made: Vec<Tessellation> = plan.parts[first..next]
            .par_iter()
            .map(|(part, level)| part.shape.build(*level))
            .collect();
        for part in &made {
            write_part(out, part)?;
        }
    }
    Ok(())
}

fn write_part(out: &mut dyn Write, part: &Tessellation) -> io::Result<()> {
    if cfg!(target_endian = "little") {
        out.write_all(bytemuck::cast_slice(&part.vertices))?;
        return out.write_all(bytemuck::cast_slice(&part.indices));
    }
    let words = part.vertices.iter().flat_map(|v| v.position.into_iter().chain(v.normal));
    for word in words.map(f32::to_le_bytes) {
        out.write_all(&word)?;
    }
    part.indices.iter().flatten().try_for_each(|index| out.write_all(&index.to_le_bytes()))
}
