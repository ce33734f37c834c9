//! Meshes of a document made and placed.

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use glam::DAffine3;

use super::json::Fault;
use super::mesh::{Geometry, MeshDeclaration, Primitive};
use super::motion::NodeMotions;
use super::nodes::{Node, Placed};
use super::notices::Notices;
use super::palette::Palette;
use super::primitive;
use super::read::Storage;
use super::shape::shape;
use super::skin::Skin;
use crate::math::{Aabb, MaterialId, MeshId};
use crate::motion::Motion;
use crate::scene::placement;
use crate::scene::{Instance, Scene, TextureRef, Transform};

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
    /// What moves while the shutter is open.
    motions: Option<&'a NodeMotions>,
    /// How meshes were made that change their shape while it is open.
    pub recipes: Vec<Recipe>,
    pub scene: Scene,
}

/// How a mesh was made.
pub(super) struct Recipe {
    /// The mesh.
    pub mesh: MeshId,
    /// What it was made of, before it was bent; its weights are settled if no node tells them.
    pub primitive: Primitive,
    /// The node that tells the weights of its morph targets, if it does.
    pub node: Option<usize>,
    /// The skin that moves it, if one does.
    pub skin: Option<usize>,
    /// The texture that tangents were made for, if they were.
    pub normal_map: Option<TextureRef>,
}

/// What tells meshes apart: their accessors, the material if tangents are made for its normal map,
/// the skin, and the node if its weights change while the shutter is open.
type Key = (Geometry, Option<MaterialId>, Option<usize>, Option<usize>);

/// How a mesh is bent before it is placed.
#[derive(Clone, Default)]
struct Pose<'a> {
    /// Weights of morph targets; none: the mesh's own.
    weights: Option<&'a [f32]>,
    /// A skin and its matrices.
    skin: Option<(usize, Rc<[DAffine3]>)>,
    /// The node.
    node: usize,
    /// How it moves, where no skin does it.
    motion: Option<Arc<Motion>>,
}

impl<'a> Builder<'a> {
    /// A scene without anything in it; `worlds` tells of each node where it stands, if it is in the
    /// scene, and `motions` how they move.
    pub fn new(
        storage: &'a Storage<'a>,
        palette: &'a Palette,
        skins: &'a [Skin],
        worlds: Vec<Option<DAffine3>>,
        motions: Option<&'a NodeMotions>,
    ) -> Self {
        let (joints, meshes) = (BTreeMap::new(), BTreeMap::new());
        let (recipes, scene) = (Vec::new(), Scene::default());
        Self { storage, palette, skins, worlds, joints, meshes, motions, recipes, scene }
    }

