//! The flat triangle ids of a scene.

use std::sync::Arc;

use super::{Instance, Scene};
use crate::geom::{Mesh, Triangle, TriangleSource};
use crate::math::{InstanceId, TriangleId};

/// A scene has more triangles than ids can number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{count} triangles are too many; {} at most", u32::MAX - 1)]
pub struct TooManyTriangles {
    /// How many there are.
    pub count: u64,
}

/// The triangles of all instances under one running number: those of the first instance, then
/// those of the second, and so on. Each mesh is kept once, however often it is placed.
#[derive(Clone, Debug)]
pub struct Triangles {
    meshes: Vec<Arc<Mesh>>,
    instances: Vec<Instance>,
    /// Of each instance its first id, and last the number of ids.
    first: Vec<u32>,
}

impl Triangles {
    /// Numbers a scene's triangles.
    ///
    /// # Errors
    /// [`TooManyTriangles`] if there are 2^32 - 1 or more.
    pub fn new(scene: &Scene) -> Result<Self, TooManyTriangles> {
        let mut first = Vec::with_capacity(scene.instances.len() + 1);
        let mut count = 0_u64;
        first.push(0);
        for instance in &scene.instances {
            count += scene.meshes[instance.mesh.index()].indices.len() as u64;
            first.push(u32::try_from(count).unwrap_or(u32::MAX));
        }
        if count >= u64::from(u32::MAX) {
            return Err(TooManyTriangles { count });
        }
        Ok(Self { meshes: scene.meshes.clone(), instances: scene.instances.clone(), first })
    }

    /// The instance that a triangle belongs to, and its number in the instance's mesh.
    #[inline]
    pub fn locate(&self, id: TriangleId) -> (InstanceId, usize) {
        let instance = self.first.partition_point(|&first| first <= id.0) - 1;
        (InstanceId::from_index(instance), (id.0 - self.first[instance]) as usize)
    }

    /// Triangle number `index` of an instance, in the winding of the world: counter-clockwise from
    /// the front, mirrored or not.
    #[inline]
    pub fn of(&self, instance: InstanceId, index: usize) -> Triangle {
        let instance = &self.instances[instance.index()];
        let mesh = &self.meshes[instance.mesh.index()];
        let [a, b, c] =
            mesh.indices[index].map(|i| instance.transform.point(mesh.positions[i as usize]));
        if instance.transform.mirrored { Triangle { a, b: c, c: b } } else { Triangle { a, b, c } }
    }

    /// The id of an instance's first triangle.
    pub fn first(&self, instance: InstanceId) -> TriangleId {
        TriangleId(self.first[instance.index()])
    }
}

impl TriangleSource for Triangles {
    fn len(&self) -> usize {
        *self.first.last().expect("ends with the number of ids") as usize
    }

    fn triangle(&self, id: TriangleId) -> Triangle {
        let (instance, index) = self.locate(id);
        self.of(instance, index)
    }
}
