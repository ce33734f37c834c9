//! Meshes that change their shape while the shutter is open: their vertices at keys.
//!
//! Vertices go straight from key to key. So there are as many keys as it takes for that to be
//! right: those of the animation, and halfway between two as long as a vertex would be off there
//! by more than a small part of its mesh.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DAffine3;

use super::animation::Animation;
use super::build::Recipe;
use super::json::Fault;
use super::motion::NodeMotions;
use super::nodes::{self, Node};
use super::notices::Notices;
use super::primitive;
use super::read::Storage;
use super::shape::shape;
use super::skin::Skin;
use crate::geom::{Deformation, Mesh, VertexKey};
use crate::math::Vec3;
use crate::scene::Scene;

/// The most keys: a step of the animation is smeared over as much of the time.
const MOST_KEYS: usize = 65;
/// How far a vertex may be off between two keys, in sizes of its mesh.
const TOLERANCE: f32 = 1.0 / 2048.0;

/// All that poses nodes at a time.
pub struct Poser<'a> {
    /// The nodes at rest.
    pub nodes: &'a [Node],
    /// The nodes of the scene that have no parents.
    pub roots: &'a [usize],
    /// The document's skins.
    pub skins: &'a [Skin],
    /// What moves them.
    pub animation: &'a Animation,
    /// When the shutter opens and closes, seconds.
    pub shutter: [f64; 2],
    /// The file's numbers.
    pub storage: &'a Storage<'a>,
}

/// Gives the meshes of some recipes their vertices at keys.
///
/// # Errors
/// What is wrong with a pose, or more memory than the file can justify.
pub fn deform(
    scene: &mut Scene,
    recipes: &[Recipe],
    motions: &NodeMotions,
    poser: &Poser<'_>,
) -> Result<(), Fault> {
    let times = motions.times();
    let mut times = if times.len() < MOST_KEYS { times.to_vec() } else { Vec::new() };
    times.extend([0.0, 1.0]);
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    let mut keys =
        times.iter().map(|&time| poser.shapes(recipes, time)).collect::<Result<Vec<_>, _>>()?;
    loop {
        let middles: Vec<f64> = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let found = middles
            .iter()
            .map(|&time| poser.shapes(recipes, time))
            .collect::<Result<Vec<_>, _>>()?;
        let is_off = |number: usize| farthest_off(&keys, &found, number) > TOLERANCE;
        let goes_on = (0..recipes.len()).any(is_off);
        times.extend(middles);
        times.sort_unstable_by(f64::total_cmp);
        keys = interleave(keys, found);
        if !goes_on || times.len() >= MOST_KEYS {
            break;
        }
    }
    for (number, recipe) in recipes.iter().enumerate() {
        let plain: Vec<Mesh> =
            keys.iter_mut().map(|key| std::mem::take(&mut key[number])).collect();
        let place = &recipe.primitive.place;
        let bytes: usize = plain.iter().map(Mesh::heap_bytes).sum();
        poser.storage.reserve(place, bytes as u64)?;
        let name = scene.meshes[recipe.mesh.index()].name.clone();
        let meshes = match recipe.normal_map {
            None => plain,
            Some(map) => {
                let with_tangents = plain.iter().map(|mesh| {
                    let mut mesh = mesh.clone();
                    primitive::add_tangents(&mut mesh, &map, place, poser.storage)?;
                    Ok(mesh)
                });
                let with_tangents = with_tangents.collect::<Result<Vec<_>, Fault>>()?;
                // Where they part vertices differently from key to key, tangents are those of the
                // triangles.
                let alike = with_tangents.iter().all(|it| it.indices == with_tangents[0].indices);
                if alike { with_tangents } else { plain }
            }
        };
        scene.meshes[recipe.mesh.index()] = Arc::new(Mesh { name, ..meshes[0].clone() });
        let keys = meshes.into_iter().zip(&times).map(|(mesh, &time)| VertexKey::of(mesh, time));
        if let Some(deformation) = Deformation::new(keys.collect()) {
            scene.motion_mut().deform(recipe.mesh.index(), Arc::new(deformation));
        }
    }
    Ok(())
}

/// Those of keys and what lies between them, in turn.
fn interleave<T>(keys: Vec<T>, between: Vec<T>) -> Vec<T> {
    let mut between = between.into_iter();
    keys.into_iter().flat_map(|key| std::iter::once(key).chain(between.next())).collect()
}

/// How far the vertices of mesh `number` are from halfway between two keys, in sizes of the mesh.
fn farthest_off(keys: &[Vec<Mesh>], found: &[Vec<Mesh>], number: usize) -> f32 {
    let size = keys[0][number].bounds().extent().max_element();
    let mut farthest = 0.0_f32;
    for (pair, found) in keys.windows(2).zip(found) {
        let [from, to] = [&pair[0][number].positions, &pair[1][number].positions];
        for ((from, to), found) in from.iter().zip(to).zip(&found[number].positions) {
            let off: Vec3 = (*from + *to) * 0.5 - *found;
            farthest = farthest.max(off.length());
        }
    }
    if size > 0.0 { farthest / size } else { 0.0 }
}

impl Poser<'_> {
    /// The meshes of some recipes at a time from 0 to 1, without tangents of their own.
    fn shapes(&self, recipes: &[Recipe], time: f64) -> Result<Vec<Mesh>, Fault> {
        let [open, close] = self.shutter;
        let mut nodes = self.nodes.to_vec();
        self.animation.pose(&mut nodes, open + (close - open) * time, self.storage)?;
        let mut worlds = vec![None; nodes.len()];
        for at in nodes::place(&nodes, self.roots) {
            worlds[at.node] = Some(at.to_world);
        }
        let mut skins: BTreeMap<usize, Option<Vec<DAffine3>>> = BTreeMap::new();
        let mut meshes = Vec::with_capacity(recipes.len());
        for recipe in recipes {
            if let Some(skin) = recipe.skin
                && !skins.contains_key(&skin)
            {
                skins.insert(skin, self.skins[skin].matrices(&worlds, self.storage)?);
            }
            let matrices = recipe.skin.and_then(|skin| skins[&skin].as_deref());
            let weights = recipe.node.and_then(|node| nodes[node].weights.as_deref());
            let posed = weights.map(|weights| recipe.primitive.pose(weights));
            let primitive = posed.as_ref().unwrap_or(&recipe.primitive);
            let notices = &mut Notices::default();
            meshes.push(shape(primitive, matrices, self.storage, notices)?);
        }
        Ok(meshes)
    }
}