    /// Places a mesh at a node, or all its copies there, or where the node's skin holds it.
    pub fn place_node(
        &mut self,
        mesh: &MeshDeclaration,
        node: &Node,
        at: &Placed,
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        let weights = node.weights.as_deref();
        let motion = self.motions.and_then(|motions| motions.of(at.node)).cloned();
        let mut pose = Pose { weights, skin: None, node: at.node, motion };
        if let Some(skin) = node.skin {
            let Some(matrices) = self.joints(skin)? else {
                let message = "joints are not in the scene: the mesh stands at its node";
                notices.add(self.skins[skin].place.clone(), message);
                return self.place(mesh, at, &pose, notices);
            };
            // The skin puts vertices into the world itself (3.7.3.3).
            (pose.skin, pose.motion) = (Some((skin, matrices)), None);
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
        self.make_room(count, copies.place, pose.motion.as_deref())?;
        for number in 0..copies.count as usize {
            let placement = copies.placement(number)?;
            let motion = pose.motion.as_ref().map(|motion| Arc::new(motion.around(placement)));
            let to_world = at.to_world * placement;
            self.put(&parts, &Placed { to_world, ..*at }, motion.as_ref())?;
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
        let place = format!("/nodes/{}", at.node);
        self.make_room(parts.len() as u64, &place, pose.motion.as_deref())?;
        self.put(&parts, at, pose.motion.as_ref())
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
                    let posed = primitive.pose(weights);
                    self.mesh((&posed, primitive), material, pose, &mesh.name, notices)?
                }
                None => self.mesh((primitive, primitive), material, pose, &mesh.name, notices)?,
            };
            if !bounds.is_empty() {
                self.note_missing_sets(primitive, id, material, notices);
                parts.push((id, material, bounds));
            }
        }
        Ok(parts)
    }

    fn make_room(&mut self, more: u64, place: &str, motion: Option<&Motion>) -> Result<(), Fault> {
        self.storage.reserve_placements(place, more)?;
        if let Some(motion) = motion {
            self.storage.reserve(place, more.saturating_mul(motion.bytes() as u64))?;
        }
        placement::make_room(&mut self.scene.instances, more)
            .map_err(|error| Fault::new(place, error.to_string()))
    }

    /// Places what a mesh is made of, which may move; there is room for it.
    fn put(
        &mut self,
        parts: &[(MeshId, MaterialId, Aabb)],
        at: &Placed,
        motion: Option<&Arc<Motion>>,
    ) -> Result<(), Fault> {
        let transform = Transform::new(placement::narrow(&at.to_world));
        for &(mesh, material, bounds) in parts {
            if !stays_finite(at, motion, bounds) {
                let message = "places its mesh beyond the range of 32-bit floats";
                return Err(Fault::new(format!("/nodes/{}", at.node), message));
            }
            if let Some(motion) = motion {
                let instance = self.scene.instances.len();
                self.scene.motion_mut().move_placement(instance, Arc::clone(motion));
            }
            self.scene.instances.push(Instance { mesh, material, transform });
        }
        Ok(())
    }

    /// The mesh of a primitive, made of another by its weights, stored once for each [`Key`].
    fn mesh(
        &mut self,
        (primitive, unposed): (&Primitive, &Primitive),
        material: MaterialId,
        pose: &Pose,
        name: &str,
        notices: &mut Notices,
    ) -> Result<(MeshId, Aabb), Fault> {
        let normal_map = self.palette.materials[material.index()].tangent_texture();
        let normal_map = normal_map.filter(|map| primitive.geometry.lacks_tangents(map.uv_set));
        // Without joints of its own it does not follow any.
        let skin = pose.skin.as_ref().filter(|_| !primitive.geometry.joints.is_empty());
        let skin_id = skin.map(|(id, _)| *id);
        let (morphs, bends) = self.changes(pose.node, skin_id);
        let node = morphs.then_some(pose.node);
        let key = (primitive.geometry.clone(), normal_map.map(|_| material), skin_id, node);
        if let Some(&known) = self.meshes.get(&key) {
            return Ok(known);
        }
        let matrices = skin.map(|(_, matrices)| &**matrices);
        let mut mesh = shape(primitive, matrices, self.storage, notices)?;
        name.clone_into(&mut mesh.name);
        if let Some(map) = normal_map {
            primitive::add_tangents(&mut mesh, &map, &primitive.place, self.storage)?;
        }
        let built = (MeshId::from_index(self.scene.meshes.len()), mesh.bounds());
        if morphs || bends {
            let primitive = if morphs { unposed } else { primitive }.clone();
            let (mesh, skin) = (built.0, skin_id);
            self.recipes.push(Recipe { mesh, primitive, node, skin, normal_map });
        }
        self.scene.meshes.push(Arc::new(mesh));
        self.meshes.insert(key, built);
        Ok(built)
    }

    /// Whether the weights of a node change while the shutter is open, and whether a skin bends.
    fn changes(&self, node: usize, skin: Option<usize>) -> (bool, bool) {
        let Some(motions) = self.motions else { return (false, false) };
        let joints = skin.map_or(&[][..], |skin| self.skins[skin].joints());
        (motions.morphs(node), joints.iter().any(|&joint| motions.of(joint).is_some()))
    }

    fn note_missing_sets(
        &self,
        primitive: &Primitive,
        mesh: MeshId,
        material: MaterialId,
        notices: &mut Notices,
    ) {
        let mesh = &self.scene.meshes[mesh.index()];
        let needed = &self.palette.sets[material.index()];
        if needed.iter().any(|&set| mesh.uv_set(set as usize).is_empty()) {
            let message = "has no such texture coordinates as its material's textures need";
            notices.add(primitive.place.clone(), message);
        }
    }
}

/// Whether all of a box stays within the range of 32-bit floats, at the keys of its motion too.
fn stays_finite(at: &Placed, motion: Option<&Arc<Motion>>, bounds: Aabb) -> bool {
    let later = motion.map(|motion| motion.times().into_iter().map(|time| motion.at(time)));
    let mut all = std::iter::once(at.to_world).chain(later.into_iter().flatten());
    all.all(|to_world| placement::stays_finite(&to_world, bounds))
}
