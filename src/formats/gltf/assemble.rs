//! From a checked document to a scene: only what the chosen scene shows is brought into memory.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

use glam::DAffine3;

use super::accessor::{Accessor, View};
use super::animation::Animation;
use super::camera::CameraDeclaration;
use super::document::Document;
use super::instancing::Instancing;
use super::json::Fault;
use super::light::LightDeclaration;
use super::mesh::{Geometry, MeshDeclaration, Primitive};
use super::nodes::{self, Node, Placed};
use super::notices::Notices;
use super::primitive;
use super::read::Storage;
use super::resources;
use super::skin::{self, Skin};
use super::texture::ImageSource;
use crate::formats::{LoadError, LoadOptions, chosen};
use crate::math::{Aabb, MaterialId, MeshId};
use crate::scene::placement::{self, MAX_INSTANCES};
use crate::scene::{Instance, Material, Scene, Transform};
use crate::texture::Texture;

/// Builds the scene that `options` choose; `binary` is the container's second chunk.
pub fn assemble(
    document: Document,
    binary: Option<&[u8]>,
    path: &Path,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<Scene, LoadError> {
    let Some(roots) = document.scene_roots(options.scene.as_deref()) else {
        let names = document.scenes.iter().map(|scene| scene.name.as_str());
        let wanted = options.scene.as_deref().unwrap_or_default();
        return Err(LoadError::no_such(path, "scene", wanted, names));
    };
    let roots = roots.to_vec();
    let mut placed = nodes::place(&document.nodes, &roots);
    let animation = animation(&document, options, path, notices)?;
    let mut drawn: Vec<usize> =
        placed.iter().filter_map(|at| document.nodes[at.node].mesh).collect();
    drawn.sort_unstable();
    drawn.dedup();
    let primitives = || drawn.iter().flat_map(|&mesh| &document.meshes[mesh].primitives);

    let mut palette = Palette::new(document.materials, primitives());
    let slots = document.slots.retain(&mut palette.materials);
    let used_images = slots.iter().filter_map(|&(texture, _)| document.textures[texture].image);
    let views = used_images.filter_map(|image| match document.images[image].source {
        ImageSource::View(view) => Some(view),
        ImageSource::Uri(_) => None,
    });
    let views = views.chain(primitives().flat_map(|primitive| {
        primitive.accessors().flat_map(|index| views_of(&document.accessors[index]))
    }));
    let views = views.chain(placed.iter().flat_map(|at| {
        let Node { copies, skin, .. } = &document.nodes[at.node];
        let copies = copies.iter().flat_map(Instancing::accessors);
        let matrices = skin.and_then(|skin| document.skins[skin].accessor());
        copies.chain(matrices).flat_map(|index| views_of(&document.accessors[index]))
    }));
    let animated = animation.iter().flat_map(Animation::accessors);
    let views = views.chain(animated.flat_map(|index| views_of(&document.accessors[index])));
    let mut views: Vec<usize> = views.collect();
    views.sort_unstable();
    views.dedup();
    let needed = needed_buffers(&document.views, document.buffers.len(), &views);

    // All that is missing is found before any of it is reported.
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut broken = Vec::new();
    let buffers = resources::load_buffers(&document.buffers, &needed, binary, folder, &mut broken);
    let mut storage = Storage::new(buffers, document.views, document.accessors);
    let in_file = |fault: Fault| LoadError::invalid(path, fault.place, fault.message);
    if broken.is_empty() {
        storage.unpack(&views).map_err(in_file)?;
    }
    let textures = resources::load_textures(
        &slots,
        &document.textures,
        &document.images,
        &storage,
        folder,
        options.missing_texture,
        &mut broken,
        notices,
    );
    if !broken.is_empty() {
        return Err(LoadError::References { file: path.display().to_string(), broken });
    }

    let mut nodes = document.nodes;
    if let (Some(animation), Some(time)) = (animation, options.time) {
        animation.pose(&mut nodes, f64::from(time), &storage).map_err(in_file)?;
        placed = nodes::place(&nodes, &roots);
    }
    let mut worlds = vec![None; nodes.len()];
    for at in &placed {
        worlds[at.node] = Some(at.to_world);
    }
    let mut builder = Builder {
        storage,
        palette,
        skins: document.skins,
        worlds,
        joints: BTreeMap::new(),
        meshes: BTreeMap::new(),
        scene: Scene::default(),
    };
    for at in &placed {
        let node = &nodes[at.node];
        let Some(mesh) = node.mesh else { continue };
        builder.place_node(&document.meshes[mesh], node, at, notices).map_err(in_file)?;
    }
    let mut scene = builder.scene;
    let (cameras, lights) = (&document.cameras, &document.lights);
    place_cameras_and_lights(&nodes, cameras, lights, &placed, &mut scene, notices);
    scene.materials = builder.palette.materials;
    let slots = scene.materials.iter_mut().flat_map(Material::texture_slots_mut);
    slots.for_each(|slot| *slot = slot.filter(|slot| textures[slot.texture.index()].is_some()));
    scene.textures = textures.into_iter().map(|it| it.unwrap_or_else(Texture::magenta)).collect();
    Ok(scene)
}

/// Cameras in the order of their declarations, lights in that of their nodes.
fn place_cameras_and_lights(
    nodes: &[Node],
    cameras: &[CameraDeclaration],
    lights: &[LightDeclaration],
    placed: &[Placed],
    scene: &mut Scene,
    notices: &mut Notices,
) {
    let mut found = Vec::new();
    for at in placed {
        let node = &nodes[at.node];
        let place = || format!("/nodes/{}", at.node);
        if let Some(camera) = node.camera {
            match cameras[camera].place(&at.to_world, &node.name) {
                Some(placed) => found.push((camera, placed)),
                None => notices.add(place(), "its camera looks nowhere and is left out"),
            }
        }
        if let Some(light) = node.light {
            match lights[light].place(&at.to_world) {
                Some(placed) => scene.lights.push(placed),
                None => notices.add(place(), "its light shines nowhere and is left out"),
            }
        }
    }
    found.sort_by_key(|&(camera, _)| camera);
    scene.cameras = found.into_iter().map(|(_, camera)| camera).collect();
}

/// The animation to pose, and what there is to say of those that are not.
fn animation(
    document: &Document,
    options: &LoadOptions,
    path: &Path,
    notices: &mut Notices,
) -> Result<Option<Animation>, LoadError> {
    let names = || document.animations.iter().map(|animation| animation.name.as_str());
    let count = document.animations.len();
    let wanted = match options.animation.as_deref() {
        None => 0,
        Some(wanted) => chosen(names(), wanted)
            .ok_or_else(|| LoadError::no_such(path, "animation", wanted, names()))?,
    };
    match (options.time, count) {
        (None, 0) | (Some(_), 1) => {}
        (None, _) => {
            notices.add("/animations", "all is in its rest pose: --time poses animations");
        }
        (Some(_), 0) => notices.add("", "there is no animation: --time changes nothing"),
        (Some(_), _) if options.animation.is_none() => {
            let message = format!("the first of {count} animations is posed (--animation)");
            notices.add("/animations", message);
        }
        (Some(_), _) => {}
    }
    Ok(options.time.and(document.animations.get(wanted).cloned()))
}

/// The buffer views that an accessor reads.
fn views_of(accessor: &Accessor) -> impl Iterator<Item = usize> {
    let sparse = accessor.sparse.iter().flat_map(|sparse| [sparse.indices.0, sparse.values.0]);
    accessor.base.map(|(view, _)| view).into_iter().chain(sparse)
}

fn needed_buffers(views: &[View], buffers: usize, used: &[usize]) -> Vec<bool> {
    let mut needed = vec![false; buffers];
    for &view in used {
        needed[views[view].source()] = true;
    }
    needed
}

/// The materials that primitives use, in the file's order, the default one last.
struct Palette {
    materials: Vec<Material>,
    /// Of each of the file's materials its new number.
    ids: Vec<Option<MaterialId>>,
    default: Option<MaterialId>,
    /// Of each material which sets of coordinates its textures need.
    sets: Vec<[bool; 2]>,
}

impl Palette {
    fn new<'a>(declared: Vec<Material>, users: impl Iterator<Item = &'a Primitive>) -> Self {
        let mut used = vec![false; declared.len()];
        let mut needs_default = false;
        for primitive in users {
            match primitive.material {
                Some(material) => used[material] = true,
                None => needs_default = true,
            }
        }
        let mut palette = Self {
            materials: Vec::new(),
            ids: vec![None; declared.len()],
            default: None,
            sets: Vec::new(),
        };
        for (i, material) in declared.into_iter().enumerate().filter(|&(i, _)| used[i]) {
            palette.ids[i] = Some(palette.add(material));
        }
        if needs_default {
            palette.default = Some(palette.add(Material::default()));
        }
        palette
    }

    fn add(&mut self, mut material: Material) -> MaterialId {
        let mut sets = [false; 2];
        for texture in material.textures_mut() {
            sets[usize::from(texture.uv_set)] = true;
        }
        self.sets.push(sets);
        self.materials.push(material);
        MaterialId::from_index(self.materials.len() - 1)
    }

    fn id(&self, primitive: &Primitive) -> MaterialId {
        let id = match primitive.material {
            Some(material) => self.ids[material],
            None => self.default,
        };
        id.expect("all primitives that are drawn have been asked for their materials")
    }
}

