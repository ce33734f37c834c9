//! Meshes of a document made and placed.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use glam::DAffine3;

use super::json::Fault;
use super::mesh::{Geometry, MeshDeclaration, Primitive};
use super::nodes::{Node, Placed};
use super::notices::Notices;
use super::palette::Palette;
use super::primitive;
use super::read::Storage;
use super::skin::{self, Skin};
use crate::math::{Aabb, MaterialId, MeshId};
use crate::scene::placement;
use crate::scene::{Instance, Scene, Transform};

/// Makes a scene of nodes and meshes.
pub(super) struct Builder<'a> {
    storage: &'a Storage<'a>,
    palette: &'a Palette,
    skins: &'a [Skin],
    /// Of each node where it stands, if it is in the scene.
    worlds: Vec<Option<DAffine3>>,
    /// Of each skin that was asked for its matrices; none where joints are not in the scene.
    joints: BTreeMap<usize, Option<Rc<[DAffine3]>>>,
    /// What is built already, and its box.
    meshes: BTreeMap<Key, (MeshId, Aabb)>,
    pub scene: Scene,
}

/// What tells meshes apart: their accessors, the material if tangents are made for its normal map,
/// and the skin.
type Key = (Geometry, Option<MaterialId>, Option<usize>);

/// How a mesh is bent before it is placed.
#[derive(Clone, Default)]
struct Pose<'a> {
    /// Weights of morph targets; none: the mesh's own.
    weights: Option<&'a [f32]>,
    /// A skin and its matrices.
    skin: Option<(usize, Rc<[DAffine3]>)>,
}

impl<'a> Builder<'a> {
    /// A scene without anything in it; `worlds` tells of each node where it stands, if it is in the
    /// scene.
    pub fn new(
        storage: &'a Storage<'a>,
        palette: &'a Palette,
        skins: &'a [Skin],
        worlds: Vec<Option<DAffine3>>,
    ) -> Self {
        let (joints, meshes) = (BTreeMap::new(), BTreeMap::new());
        Self { storage, palette, skins, worlds, joints, meshes, scene: Scene::default() }
    }

    /// Places a mesh at a node, or all its copies there, or where the node's skin holds it.
    pub fn place_node(
        &mut self,
        mesh: &MeshDeclaration,
        node: &Node,
        at: &Placed,
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        let mut pose = Pose { weights: node.weights.as_deref(), skin: None };
        if let Some(skin) = node.skin {
            let Some(matrices) = self.joints(skin)? else {
                let message = "joints are not in the scene: the mesh stands at its node";
                notices.add(self.skins[skin].place.clone(), message);
                return self.place(mesh, at, &pose, notices);
            };
            // The skin puts vertices into the world itself (3.7.3.3).
            pose.skin = Some((skin, matrices));
            if node.copies.is_some() {
                let message = "copies of what a skin moves stand where it does: there is one alone";
                notices.add(format!("/nodes/{}", at.node), message);
            }
            let at = Placed { to_world: DAffine3::IDENTITY, ..*at };
            return self.place(mesh, &at, &pose, notices);
        }
        let Some(copies) = &node.copies else { return self.place(mesh, at, &pose, notices) };
        let copies = copies.copies(self.storage)?;
        if copies.count == 0 {
            return Ok(());
        }
        let parts = self.parts(mesh, &pose, notices)?;
        let count = copies.count.saturating_mul(parts.len() as u64);
        self.make_room(count, copies.place)?;
        for number in 0..copies.count as usize {
            let to_world = at.to_world * copies.placement(number)?;
            self.put(&parts, &Placed { to_world, ..*at })?;
        }
        Ok(())
    }

    /// The matrices of a skin's joints.
    fn joints(&mut self, skin: usize) -> Result<Option<Rc<[DAffine3]>>, Fault> {
        if let Some(known) = self.joints.get(&skin) {
            return Ok(known.clone());
        }
        let matrices = self.skins[skin].matrices(&self.worlds, self.storage)?;
        let matrices: Option<Rc<[DAffine3]>> = matrices.map(Into::into);
        self.joints.insert(skin, matrices.clone());
        Ok(matrices)
    }

