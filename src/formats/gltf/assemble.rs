//! From a checked document to a scene: select, load, build. Only what the chosen scene shows is
//! brought into memory.

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use super::build::Builder;
use super::camera::CameraDeclaration;
use super::deform::{Poser, deform};
use super::document::Document;
use super::json::Fault;
use super::light::LightDeclaration;
use super::motion::NodeMotions;
use super::nodes::{self, Node, Placed};
use super::notices::Notices;
use super::read::Storage;
use super::resources;
use super::select::{Selection, select};
use crate::files::Front;
use crate::formats::{LoadError, LoadOptions};
use crate::light::Environment;
use crate::motion::Motion;
use crate::scene::{Material, MovingLight, Scene};
use crate::texture::Texture;

/// Builds the scene that `options` choose; `binary` is the container's second chunk.
pub fn assemble(
    mut document: Document,
    binary: Option<&[u8]>,
    path: &Path,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<Scene, LoadError> {
    let selection = select(&mut document, path, options, notices)?;
    let mut loaded = load(&mut document, &selection, binary, path, options, notices)?;
    let environment = loaded.environment.take();
    let mut scene = build(document, selection, &loaded, options, notices)
        .map_err(|fault| LoadError::invalid(path, fault.place, fault.message))?;
    scene.environment = environment;
    Ok(scene)
}

/// What a selection needs, in memory.
struct Loaded<'a> {
    storage: Storage<'a>,
    /// One a slot; `None` is what holds no colours and is left out.
    textures: Vec<Option<Texture>>,
    environment: Option<Environment>,
}

/// Reads buffers and images. All that is missing is found before any of it is reported.
fn load<'a>(
    document: &mut Document,
    selection: &Selection,
    binary: Option<&'a [u8]>,
    path: &Path,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<Loaded<'a>, LoadError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut broken = Vec::new();
    let mut needed = vec![false; document.buffers.len()];
    for &view in &selection.views {
        needed[document.views[view].source()] = true;
    }
    let buffers: Vec<Option<Cow<'a, [u8]>>> =
        resources::load_buffers(&document.buffers, &needed, binary, folder, &mut broken);
    let views = std::mem::take(&mut document.views);
    let mut storage = Storage::new(buffers, views, std::mem::take(&mut document.accessors));
    if broken.is_empty() {
        storage
            .unpack(&selection.views)
            .and_then(|()| storage.unpack_meshes(&selection.views, notices))
            .map_err(|fault| LoadError::invalid(path, fault.place, fault.message))?;
    }
    let textures = resources::load_textures(
        &selection.slots,
        &document.textures,
        &document.images,
        &storage,
        path,
        options,
        &mut broken,
        notices,
    );
    let images = &document.images;
    let environment = selection
        .light
        .as_ref()
        .and_then(|light| light.load(images, &storage, path, options, &mut broken, notices));
    if !broken.is_empty() {
        return Err(LoadError::References { file: path.display().to_string(), broken });
    }
    Ok(Loaded { storage, textures, environment })
}

