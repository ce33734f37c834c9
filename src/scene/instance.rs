//! Placed meshes.

use glam::Mat3A;

use crate::math::{Affine3A, MaterialId, MeshId, Vec3};

/// An affine placement: twelve numbers, and what is derived from them when it is asked for, since
/// a scene may have millions of placements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Columns of the matrix from the mesh's space to the world.
    to_world: [f32; 12],
}

impl Transform {
    /// A singular matrix flattens its mesh; its normals are then meaningless, and its triangles,
    /// which have no area, are never hit.
    pub fn new(to_world: Affine3A) -> Self {
        Self { to_world: to_world.to_cols_array() }
    }

    /// From the mesh's space to the world.
    #[inline(always)]
    pub fn to_world(&self) -> Affine3A {
        Affine3A::from_cols_array(&self.to_world)
    }

    /// Inverse transpose of the linear part, for normals; not normalised.
    #[inline(always)]
    pub fn normal_to_world(&self) -> Mat3A {
        let m = self.to_world().matrix3;
        // The cofactor matrix is the inverse transpose times the determinant; its sign is put back.
        let cofactor = Mat3A::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        if self.mirrored() { cofactor * -1.0 } else { cofactor }
    }

    /// Whether it turns left into right: the front of a triangle is then its clockwise side.
    #[inline(always)]
    pub fn mirrored(&self) -> bool {
        self.to_world().matrix3.determinant() < 0.0
    }

    /// A position in the world.
    ///
    /// Always these roundings in this order, so that a vertex that triangles share stays shared.
    #[inline(always)]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.to_world().transform_point3(p)
    }

    /// A normal in the world, of any length.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        self.normal_to_world() * n
    }
}

/// A mesh, where it stands and what it is made of.
#[derive(Clone, Debug)]
pub struct Instance {
    /// The mesh.
    pub mesh: MeshId,
    /// The material of all its triangles.
    pub material: MaterialId,
    /// Where it stands.
    pub transform: Transform,
}