    /// Places a mesh once.
    fn place(
        &mut self,
        mesh: &MeshDeclaration,
        at: &Placed,
        pose: &Pose,
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        let parts = self.parts(mesh, pose, notices)?;
        self.make_room(parts.len() as u64, &format!("/nodes/{}", at.node))?;
        self.put(&parts, at)
    }

    /// What a mesh puts wherever it is placed: of each primitive with triangles its mesh, its
    /// material and its box.
    fn parts(
        &mut self,
        mesh: &MeshDeclaration,
        pose: &Pose,
        notices: &mut Notices,
    ) -> Result<Vec<(MeshId, MaterialId, Aabb)>, Fault> {
        let mut parts = Vec::with_capacity(mesh.primitives.len());
        for primitive in &mesh.primitives {
            let material = self.palette.id(primitive);
            let (id, bounds) = match pose.weights {
                Some(weights) => {
                    self.mesh(&primitive.pose(weights), material, pose, &mesh.name, notices)?
                }
                None => self.mesh(primitive, material, pose, &mesh.name, notices)?,
            };
            if !bounds.is_empty() {
                self.note_missing_sets(primitive, id, material, notices);
                parts.push((id, material, bounds));
            }
        }
        Ok(parts)
    }

    fn make_room(&mut self, more: u64, place: &str) -> Result<(), Fault> {
        self.storage.reserve_placements(place, more)?;
        placement::make_room(&mut self.scene.instances, more)
            .map_err(|error| Fault::new(place, error.to_string()))
    }

    /// Places what a mesh is made of; there is room for it.
    fn put(&mut self, parts: &[(MeshId, MaterialId, Aabb)], at: &Placed) -> Result<(), Fault> {
        let transform = Transform::new(placement::narrow(&at.to_world));
        for &(mesh, material, bounds) in parts {
            if !placement::stays_finite(&at.to_world, bounds) {
                let message = "places its mesh beyond the range of 32-bit floats";
                return Err(Fault::new(format!("/nodes/{}", at.node), message));
            }
            self.scene.instances.push(Instance { mesh, material, transform });
        }
        Ok(())
    }

    /// The mesh of a primitive, stored once for each [`Key`].
    fn mesh(
        &mut self,
        primitive: &Primitive,
        material: MaterialId,
        pose: &Pose,
        name: &str,
        notices: &mut Notices,
    ) -> Result<(MeshId, Aabb), Fault> {
        let normal_map = self.palette.materials[material.index()].tangent_texture();
        let normal_map = normal_map.filter(|map| primitive.geometry.lacks_tangents(map.uv_set));
        // Without joints of its own it does not follow any.
        let skin = pose.skin.as_ref().filter(|_| !primitive.geometry.joints.is_empty());
        let key =
            (primitive.geometry.clone(), normal_map.map(|_| material), skin.map(|(id, _)| *id));
        if let Some(&known) = self.meshes.get(&key) {
            return Ok(known);
        }
        let mut mesh = primitive::build(primitive, name, self.storage, notices)?;
        if let Some((_, matrices)) = skin {
            skin::pose(&mut mesh, primitive, matrices, self.storage)?;
        }
        if let Some(map) = normal_map {
            primitive::add_tangents(&mut mesh, &map, &primitive.place, self.storage)?;
        }
        let built = (MeshId::from_index(self.scene.meshes.len()), mesh.bounds());
        self.scene.meshes.push(Arc::new(mesh));
        self.meshes.insert(key, built);
        Ok(built)
    }

    fn note_missing_sets(
        &self,
        primitive: &Primitive,
        mesh: MeshId,
        material: MaterialId,
        notices: &mut Notices,
    ) {
        let uvs = &self.scene.meshes[mesh.index()].uvs;
        let needed = self.palette.sets[material.index()];
        if needed.iter().zip(uvs).any(|(&needed, uvs)| needed && uvs.is_empty()) {
            let message = "has no such texture coordinates as its material's textures need";
            notices.add(primitive.place.clone(), message);
        }
    }
}
