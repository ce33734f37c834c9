//! Placed meshes.

use glam::Mat3A;

use crate::math::{Affine3A, MaterialId, MeshId, Vec3};

/// An affine placement and what is derived from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// From the mesh's space to the world.
    pub to_world: Affine3A,
    /// Inverse transpose of the linear part, for normals; not normalised.
    pub normal_to_world: Mat3A,
    /// Whether it turns left into right: the front of a triangle is then its clockwise side.
    pub mirrored: bool,
}

impl Transform {
    /// Derives the rest. A singular matrix flattens its mesh; its normals are then meaningless,
    /// and its triangles, which have no area, are never hit.
    pub fn new(to_world: Affine3A) -> Self {
        let m = to_world.matrix3;
        // The cofactor matrix is the inverse transpose times the determinant; its sign is put back.
        let cofactor = Mat3A::from_cols(
            m.y_axis.cross(m.z_axis),
            m.z_axis.cross(m.x_axis),
            m.x_axis.cross(m.y_axis),
        );
        let mirrored = m.determinant() < 0.0;
        let normal_to_world = if mirrored { cofactor * -1.0 } else { cofactor };
        Self { to_world, normal_to_world, mirrored }
    }

    /// A position in the world.
    ///
    /// Always these roundings in this order, so that a vertex that triangles share stays shared.
    #[inline]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.to_world.transform_point3(p)
    }

    /// A normal in the world, of any length.
    #[inline]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        self.normal_to_world * n
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
