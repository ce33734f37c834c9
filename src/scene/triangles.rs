//! The triangles of a scene, by placement or by one running number.

use std::sync::Arc;

use super::{Instance, Scene};
use crate::geom::{Numbering, Placements, Triangle, TriangleSource};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId, TriangleId};

/// A scene has more placed meshes than ids can number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{count} placed meshes are too many; {} at most", u32::MAX - 1)]
pub struct TooManyPlacements {
    /// How many there are.
    pub count: usize,
}

/// The triangles of all instances under one running number: those of the first instance, then
/// those of the second, and so on. Each mesh is kept once, however often it is placed.
#[derive(Clone, Debug)]
pub struct Triangles {
    scene: Arc<Scene>,
    /// Of the triangles of instances.
    numbering: Numbering,
}

impl Triangles {
    /// Numbers a scene's triangles.
    ///
    /// # Errors
    /// [`TooManyPlacements`] if there are 2^32 - 1 placed meshes or more.
    pub fn new(scene: Arc<Scene>) -> Result<Self, TooManyPlacements> {
        let count = scene.instances.len();
        if count >= u32::MAX as usize {
            return Err(TooManyPlacements { count });
        }
        let count = |instance: &Instance| scene.meshes[instance.mesh.index()].indices.len();
        let numbering = Numbering::new(scene.instances.iter().map(count));
        Ok(Self { scene, numbering })
    }

    /// A triangle of an instance, in the winding of the world: counter-clockwise from the front,
    /// mirrored or not.
    #[inline]
    pub fn of(&self, TriangleId { instance, index }: TriangleId) -> Triangle {
        let instance = &self.scene.instances[instance.index()];
        let mesh = &self.scene.meshes[instance.mesh.index()];
        let [a, b, c] = mesh.indices[index as usize]
            .map(|i| instance.transform.point(mesh.positions[i as usize]));
        if instance.transform.mirrored() {
            Triangle { a, b: c, c: b }
        } else {
            Triangle { a, b, c }
        }
    }

    /// The running number of a triangle.
    #[inline]
    pub fn number_of(&self, TriangleId { instance, index }: TriangleId) -> u64 {
        self.numbering.first(instance.index()) + u64::from(index)
    }
}

impl TriangleSource for Triangles {
    fn len(&self) -> usize {
        self.numbering.len()
    }

    #[inline]
    fn triangle(&self, prim: PrimId) -> Triangle {
        self.of(self.locate(prim))
    }

    #[inline]
    fn locate(&self, prim: PrimId) -> TriangleId {
        let (instance, index) = self.numbering.find(u64::from(prim.0));
        TriangleId { instance: InstanceId::from_index(instance), index }
    }

    fn number(&self, triangle: TriangleId) -> u64 {
        self.number_of(triangle)
    }

    fn placements(&self) -> Option<&dyn Placements> {
        Some(self)
    }
}

impl Placements for Triangles {
    fn len(&self) -> usize {
        self.scene.instances.len()
    }

    fn meshes(&self) -> usize {
        self.scene.meshes.len()
    }

    fn mesh_len(&self, mesh: MeshId) -> usize {
        self.scene.meshes[mesh.index()].indices.len()
    }

    fn mesh_bounds(&self, mesh: MeshId) -> Aabb {
        self.scene.meshes[mesh.index()].bounds()
    }

    #[inline]
    fn mesh_triangle(&self, mesh: MeshId, index: u32) -> Triangle {
        let mesh = &self.scene.meshes[mesh.index()];
        let [a, b, c] = mesh.indices[index as usize].map(|i| mesh.positions[i as usize]);
        Triangle { a, b, c }
    }

    #[inline]
    fn mesh(&self, placement: InstanceId) -> MeshId {
        self.scene.instances[placement.index()].mesh
    }

    #[inline]
    fn to_world(&self, placement: InstanceId) -> Affine3A {
        self.scene.instances[placement.index()].transform.to_world()
    }

    #[inline]
    fn placed_triangle(&self, triangle: TriangleId) -> Triangle {
        self.of(triangle)
    }
}
