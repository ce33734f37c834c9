//! What moves while the shutter is open.

use std::collections::HashMap;
use std::fmt::Write;
use std::sync::Arc;

use glam::DAffine3;

use super::placement::{light_at_node, light_moved};
use crate::geom::Deformation;
use crate::light::Punctual;
use crate::math::Digest;
use crate::motion::{Link, Motion};

/// What moves of a scene while the shutter is open, from time 0 to time 1. The scene itself is as
/// it is at time 0.
#[derive(Clone, Debug, Default)]
pub struct SceneMotion {
    /// By instance; each list may end early.
    placements: Vec<Option<Arc<Motion>>>,
    /// By mesh.
    meshes: Vec<Option<Arc<Deformation>>>,
    /// By light.
    lights: Vec<Option<Arc<MovingLight>>>,
    /// By camera.
    cameras: Vec<Option<Arc<Motion>>>,
}

/// The node of a light without extent, which moves.
#[derive(Clone, Debug)]
pub struct MovingLight {
    /// The node.
    pub node: Motion,
    /// What it was placed by since, the innermost first.
    pub placed: Vec<DAffine3>,
}

impl MovingLight {
    /// The light at a time, which is `light` otherwise; `None` where its node has no directions.
    pub fn at(&self, light: &Punctual, time: f32) -> Option<Punctual> {
        let mut placed = light_at_node(light, &self.node.at(f64::from(time)))?;
        for outer in &self.placed {
            placed = light_moved(&placed, outer)?;
        }
        Some(placed)
    }
}

fn set<T>(list: &mut Vec<Option<T>>, index: usize, value: T) {
    if list.len() <= index {
        list.resize_with(index + 1, || None);
    }
    list[index] = Some(value);
}

fn numbered<T>(list: &[Option<T>]) -> impl Iterator<Item = (u64, &T)> {
    let numbered = list.iter().enumerate();
    numbered.filter_map(|(number, item)| Some((number as u64, item.as_ref()?)))
}

fn find<T>(list: &[Option<Arc<T>>], index: usize) -> Option<&Arc<T>> {
    list.get(index)?.as_ref()
}

impl SceneMotion {
    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.placements.is_empty()
            && self.meshes.is_empty()
            && self.lights.is_empty()
            && self.cameras.is_empty()
    }

    /// Whether any instance moves or is deformed.
    pub fn moves_shapes(&self) -> bool {
        !(self.placements.is_empty() && self.meshes.is_empty())
    }

    /// Moves an instance.
    pub fn move_placement(&mut self, instance: usize, motion: Arc<Motion>) {
        set(&mut self.placements, instance, motion);
    }

    /// Moves the vertices of a mesh.
    pub fn deform(&mut self, mesh: usize, deformation: Arc<Deformation>) {
        set(&mut self.meshes, mesh, deformation);
    }

    /// Moves a light.
    pub fn move_light(&mut self, light: usize, motion: Arc<MovingLight>) {
        set(&mut self.lights, light, motion);
    }

    /// Moves a camera.
    pub fn move_camera(&mut self, camera: usize, motion: Arc<Motion>) {
        set(&mut self.cameras, camera, motion);
    }

    /// Puts cameras that stand still before all others.
    pub fn shift_cameras(&mut self, count: usize) {
        if !self.cameras.is_empty() {
            self.cameras.splice(0..0, std::iter::repeat_n(None, count));
        }
    }

    /// The motion of an instance, if it moves.
    #[inline]
    pub fn placement(&self, instance: usize) -> Option<&Arc<Motion>> {
        find(&self.placements, instance)
    }

    /// How a mesh is deformed, if it is.
    #[inline]
    pub fn deformation(&self, mesh: usize) -> Option<&Arc<Deformation>> {
        find(&self.meshes, mesh)
    }

    /// The motion of a light, if it moves.
    #[inline]
    pub fn light(&self, light: usize) -> Option<&Arc<MovingLight>> {
        find(&self.lights, light)
    }

    /// Adds all of it to a digest.
    pub(super) fn add_to(&self, digest: &mut Digest) {
        for (mesh, deformation) in numbered(&self.meshes) {
            digest.word(mesh);
            for key in deformation.keys() {
                digest.word(key.time.to_bits());
                digest.bytes(bytemuck::cast_slice(&key.positions));
                digest.bytes(bytemuck::cast_slice(&key.normals));
                digest.bytes(bytemuck::cast_slice(&key.tangents));
            }
        }
        // Chains share what moves: each is hashed once.
        let mut known = HashMap::new();
        let mut add = |digest: &mut Digest, number: u64, motion: &Motion| {
            digest.word(number);
            for link in motion.links() {
                match link {
                    Link::Still(transform) => {
                        digest.bytes(bytemuck::bytes_of(&transform.to_cols_array()));
                    }
                    Link::Moving(parts) => {
                        let next = known.len() as u64;
                        let number = *known.entry(Arc::as_ptr(parts)).or_insert_with(|| {
                            // Writing to a digest cannot fail.
                            let _ = write!(digest, "{parts:?}");
                            next
                        });
                        digest.word(number);
                    }
                }
            }
        };
        numbered(&self.placements).for_each(|(number, motion)| add(digest, number, motion));
        numbered(&self.cameras).for_each(|(number, motion)| add(digest, number, motion));
        for (number, light) in numbered(&self.lights) {
            add(digest, number, &light.node);
            for placed in &light.placed {
                digest.bytes(bytemuck::bytes_of(&placed.to_cols_array()));
            }
        }
    }

    /// The motion of a camera, if it moves.
    pub fn camera(&self, camera: usize) -> Option<&Arc<Motion>> {
        find(&self.cameras, camera)
    }
}
