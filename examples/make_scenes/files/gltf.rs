//! Writes glTF 2.0: a JSON file and one buffer beside it.

use std::ops::{Deref, DerefMut};

use dapple::generate::Document;
use serde_json::{Map, Value, json};

pub use dapple::generate::{perspective, rounded};

use super::shapes::Shape;

/// A scene under construction; all indices are those of the file.
pub struct Gltf {
    name: String,
    bytes: Vec<u8>,
    document: Document,
}

impl Deref for Gltf {
    type Target = Document;

    fn deref(&self) -> &Document {
        &self.document
    }
}

impl DerefMut for Gltf {
    fn deref_mut(&mut self) -> &mut Document {
        &mut self.document
    }
}

impl Gltf {
    /// An empty scene, to be `NAME.gltf` and `NAME.bin`.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), bytes: Vec::new(), document: Document::default() }
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, shape: &Shape, material: usize) -> usize {
        let primitive = self.primitive(shape, material);
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// The same triangles as another mesh's, in another material.
    pub fn mesh_again(&mut self, mesh: usize, material: usize) -> usize {
        let mut again = self.list("meshes")[mesh].clone();
        again["primitives"][0]["material"] = material.into();
        self.push("meshes", again)
    }

    fn primitive(&mut self, shape: &Shape, material: usize) -> Value {
        let mut attributes = Map::new();
        let (low, high) = shape.bounds();
        let count = shape.positions.len();
        let position = self.accessor(bytemuck::cast_slice(&shape.positions), 5126, count, "VEC3");
        self.list("accessors")[position]["min"] = json!(low);
        self.list("accessors")[position]["max"] = json!(high);
        attributes.insert("POSITION".into(), position.into());
        if !shape.normals.is_empty() {
            let bytes = bytemuck::cast_slice(&shape.normals);
            attributes.insert("NORMAL".into(), self.accessor(bytes, 5126, count, "VEC3").into());
        }
        for (set, uvs) in shape.uvs.iter().enumerate().filter(|(_, uvs)| !uvs.is_empty()) {
            let accessor = self.accessor(bytemuck::cast_slice(uvs), 5126, count, "VEC2");
            attributes.insert(format!("TEXCOORD_{set}"), accessor.into());
        }
        if !shape.colors.is_empty() {
            // As bytes, in which the format holds them more often than not.
            let bytes = shape.colors.iter().flatten().map(|x| (x * 255.0).round() as u8);
            let bytes: Vec<u8> = bytes.collect();
            let accessor = self.accessor(&bytes, 5121, count, "VEC4");
            self.list("accessors")[accessor]["normalized"] = json!(true);
            attributes.insert("COLOR_0".into(), accessor.into());
        }
        let count = shape.indices.len();
        let indices = self.accessor(bytemuck::cast_slice(&shape.indices), 5123, count, "SCALAR");
        json!({ "attributes": attributes, "indices": indices, "material": material })
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let view =
            json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() });
        self.bytes.extend_from_slice(bytes);
        let view = self.push("bufferViews", view);
        let accessor =
            json!({ "bufferView": view, "componentType": component, "count": count, "type": kind });
        self.push("accessors", accessor)
    }

    /// An accessor of vectors.
    pub fn floats<const N: usize>(&mut self, vectors: &[[f32; N]], kind: &str) -> usize {
        self.accessor(bytemuck::cast_slice(vectors.as_flattened()), 5126, vectors.len(), kind)
    }

    /// An accessor of times, seconds, in order.
    pub fn times(&mut self, times: &[f32]) -> usize {
        let accessor = self.accessor(bytemuck::cast_slice(times), 5126, times.len(), "SCALAR");
        self.list("accessors")[accessor]["min"] = json!([times[0]]);
        self.list("accessors")[accessor]["max"] = json!([times[times.len() - 1]]);
        accessor
    }

    /// The extension of a node whose mesh stands in many places.
    pub fn copies(&mut self, places: &[[f32; 3]], turns: &[[f32; 4]], sizes: &[[f32; 3]]) -> Value {
        let places = self.floats(places, "VEC3");
        let turns = self.floats(turns, "VEC4");
        let sizes = self.floats(sizes, "VEC3");
        let attributes = json!({ "TRANSLATION": places, "ROTATION": turns, "SCALE": sizes });
        json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } })
    }

    /// A shape where it was modelled.
    pub fn place(&mut self, name: &str, shape: &Shape, material: usize) {
        let mesh = self.mesh(shape, material);
        self.root(json!({ "name": name, "mesh": mesh }));
    }

    /// A texture of a picture beside the scene, looked up as `sampler` says.
    pub fn texture(&mut self, file: &str, sampler: Value) -> usize {
        let image = self.push("images", json!({ "uri": file }));
        let sampler = self.push("samplers", sampler);
        self.push("textures", json!({ "source": image, "sampler": sampler }))
    }

    /// The two files.
    pub fn finish(self) -> Vec<(String, Vec<u8>)> {
        let buffer = json!({ "uri": format!("{}.bin", self.name), "byteLength": self.bytes.len() });
        let root = self.document.finish("dapple make_scenes", buffer);
        let mut text = serde_json::to_vec_pretty(&root).expect("keys are strings");
        text.push(b'\n');
        vec![(format!("{}.gltf", self.name), text), (format!("{}.bin", self.name), self.bytes)]
    }
}
