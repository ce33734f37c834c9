//! Triangles in world space, and where they come from.

use glam::DAffine3;

use super::clip::clip_bounds;
use super::deformation::Posed;
use super::numbering::Numbering;
use super::slab::own_box;
use super::triangle::Triangle;
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId, TriangleId};
use crate::motion::{Frame, Piece};

/// Hands out the triangles of a scene in world space, by a running number over all instances.
///
/// Vertices are finite, and the answer for a number never changes: structures may ask when they
/// are built, or again for every ray.
pub trait TriangleSource: Send + Sync {
    /// The number of triangles. Who has more than 2^32 - 2 can be built in two levels only.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A triangle's vertices in world space.
    fn triangle(&self, prim: PrimId) -> Triangle;

    /// The box that holds all hits of a triangle.
    #[inline]
    fn own_box(&self, prim: PrimId) -> Aabb {
        own_box(&self.triangle(prim))
    }

    /// How far the vertices may be from where the verdict will see them; zero where they are the
    /// verdict's own. [`TriangleSource::own_box`] is grown by it.
    fn slack(&self) -> f32 {
        0.0
    }

    /// How many primitives are boxes, the last ones: all that is known of these is a box, from
    /// vertex `a` to vertex `b` of its triangle.
    fn boxes(&self) -> usize {
        0
    }

    /// The box of the part that lies in a cell; `None`: there is none.
    #[inline]
    fn clip(&self, prim: PrimId, cell: &Aabb) -> Option<Aabb> {
        if prim.index() >= self.len() - self.boxes() {
            let part = self.triangle(prim).bounds().intersection(*cell);
            return (!part.is_empty()).then_some(part);
        }
        clip_bounds(&self.triangle(prim), cell)
    }

    /// Whose a triangle is.
    #[inline]
    fn locate(&self, prim: PrimId) -> TriangleId {
        TriangleId::unplaced(prim)
    }

    /// The numbers by placement, if they run over placements in order and
    /// [`TriangleSource::locate`] is what is found there.
    fn numbering(&self) -> Option<&Numbering> {
        None
    }

    /// The running number of a triangle: what [`TriangleSource::locate`] is the inverse of.
    fn number(&self, triangle: TriangleId) -> u64 {
        u64::from(triangle.index)
    }

    /// The placed meshes that the triangles are of, if they are any.
    fn placements(&self) -> Option<&dyn Placements> {
        None
    }
}

/// Meshes, and where they are placed.
pub trait Placements: Send + Sync {
    /// The number of placements.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of meshes.
    fn meshes(&self) -> usize;

    /// The number of a mesh's triangles.
    fn mesh_len(&self, mesh: MeshId) -> usize;

    /// The box of those vertices of a mesh that triangles use, in its own space; empty without any.
    fn mesh_bounds(&self, mesh: MeshId) -> Aabb;

    /// A triangle of a mesh in its own space, by its number.
    fn mesh_triangle(&self, mesh: MeshId, index: u32) -> Triangle;

    /// The mesh of a placement.
    fn mesh(&self, placement: InstanceId) -> MeshId;

    /// From the mesh's space to the world.
    fn to_world(&self, placement: InstanceId) -> Affine3A;

    /// Asks for the memory of a placement, which is to be needed soon.
    fn prefetch(&self, _: InstanceId) {}

    /// A triangle's vertices in world space: the ones that the verdict is about.
    fn placed_triangle(&self, triangle: TriangleId) -> Triangle;

    /// The motions of what does not stand still, if anything moves.
    fn motions(&self) -> Option<&dyn Motions> {
        None
    }
}

/// Placements that move while the shutter is open: what is asked at a time is so at all times from
/// 0 to 1.
pub trait Motions: Send + Sync {
    /// Whether a placement does not stand still, or its mesh does not keep its shape.
    fn is_moving(&self, placement: InstanceId) -> bool;

    /// Whether a placement stays where it is, though its mesh may change its shape.
    fn stays(&self, placement: InstanceId) -> bool;

    /// Whether a mesh does not keep its shape.
    fn is_deforming(&self, mesh: MeshId) -> bool;

    /// From the mesh's space to the world at a time.
    fn to_world_at(&self, placement: InstanceId, time: f32) -> Affine3A;

    /// A mesh at a time, in its own space.
    fn mesh_at(&self, mesh: MeshId, time: f32) -> Posed<'_>;

    /// The box of all that a mesh's vertices come to.
    fn mesh_bounds_over_time(&self, mesh: MeshId) -> Aabb;

    /// The box that holds the [`own_box`] of a triangle of a mesh from one time to another.
    fn own_box_over(&self, mesh: MeshId, index: u32, span: [f32; 2]) -> Aabb;

    /// By how much the vertices of a triangle leave the straight lines between where they are at
    /// two times, in the mesh's space, in between.
    fn bend_of_mesh(&self, mesh: MeshId, index: u32, span: [f32; 2]) -> f32;

    /// The moving space that a placement stands still in, and where; `None` if it does not move.
    fn frame(&self, placement: InstanceId) -> Option<(Frame, DAffine3)>;

    /// By how much points within `reach` of the origin of the mesh's space leave the straight lines
    /// between where they are at two times, in the world; `None` where that is not known, since the
    /// placement does not move evenly in between.
    fn bend(&self, placement: InstanceId, reach: f64, span: [f64; 2]) -> Option<f64>;

    /// The same of the way back: in the mesh's space, of points that stand still in the world,
    /// where in between one within `reach` is.
    fn bend_back(&self, placement: InstanceId, reach: f64, span: [f64; 2]) -> Option<f64>;

    /// Pieces of the time, in each of which nothing within `reach` of the origin of the mesh's
    /// space moves further than about `margin` in the world, unless the motion is too fast.
    fn pieces(&self, placement: InstanceId, reach: f64, margin: f64) -> Vec<Piece>;
}

/// Triangles that are already in world space.
#[derive(Clone, Debug, Default)]
pub struct TriangleList(pub Vec<Triangle>);

impl TriangleSource for TriangleList {
    fn len(&self) -> usize {
        self.0.len()
    }

    #[inline]
    fn triangle(&self, prim: PrimId) -> Triangle {
        self.0[prim.index()]
    }
}