/// Poses the nodes, and places meshes, cameras and lights.
fn build(
    document: Document,
    selection: Selection,
    loaded: &Loaded<'_>,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<Scene, Fault> {
    let Loaded { storage, textures, .. } = loaded;
    let Selection { roots, mut placed, animation, palette, .. } = selection;
    let mut nodes = document.nodes;
    let rest = options.shutter.map(|_| nodes.clone());
    let (mut motions, mut poser) = (None, None);
    if let (Some(animation), Some(time)) = (&animation, options.time) {
        let time = f64::from(time);
        animation.pose(&mut nodes, time, storage)?;
        placed = nodes::place(&nodes, &roots);
        if let (Some(rest), Some(open)) = (&rest, options.shutter) {
            let shutter = [time, time + f64::from(open)];
            animation.note_frozen(shutter, storage, notices)?;
            motions = Some(NodeMotions::read(animation, (&nodes, &placed), shutter, storage)?);
            let (roots, skins) = (&roots[..], &document.skins[..]);
            poser = Some(Poser { nodes: rest, roots, skins, animation, shutter, storage });
        }
    }
    let mut worlds = vec![None; nodes.len()];
    for at in &placed {
        worlds[at.node] = Some(at.to_world);
    }
    let mut builder = Builder::new(storage, &palette, &document.skins, worlds, motions.as_ref());
    let with_mesh = |at: &&Placed| at.visible && nodes[at.node].mesh.is_some();
    let shown: Vec<&Placed> = placed.iter().filter(with_mesh).collect();
    let bytes = storage.buffer_bytes();
    let mut front = Front::new(&options.meter, bytes);
    for (before, at) in shown.iter().enumerate() {
        front.move_to(bytes - bytes * before as u64 / shown.len() as u64);
        let node = &nodes[at.node];
        let Some(mesh) = node.mesh else { continue };
        builder.place_node(&document.meshes[mesh], node, at, notices)?;
    }
    let Builder { mut scene, recipes, .. } = builder;
    if let (Some(motions), Some(poser)) = (&motions, &poser) {
        deform(&mut scene, &recipes, motions, poser)?;
    }
    let declared = (&document.cameras[..], &document.lights[..]);
    let placed = (&nodes[..], &placed[..], motions.as_ref());
    place_cameras_and_lights(placed, declared, &mut scene, notices)?;

    scene.materials = palette.materials;
    let slots = scene.materials.iter_mut().flat_map(Material::texture_slots_mut);
    slots.for_each(|slot| *slot = slot.filter(|slot| textures[slot.texture.index()].is_some()));
    let texture = |it: &Option<Texture>| it.clone().unwrap_or_else(Texture::magenta);
    scene.textures = textures.iter().map(texture).collect();
    Ok(scene)
}

/// Cameras in the order of their declarations, lights in that of their nodes.
fn place_cameras_and_lights(
    (nodes, placed, motions): (&[Node], &[Placed], Option<&NodeMotions>),
    (cameras, lights): (&[CameraDeclaration], &[LightDeclaration]),
    scene: &mut Scene,
    notices: &mut Notices,
) -> Result<(), Fault> {
    let mut found = Vec::new();
    for at in placed {
        let node = &nodes[at.node];
        let place = || format!("/nodes/{}", at.node);
        let motion = motions.and_then(|motions| motions.of(at.node));
        if let Some(camera) = node.camera {
            match cameras[camera].place(&at.to_world, &node.name) {
                Some(placed) => found.push((camera, placed, motion)),
                None => notices.add(place(), "its camera looks nowhere and is left out"),
            }
            if motion.is_some_and(|motion| !has_directions(motion)) {
                let message = "its camera looks nowhere at times while the shutter is open";
                return Err(Fault::new(place(), message));
            }
        }
        if let Some(light) = node.light.filter(|_| at.visible) {
            // One that moves may shine later, if not at first.
            let later = motion
                .iter()
                .flat_map(|motion| motion.times().into_iter().map(|time| motion.at(time)));
            let mut times = std::iter::once(at.to_world).chain(later);
            let placed = times.find_map(|to_world| lights[light].place(&to_world));
            let Some(placed) = placed else {
                notices.add(place(), "its light shines nowhere and is left out");
                continue;
            };
            scene.lights.push(placed);
            if let Some(motion) = motion {
                let moving = MovingLight { node: (**motion).clone(), placed: Vec::new() };
                let light = scene.lights.len() - 1;
                scene.motion_mut().move_light(light, Arc::new(moving));
            }
        }
    }
    for (camera, placed, _) in &found {
        let planes = &cameras[*camera].planes;
        planes.note(&placed.camera, placed.aspect.unwrap_or(1.0), scene, notices);
    }
    found.sort_by_key(|&(camera, ..)| camera);
    for (number, (_, _, motion)) in found.iter().enumerate() {
        if let Some(motion) = motion {
            scene.motion_mut().move_camera(number, Arc::clone(motion));
        }
    }
    scene.cameras = found.into_iter().map(|(_, camera, _)| camera).collect();
    Ok(())
}

/// Whether a node that moves has directions wherever its motion changes its way, and halfway
/// between.
fn has_directions(motion: &Motion) -> bool {
    let times = motion.times();
    let middles = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    times.iter().copied().chain(middles).all(|time| motion.rigid_at(time as f32).is_some())
}
