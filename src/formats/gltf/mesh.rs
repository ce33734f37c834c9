//! Meshes as the document declares them: primitives and their attributes (glTF 2.0, 3.7).

use std::collections::BTreeMap;

use super::json::{Fault, Object};
use super::notices::Notices;
use super::variants::Variants;

/// A mesh: several primitives, each with a material of its own.
#[derive(Clone, Debug)]
pub struct MeshDeclaration {
    /// What the file calls it.
    pub name: String,
    /// Those that can be drawn.
    pub primitives: Vec<Primitive>,
}

/// How vertices make triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mode {
    /// Three each.
    Triangles,
    /// One more each, with the two before it.
    Strip,
    /// One more each, with the one before it and the first.
    Fan,
}

/// The accessors of the displacements of positions, normals and tangents.
pub type Displacements = [Option<usize>; 3];

/// A morph target: the bits of its weight, and its displacements.
pub type Target = (u32, Displacements);

/// The accessors that a primitive's geometry is made of. Equal ones make equal meshes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Geometry {
    /// How vertices make triangles.
    pub mode: Mode,
    /// POSITION.
    pub positions: usize,
    /// NORMAL.
    pub normals: Option<usize>,
    /// TANGENT.
    pub tangents: Option<usize>,
    /// Sets of texture coordinates, TEXCOORD_0 and TEXCOORD_1 unless the material needs others.
    pub uvs: Vec<Option<usize>>,
    /// COLOR_0.
    pub colors: Option<usize>,
    /// Which vertices, in which order; none: all, as they stand.
    pub indices: Option<usize>,
    /// JOINTS_n and WEIGHTS_n, pair by pair.
    pub joints: Vec<[usize; 2]>,
    /// Morph targets with a weight other than zero.
    pub targets: Vec<Target>,
}

impl Geometry {
    /// Whether tangents for a normal map, which is looked up by a set of texture coordinates, can
    /// be made and must be.
    pub fn lacks_tangents(&self, uv_set: u32) -> bool {
        let uvs = self.uvs.get(uv_set as usize).copied().flatten();
        self.tangents.is_none() && self.normals.is_some() && uvs.is_some()
    }

    /// All accessors that it reads.
    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        let Self { normals, tangents, colors, indices, .. } = *self;
        let optional = [normals, tangents, colors, indices];
        let uvs = self.uvs.iter().copied();
        let targets = self.targets.iter().flat_map(|(_, accessors)| *accessors);
        let joints = self.joints.iter().flatten().copied();
        let optional = optional.into_iter().chain(uvs).chain(targets).flatten();
        [self.positions].into_iter().chain(joints).chain(optional)
    }
}

/// A part of a mesh.
#[derive(Clone, Debug)]
pub struct Primitive {
    /// The pointer to it.
    pub place: String,
    /// What it is made of.
    pub geometry: Geometry,
    /// Which material; none: the default one.
    pub material: Option<usize>,
    /// TEXCOORD_n by their numbers.
    pub uv_sets: BTreeMap<u32, usize>,
    /// The numbers of those that `geometry` has.
    pub kept_sets: Vec<u32>,
    /// The accessors of all its morph targets.
    morphs: Vec<Displacements>,
}

impl Primitive {
    /// All accessors that it may read, however it is posed.
    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        self.geometry.accessors().chain(self.morphs.iter().flatten().copied().flatten())
    }

    /// Keeps those sets of texture coordinates that a material looks up.
    pub fn keep_sets(&mut self, sets: &[u32]) {
        self.geometry.uvs = sets.iter().map(|set| self.uv_sets.get(set).copied()).collect();
        self.kept_sets = sets.to_vec();
    }

    /// The same with other weights of its morph targets, as a node may ask.
    pub fn pose(&self, weights: &[f32]) -> Self {
        let mut posed = self.clone();
        posed.geometry.targets = weigh_morphs(&self.morphs, weights);
        posed
    }
}

/// Reads all meshes; `accessors` is how many there are, `variants` tells the materials to show.
pub fn read(
    root: &Object,
    accessors: usize,
    variants: Variants,
    notices: &mut Notices,
) -> Result<Vec<MeshDeclaration>, Fault> {
    let meshes = root.objects("meshes")?;
    meshes.iter().map(|object| mesh(object, accessors, variants, notices)).collect()
}

fn mesh(
    object: &Object,
    accessors: usize,
    variants: Variants,
    notices: &mut Notices,
) -> Result<MeshDeclaration, Fault> {
    if !object.has("primitives") {
        return Err(object.absent("primitives"));
    }
    let weights = weights(object)?;
    let mut primitives = Vec::new();
    for primitive in object.objects("primitives")? {
        primitives.extend(self::primitive(&primitive, &weights, accessors, variants, notices)?);
    }
    Ok(MeshDeclaration { name: object.name()?, primitives })
}

/// The weights of the morph targets, of a mesh or a node.
pub fn weights(object: &Object) -> Result<Vec<f32>, Fault> {
    let elements = object.array("weights")?.iter().enumerate();
    let weight = |(i, value): (usize, &serde_json::Value)| {
        let weight = value.as_f64().map(|weight| weight as f32);
        let place = || format!("{}/{i}", object.at("weights"));
        weight.filter(|weight| weight.is_finite()).ok_or_else(|| {
            Fault::new(place(), "must be a number within the range of 32-bit floats")
        })
    };
    elements.map(weight).collect()
}

