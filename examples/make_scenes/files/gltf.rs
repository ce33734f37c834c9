//! Writes glTF 2.0: a JSON file and one buffer beside it.

use std::collections::BTreeSet;

use dapple::math::{Mat3, Quat, Vec3};
use serde_json::{Map, Value, json};

use super::shapes::Shape;

/// A scene under construction; all indices are those of the file.
pub struct Gltf {
    name: String,
    bytes: Vec<u8>,
    lists: Map<String, Value>,
    lights: Vec<Value>,
    roots: Vec<usize>,
}

impl Gltf {
    /// An empty scene, to be `NAME.gltf` and `NAME.bin`.
    pub fn new(name: &str) -> Self {
        let (bytes, lists) = (Vec::new(), Map::new());
        Self { name: name.to_owned(), bytes, lists, lights: Vec::new(), roots: Vec::new() }
    }

    /// Appends to one of the file's lists.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.lists.entry(list).or_insert_with(|| json!([]));
        let list = list.as_array_mut().expect("is made as an array");
        list.push(value);
        list.len() - 1
    }

    /// A mesh of one primitive.
    pub fn mesh(&mut self, shape: &Shape, material: usize) -> usize {
        let primitive = self.primitive(shape, material);
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// The same triangles as another mesh's, in another material.
    pub fn mesh_again(&mut self, mesh: usize, material: usize) -> usize {
        let mut again = self.lists["meshes"][mesh].clone();
        again["primitives"][0]["material"] = material.into();
        self.push("meshes", again)
    }

    fn primitive(&mut self, shape: &Shape, material: usize) -> Value {
        let mut attributes = Map::new();
        let (low, high) = shape.bounds();
        let count = shape.positions.len();
        let position = self.accessor(bytemuck::cast_slice(&shape.positions), 5126, count, "VEC3");
        self.lists["accessors"][position]["min"] = json!(low);
        self.lists["accessors"][position]["max"] = json!(high);
        attributes.insert("POSITION".into(), position.into());
        if !shape.normals.is_empty() {
            let bytes = bytemuck::cast_slice(&shape.normals);
            attributes.insert("NORMAL".into(), self.accessor(bytes, 5126, count, "VEC3").into());
        }
        for (set, uvs) in shape.uvs.iter().enumerate().filter(|(_, uvs)| !uvs.is_empty()) {
            let accessor = self.accessor(bytemuck::cast_slice(uvs), 5126, count, "VEC2");
            attributes.insert(format!("TEXCOORD_{set}"), accessor.into());
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

    /// A node that is the child of none.
    pub fn root(&mut self, node: Value) -> usize {
        let node = self.push("nodes", node);
        self.roots.push(node);
        node
    }

    /// A shape where it was modelled.
    pub fn place(&mut self, name: &str, shape: &Shape, material: usize) {
        let mesh = self.mesh(shape, material);
        self.root(json!({ "name": name, "mesh": mesh }));
    }

    /// A camera at `eye` that looks at `target`; `camera` is glTF's object.
    pub fn camera(&mut self, eye: Vec3, target: Vec3, camera: Value) {
        let camera = self.push("cameras", camera);
        let back = (eye - target).normalize();
        let right = Vec3::Y.cross(back).normalize();
        let rotation = Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back));
        self.root(json!({
            "name": "camera", "camera": camera,
            "translation": rounded(eye.to_array()), "rotation": rounded(rotation.to_array()),
        }));
    }

    /// A light of KHR_lights_punctual, which shines along -Z of the node.
    pub fn light(&mut self, light: Value, at: Vec3, towards: Vec3) {
        self.lights.push(light);
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, (towards - at).normalize());
        self.root(json!({
            "translation": rounded(at.to_array()), "rotation": rounded(turn.to_array()),
            "extensions": { "KHR_lights_punctual": { "light": self.lights.len() - 1 } },
        }));
    }

    /// A texture of a picture beside the scene, looked up as `sampler` says.
    pub fn texture(&mut self, file: &str, sampler: Value) -> usize {
        let image = self.push("images", json!({ "uri": file }));
        let sampler = self.push("samplers", sampler);
        self.push("textures", json!({ "source": image, "sampler": sampler }))
    }

    /// The two files.
    pub fn finish(mut self) -> Vec<(String, Vec<u8>)> {
        let buffer = json!({ "uri": format!("{}.bin", self.name), "byteLength": self.bytes.len() });
        self.push("buffers", buffer);
        let mut root = self.lists;
        root.insert("asset".into(), json!({ "version": "2.0", "generator": "dapple make_scenes" }));
        root.insert("scene".into(), json!(0));
        root.insert("scenes".into(), json!([{ "nodes": self.roots }]));
        if !self.lights.is_empty() {
            let lights = json!({ "KHR_lights_punctual": { "lights": self.lights } });
            root.insert("extensions".into(), lights);
        }
        let mut root = Value::Object(root);
        let mut used = BTreeSet::new();
        extensions(&root, &mut used);
        if !used.is_empty() {
            root["extensionsUsed"] = json!(used);
        }
        let mut text = serde_json::to_vec_pretty(&root).expect("keys are strings");
        text.push(b'\n');
        vec![(format!("{}.gltf", self.name), text), (format!("{}.bin", self.name), self.bytes)]
    }
}

/// A camera of a vertical field of view in degrees, for pictures of `aspect`.
pub fn perspective(yfov: f64, aspect: f64) -> Value {
    let view = json!({ "yfov": yfov.to_radians(), "aspectRatio": aspect, "znear": 0.01 });
    json!({ "type": "perspective", "perspective": view })
}

/// Six digits: short to read, and enough.
pub fn rounded<const N: usize>(values: [f32; N]) -> Value {
    let round = |value: f32| (f64::from(value) * 1e6).round() / 1e6 + 0.0;
    json!(values.map(round).as_slice())
}

/// Collects the names of all extensions.
fn extensions(value: &Value, used: &mut BTreeSet<String>) {
    match value {
        Value::Object(fields) => {
            if let Some(Value::Object(inner)) = fields.get("extensions") {
                used.extend(inner.keys().cloned());
            }
            fields.values().for_each(|field| extensions(field, used));
        }
        Value::Array(items) => items.iter().for_each(|item| extensions(item, used)),
        _ => {}
    }
}
