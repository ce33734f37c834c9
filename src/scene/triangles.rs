//! The triangles of a scene, by placement or by one running number.

use std::sync::Arc;

use glam::DAffine3;

use super::{Instance, Scene};
use crate::geom::{
    Deformation, Motions, Numbering, Placements, Posed, Triangle, TriangleSource, own_box,
};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId, TriangleId};
use crate::motion::{Frame, Motion, Piece};
use crate::simd::prefetch;

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
    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    fn motion(&self, placement: InstanceId) -> Option<&Motion> {
        Some(&**self.scene.motion.as_ref()?.placement(placement.index())?)
    }

    fn deformation(&self, mesh: MeshId) -> Option<&Deformation> {
        Some(&**self.scene.motion.as_ref()?.deformation(mesh.index())?)
    }

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

    /// The same at a time while the shutter is open, from 0 to 1.
    #[inline]
    pub fn of_at(&self, TriangleId { instance, index }: TriangleId, time: f32) -> Triangle {
        let transform = self.scene.transform_at(instance, time);
        let mesh = self.scene.instances[instance.index()].mesh;
        let corners = self.scene.mesh_at(mesh, time).triangle(index).corners();
        let [a, b, c] = corners.map(|corner| transform.point(corner));
        if transform.mirrored() { Triangle { a, b: c, c: b } } else { Triangle { a, b, c } }
    }

    /// The running number of a triangle.
    #[inline]
    pub fn number_of(&self, TriangleId { instance, index }: TriangleId) -> u64 {
        self.numbering.first(instance.index()) + u64::from(index)
    }
}

impl TriangleSource for Triangles {
    fn len(&self) -> usize {
        self.numbering.count()
    }

    #[inline]
    fn triangle(&self, prim: PrimId) -> Triangle {
        self.of(self.locate(prim))
    }

    #[inline]
    fn locate(&self, prim: PrimId) -> TriangleId {
        self.numbering.locate(prim)
    }

    fn numbering(&self) -> Option<&Numbering> {
        Some(&self.numbering)
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
    fn prefetch(&self, placement: InstanceId) {
        prefetch(&self.scene.instances, placement.index(), size_of::<Instance>());
    }

    #[inline]
    fn placed_triangle(&self, triangle: TriangleId) -> Triangle {
        self.of(triangle)
    }

    fn motions(&self) -> Option<&dyn Motions> {
        let moves = self.scene.motion.as_ref().is_some_and(|motion| motion.moves_shapes());
        moves.then_some(self)
    }
}

impl Motions for Triangles {
    fn is_moving(&self, placement: InstanceId) -> bool {
        self.scene.moves(placement)
    }

    fn stays(&self, placement: InstanceId) -> bool {
        self.motion(placement).is_none()
    }

    fn is_deforming(&self, mesh: MeshId) -> bool {
        self.deformation(mesh).is_some()
    }

    #[inline]
    fn to_world_at(&self, placement: InstanceId, time: f32) -> Affine3A {
        self.scene.to_world_at(placement, time)
    }

    fn mesh_at(&self, mesh: MeshId, time: f32) -> Posed<'_> {
        self.scene.mesh_at(mesh, time)
    }

    fn mesh_bounds_over_time(&self, mesh: MeshId) -> Aabb {
        let corners = self.scene.meshes[mesh.index()].indices.iter().flatten().copied();
        match self.deformation(mesh) {
            Some(deformation) => deformation.bounds(&corners),
            None => self.mesh_bounds(mesh),
        }
    }

    fn own_box_over(&self, mesh: MeshId, index: u32, span: [f32; 2]) -> Aabb {
        let Some(deformation) = self.deformation(mesh) else {
            return own_box(&self.mesh_triangle(mesh, index));
        };
        deformation.own_box(self.scene.meshes[mesh.index()].indices[index as usize], span)
    }

    fn bend_of_mesh(&self, mesh: MeshId, index: u32, span: [f32; 2]) -> f32 {
        let corners = || self.scene.meshes[mesh.index()].indices[index as usize];
        self.deformation(mesh).map_or(0.0, |deformation| deformation.bend(corners(), span))
    }

    fn frame(&self, placement: InstanceId) -> Option<(Frame, DAffine3)> {
        self.motion(placement).map(Motion::frame)
    }

    fn bend(&self, placement: InstanceId, reach: f64, span: [f64; 2]) -> Option<f64> {
        self.motion(placement).map_or(Some(0.0), |motion| motion.bend(reach, span))
    }

    fn bend_back(&self, placement: InstanceId, reach: f64, span: [f64; 2]) -> Option<f64> {
        self.motion(placement).map_or(Some(0.0), |motion| motion.bend_back(reach, span))
    }

    fn pieces(&self, placement: InstanceId, reach: f64, margin: f64) -> Vec<Piece> {
        match self.motion(placement) {
            Some(motion) => motion.pieces(reach, margin),
            None => vec![Piece { span: [0.0, 1.0], middle: 0.0, margin: 0.0 }],
        }
    }
}
