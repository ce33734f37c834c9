//! The JSON half of glTF 2.0 files that are written.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use crate::math::{Mat3, Quat, Vec3};

/// A document under construction; all indices are those of the file.
#[derive(Clone, Debug, Default)]
pub struct Document {
    lists: Map<String, Value>,
    lights: Vec<Value>,
    variants: Vec<Value>,
    roots: Vec<usize>,
}

impl Document {
    /// Appends to one of the file's lists and tells the place there.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        let list = self.list(list);
        list.push(value);
        list.len() - 1
    }

    /// One of the file's lists, which may be empty still.
    ///
    /// # Panics
    /// Never: nothing but lists is put in.
    pub fn list(&mut self, list: &str) -> &mut Vec<Value> {
        let list = self.lists.entry(list).or_insert_with(|| json!([]));
        list.as_array_mut().expect("is made as an array")
    }

    /// Adds a node that is the child of none.
    pub fn root(&mut self, node: Value) -> usize {
        let node = self.push("nodes", node);
        self.roots.push(node);
        node
    }

    /// Adds a camera at `eye` that looks at `target`; `camera` is glTF's object.
    pub fn camera(&mut self, eye: Vec3, target: Vec3, camera: Value) {
        let camera = self.push("cameras", camera);
        let rotation = look(eye, target);
        self.root(json!({
            "name": "camera", "camera": camera,
            "translation": rounded(eye.to_array()), "rotation": rounded(rotation.to_array()),
        }));
    }

    /// Adds a light of KHR_lights_punctual without a node, and tells its number.
    pub fn punctual(&mut self, light: Value) -> usize {
        self.lights.push(light);
        self.lights.len() - 1
    }

    /// Adds a light of KHR_lights_punctual, which shines along -Z of its node.
    pub fn light(&mut self, light: Value, at: Vec3, towards: Vec3) {
        let light = self.punctual(light);
        let turn = Quat::from_rotation_arc(Vec3::NEG_Z, (towards - at).normalize());
        self.root(json!({
            "translation": rounded(at.to_array()), "rotation": rounded(turn.to_array()),
            "extensions": { "KHR_lights_punctual": { "light": light } },
        }));
    }

    /// Names the variants of materials.
    pub fn variants(&mut self, names: &[&str]) {
        self.variants = names.iter().map(|name| json!({ "name": name })).collect();
    }

    /// The document, made by `generator`; `buffer` is glTF's object.
    pub fn finish(mut self, generator: &str, buffer: Value) -> Value {
        self.push("buffers", buffer);
        let mut root = self.lists;
        root.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
        root.insert("scene".into(), json!(0));
        root.insert("scenes".into(), json!([{ "nodes": self.roots }]));
        let own = [
            ("KHR_lights_punctual", "lights", self.lights),
            ("KHR_materials_variants", "variants", self.variants),
        ];
        let own = own.into_iter().filter(|(_, _, list)| !list.is_empty());
        let own: Map<_, _> =
            own.map(|(name, key, list)| (name.to_owned(), json!({ key: list }))).collect();
        if !own.is_empty() {
            root.insert("extensions".into(), own.into());
        }
        let mut root = Value::Object(root);
        let mut used = BTreeSet::new();
        extensions(&root, &mut used);
        if !used.is_empty() {
            root["extensionsUsed"] = json!(used);
        }
        root
    }
}

/// The turn of a camera at `eye` that looks at `target` and stands upright.
pub fn look(eye: Vec3, target: Vec3) -> Quat {
    let back = (eye - target).normalize();
    let right = Vec3::Y.cross(back).normalize();
    Quat::from_mat3(&Mat3::from_cols(right, back.cross(right), back))
}

/// glTF's camera of a vertical field of view in degrees, for pictures of `aspect`.
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