/// A primitive, if it has triangles.
fn primitive(
    object: &Object,
    weights: &[f32],
    accessors: usize,
    variants: Variants,
    notices: &mut Notices,
) -> Result<Option<Primitive>, Fault> {
    let attributes = object.object("attributes")?.ok_or_else(|| object.absent("attributes"))?;
    for (name, _) in attributes.members() {
        attributes.reference(name, "accessor", accessors)?;
        note_attribute(&attributes, name, notices);
    }
    let attribute = |name| attributes.reference(name, "accessor", accessors);
    let indices = object.reference("indices", "accessor", accessors)?;
    let material = variants.material(object)?;
    let morphs = morphs(object, accessors, notices)?;
    let joints = joints(&attributes, accessors)?;
    let mode = match object.whole("mode")?.unwrap_or(4) {
        0..=3 => {
            notices.add(object.place(), "points and lines have no area and are left out");
            return Ok(None);
        }
        4 => Mode::Triangles,
        5 => Mode::Strip,
        6 => Mode::Fan,
        other => {
            return Err(object.fault_at("mode", format!("{other} is no mode (0 to 6)")));
        }
    };
    let Some(positions) = attribute("POSITION")? else {
        notices.add(attributes.place(), "a primitive without POSITION is left out");
        return Ok(None);
    };
    let normals = attribute("NORMAL")?;
    let uv_sets = uv_sets(&attributes, accessors)?;
    let geometry = Geometry {
        mode,
        positions,
        normals,
        // Without normals tangents are to be ignored (3.7.2.1).
        tangents: if normals.is_some() { attribute("TANGENT")? } else { None },
        uvs: Vec::new(),
        colors: attribute("COLOR_0")?,
        indices,
        joints,
        targets: weigh_morphs(&morphs, weights),
    };
    let (place, kept_sets) = (object.place().to_owned(), Vec::new());
    let mut primitive = Primitive { place, geometry, material, uv_sets, kept_sets, morphs };
    primitive.keep_sets(&[0, 1]);
    Ok(Some(primitive))
}

/// Says which attributes are not looked at. Those of applications, with an underscore, are theirs.
fn note_attribute(attributes: &Object, name: &str, notices: &mut Notices) {
    let message = match name.split_once('_') {
        Some(("COLOR", set)) if set != "0" => "only the first colours of vertices are supported",
        _ => return,
    };
    notices.add(attributes.at(name), message);
}

/// The sets of texture coordinates by their numbers.
fn uv_sets(attributes: &Object, accessors: usize) -> Result<BTreeMap<u32, usize>, Fault> {
    let mut sets = BTreeMap::new();
    for (name, _) in attributes.members() {
        let number = name.strip_prefix("TEXCOORD_").and_then(|set| set.parse().ok());
        let accessor = attributes.reference(name, "accessor", accessors)?;
        sets.extend(number.zip(accessor));
    }
    Ok(sets)
}

/// Pairs of joints and weights, as many as there are.
fn joints(attributes: &Object, accessors: usize) -> Result<Vec<[usize; 2]>, Fault> {
    let mut all = Vec::new();
    loop {
        let number = all.len();
        let attribute =
            |name: &str| attributes.reference(&format!("{name}_{number}"), "accessor", accessors);
        match (attribute("JOINTS")?, attribute("WEIGHTS")?) {
            (Some(joints), Some(weights)) => all.push([joints, weights]),
            _ => return Ok(all),
        }
    }
}

fn morphs(
    object: &Object,
    accessors: usize,
    notices: &mut Notices,
) -> Result<Vec<Displacements>, Fault> {
    let morph = |target: &Object| {
        for (name, _) in target.members() {
            if name.starts_with("COLOR_") || name.starts_with("TEXCOORD_") {
                notices.add(target.at(name), "is not morphed: it stays as it is");
            }
        }
        let attribute = |name| target.reference(name, "accessor", accessors);
        Ok([attribute("POSITION")?, attribute("NORMAL")?, attribute("TANGENT")?])
    };
    object.objects("targets")?.iter().map(morph).collect()
}

/// The morph targets of some weight.
fn weigh_morphs(morphs: &[Displacements], weights: &[f32]) -> Vec<Target> {
    let all = weights.iter().zip(morphs).filter(|(weight, _)| **weight != 0.0);
    all.map(|(weight, morph)| (weight.to_bits(), *morph)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn meshes(text: &str) -> Result<Vec<MeshDeclaration>, Fault> {
        let value = json::parse(format!("{{\"meshes\": {text}}}").as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        let variants = Variants { materials: 1, ..Variants::default() };
        read(&root, 4, variants, &mut Notices::default())
    }

    #[test]
    fn attributes_are_references() {
        let read = meshes(r#"[{"primitives": [{"attributes": {"POSITION": 3}, "mode": 5}]}]"#);
        let primitive = &read.expect("valid")[0].primitives[0];
        assert_eq!((primitive.geometry.positions, primitive.geometry.mode), (3, Mode::Strip));

        let fault = meshes(r#"[{"primitives": [{"attributes": {"POSITION": 4}}]}]"#);
        assert_eq!(
            fault.expect_err("only 4 accessors"),
            Fault::new("/meshes/0/primitives/0/attributes/POSITION", "refers to accessor 4 of 4")
        );
    }

    #[test]
    fn points_are_left_out_and_unknown_modes_refused() {
        let read = meshes(r#"[{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}]"#);
        assert!(read.expect("valid")[0].primitives.is_empty());
        assert!(
            meshes(r#"[{"primitives": [{"attributes": {"POSITION": 0}, "mode": 7}]}]"#).is_err()
        );
    }

    #[test]
    fn only_morph_targets_of_some_weight_count() {
        let read = meshes(
            r#"[{"weights": [0, 0.5], "primitives": [{"attributes": {"POSITION": 0},
                "targets": [{"POSITION": 1}, {"POSITION": 2}]}]}]"#,
        );
        let targets = &read.expect("valid")[0].primitives[0].geometry.targets;
        assert_eq!(*targets, [(0.5_f32.to_bits(), [Some(2), None, None])]);
    }
}