struct Builder<'a> {
    storage: Storage<'a>,
    palette: Palette,
    skins: Vec<Skin>,
    /// Of each node where it stands, if it is in the scene.
    worlds: Vec<Option<DAffine3>>,
    /// Of each skin that was asked for its matrices; none where joints are not in the scene.
    joints: BTreeMap<usize, Option<Rc<[DAffine3]>>>,
    /// What is built already, and its box.
    meshes: BTreeMap<Key, (MeshId, Aabb)>,
    scene: Scene,
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

impl Builder<'_> {
    /// Places a mesh at a node, or all its copies there, or where the node's skin holds it.
    fn place_node(
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
            let at = Placed { node: at.node, to_world: DAffine3::IDENTITY };
            return self.place(mesh, &at, &pose, notices);
        }
        let Some(copies) = &node.copies else { return self.place(mesh, at, &pose, notices) };
        let most = MAX_INSTANCES - self.scene.instances.len();
        for placement in copies.placements(&self.storage, most)? {
            let to_world = at.to_world * placement;
            self.place(mesh, &Placed { node: at.node, to_world }, &pose, notices)?;
        }
        Ok(())
    }

    /// The matrices of a skin's joints.
    fn joints(&mut self, skin: usize) -> Result<Option<Rc<[DAffine3]>>, Fault> {
        if let Some(known) = self.joints.get(&skin) {
            return Ok(known.clone());
        }
        let matrices = self.skins[skin].matrices(&self.worlds, &self.storage)?;
        let matrices: Option<Rc<[DAffine3]>> = matrices.map(Into::into);
        self.joints.insert(skin, matrices.clone());
        Ok(matrices)
    }

    /// Places all primitives of a mesh.
    fn place(
        &mut self,
        mesh: &MeshDeclaration,
        at: &Placed,
        pose: &Pose,
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        let node = || format!("/nodes/{}", at.node);
        if self.scene.instances.len() + mesh.primitives.len() > MAX_INSTANCES {
            let message = format!("there are more than {MAX_INSTANCES} placed meshes");
            return Err(Fault::new(node(), message));
        }
        for primitive in &mesh.primitives {
            let material = self.palette.id(primitive);
            let (id, bounds) = match pose.weights {
                Some(weights) => {
                    self.mesh(&primitive.posed(weights), material, pose, &mesh.name, notices)?
                }
                None => self.mesh(primitive, material, pose, &mesh.name, notices)?,
            };
            if bounds.is_empty() {
                continue; // has no triangles
            }
            if !placement::stays_finite(&at.to_world, bounds) {
                let message = "places its mesh beyond the range of 32-bit floats";
                return Err(Fault::new(node(), message));
            }
            self.note_missing_sets(primitive, id, material, notices);
            let transform = Transform::new(placement::narrowed(&at.to_world));
            self.scene.instances.push(Instance { mesh: id, material, transform });
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
        let mut mesh = primitive::build(primitive, name, &self.storage, notices)?;
        if let Some((_, matrices)) = skin {
            skin::pose(&mut mesh, primitive, matrices, &self.storage)?;
        }
        if let Some(map) = normal_map {
            primitive::add_tangents(&mut mesh, &map, &primitive.place, &self.storage)?;
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
