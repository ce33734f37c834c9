//! glTF files made in memory, for tests.

use std::path::Path;

use base64::Engine;
use dapple::formats::{LoadError, LoadOptions, gltf};
use dapple::scene::Scene;
use serde_json::{Value, json};

/// A document under construction, its one buffer inside.
pub struct File {
    bytes: Vec<u8>,
    /// The document, but for its buffer.
    pub document: Value,
}

impl File {
    /// A square of two triangles with normals and texture coordinates: mesh 0, in material 0.
    pub fn square() -> Self {
        let mut file = Self { bytes: Vec::new(), document: json!({"asset": {"version": "2.0"}}) };
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let positions = corners.map(|[x, y]| [x, y, 0.0]);
        let uvs = corners.map(|[x, y]| [x, 1.0 - y]);
        file.push("materials", json!({}));
        let positions = file.floats(&positions, "VEC3");
        let normals = file.floats(&[[0.0, 0.0, 1.0]; 4], "VEC3");
        let uvs = file.floats(&uvs, "VEC2");
        let indices = file.accessor(&[0, 1, 2, 0, 2, 3], 5121, 6, "SCALAR");
        let attributes = json!({"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uvs});
        let primitive = json!({"attributes": attributes, "indices": indices, "material": 0});
        file.push("meshes", json!({"primitives": [primitive]}));
        file.push("nodes", json!({"mesh": 0}));
        file
    }

    /// Appends to one of the document's lists.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.document[list].is_null() {
            self.document[list] = json!([]);
        }
        let list = self.document[list].as_array_mut().expect("is a list");
        list.push(value);
        list.len() - 1
    }

    /// An accessor of packed bytes.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend(bytes);
        let view = json!({"buffer": 0, "byteOffset": offset, "byteLength": length});
        let view = self.push("bufferViews", view);
        let (component, count) = (json!(component), json!(count));
        let accessor =
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        self.push("accessors", accessor)
    }

    /// An accessor of vectors.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, values.len(), kind)
    }

    /// Reads it.
    pub fn load(&self) -> Result<Scene, LoadError> {
        self.load_with(&LoadOptions::default())
    }

    /// Reads it with options.
    pub fn load_with(&self, options: &LoadOptions) -> Result<Scene, LoadError> {
        gltf::parse(Path::new("a.gltf"), &self.text(), options)
    }

    /// What such a file holds.
    pub fn text(&self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        let uri = format!("data:application/octet-stream;base64,{data}");
        let mut document = self.document.clone();
        document["buffers"] = json!([{"uri": uri, "byteLength": self.bytes.len()}]);
        serde_json::to_vec(&document).expect("keys are strings")
    }
}

/// What is said of a file that is refused.
pub fn message(result: Result<Scene, LoadError>) -> String {
    result.expect_err("is refused").to_string()
}
