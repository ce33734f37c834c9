//! Skins: meshes whose vertices follow several nodes (glTF 2.0, 3.7.3), as these stand at rest.

use glam::{DAffine3, DMat3, DMat4, DVec3};

use super::json::{Fault, Object};
use super::mesh::Primitive;
use super::read::Storage;
use crate::geom::Mesh;
use crate::math::Vec3;

/// A skin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skin {
    /// The pointer to it.
    pub place: String,
    /// The nodes that vertices follow.
    joints: Vec<usize>,
    /// From the mesh's space to that of each joint, matrices; none: they are one.
    inverse_bind: Option<usize>,
}

/// Reads all skins; `nodes` and `accessors` are how many there are.
pub fn read(root: &Object, nodes: usize, accessors: usize) -> Result<Vec<Skin>, Fault> {
    let skin = |object: &Object| {
        let joints = object.references("joints", "node", nodes)?;
        if joints.is_empty() {
            return Err(object.fault_at("joints", "must name at least one node"));
        }
        object.reference("skeleton", "node", nodes)?;
        let inverse_bind = object.reference("inverseBindMatrices", "accessor", accessors)?;
        Ok(Skin { place: object.place().to_owned(), joints, inverse_bind })
    };
    root.objects("skins")?.iter().map(skin).collect()
}

impl Skin {
    /// The nodes that vertices follow.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// The accessor that it reads, if any.
    pub fn accessor(&self) -> Option<usize> {
        self.inverse_bind
    }

    /// From the mesh's space to the world, by joint. None where a joint is not in the scene, whose
    /// nodes stand where `worlds` tells.
    ///
    /// # Errors
    /// Fewer matrices than joints, numbers that are not finite.
    pub fn matrices(
        &self,
        worlds: &[Option<DAffine3>],
        storage: &Storage,
    ) -> Result<Option<Vec<DAffine3>>, Fault> {
        let inverse_bind = match self.inverse_bind {
            Some(accessor) => storage.matrices(accessor)?,
            None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); self.joints.len()],
        };
        if inverse_bind.len() < self.joints.len() {
            let (found, joints) = (inverse_bind.len(), self.joints.len());
            let message = format!("has {found} inverse bind matrices for {joints} joints");
            return Err(Fault::new(self.place.clone(), message));
        }
        let mut matrices = Vec::with_capacity(self.joints.len());
        for (&joint, bind) in self.joints.iter().zip(inverse_bind) {
            let Some(world) = worlds[joint] else { return Ok(None) };
            let bind = DAffine3::from_mat4(DMat4::from_cols_array(&bind.map(f64::from)));
            let matrix = world * bind;
            if !matrix.is_finite() {
                let message = format!("the matrix of joint node {joint} is not finite");
                return Err(Fault::new(self.place.clone(), message));
            }
            matrices.push(matrix);
        }
        Ok(Some(matrices))
    }
}

/// Moves the vertices of a primitive to where the joints hold them, in the world.
///
/// # Errors
/// Joints that are not there, attributes of wrong length, places that are not finite.
pub fn pose(
    mesh: &mut Mesh,
    primitive: &Primitive,
    matrices: &[DAffine3],
    storage: &Storage,
) -> Result<(), Fault> {
    let count = mesh.positions.len();
    let blended = blend(primitive, matrices, storage, count)?;
    let mut mirrored = 0;
    for (vertex, sum) in blended.into_iter().enumerate() {
        // Weights should sum to one; of nothing, all is the first joint's.
        let (linear, translation) = if sum.weight.abs() > 1e-6 {
            (sum.linear * (1.0 / sum.weight), sum.translation / sum.weight)
        } else {
            (matrices[0].matrix3, matrices[0].translation)
        };
        let moved = linear * mesh.positions[vertex].as_dvec3() + translation;
        let limit = f64::from(f32::MAX) / 4.0;
        if !moved.abs().cmplt(DVec3::splat(limit)).all() {
            let message = format!("its skin moves vertex {vertex} beyond 32-bit floats");
            return Err(Fault::new(primitive.place.clone(), message));
        }
        mesh.positions[vertex] = moved.as_vec3();
        let determinant = linear.determinant();
        mirrored += usize::from(determinant < 0.0);
        if let Some(normal) = mesh.normals.get_mut(vertex) {
            let side = if determinant < 0.0 { -1.0 } else { 1.0 };
            let turned = cofactor(&linear) * normal.as_dvec3() * side;
            *normal = unit_or(turned, *normal);
        }
        if let Some(tangent) = mesh.tangents.get_mut(vertex) {
            let along = unit_or(linear * tangent.truncate().as_dvec3(), tangent.truncate());
            *tangent = along.extend(tangent.w);
        }
    }
    if 2 * mirrored > count {
        mesh.indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        mesh.tangents.iter_mut().for_each(|tangent| tangent.w = -tangent.w);
    }
    Ok(())
}

/// The matrices that a vertex follows, each times its weight, and the sum of the weights.
#[derive(Clone, Copy)]
struct Blended {
    linear: DMat3,
    translation: DVec3,
    weight: f64,
}

impl Blended {
    const NONE: Self = Self { linear: DMat3::ZERO, translation: DVec3::ZERO, weight: 0.0 };
}

/// Sums up the matrices of the joints that each of `count` vertices follows.
fn blend(
    primitive: &Primitive,
    matrices: &[DAffine3],
    storage: &Storage,
    count: usize,
) -> Result<Vec<Blended>, Fault> {
    let fault = |message: String| Fault::new(primitive.place.clone(), message);
    let mut blended = vec![Blended::NONE; count];
    storage.reserve(&primitive.place, count as u64 * 104)?;
    for &[joints, weights] in &primitive.geometry.joints {
        let (joints, weights) = (storage.vectors::<4>(joints)?, storage.vectors::<4>(weights)?);
        if joints.len() != count || weights.len() != count {
            return Err(fault(format!(
                "joints and weights must be as many as its {count} vertices"
            )));
        }
        for (sum, (joints, weights)) in blended.iter_mut().zip(joints.iter().zip(&weights)) {
            for (&joint, &weight) in
                joints.iter().zip(weights).filter(|(_, weight)| **weight != 0.0)
            {
                // What is no number is no joint.
                let found = matrices.get(if joint >= 0.0 { joint as usize } else { usize::MAX });
                let matrix = found.ok_or_else(|| {
                    fault(format!("a vertex follows joint {joint} of {}", matrices.len()))
                })?;
                let weight = f64::from(weight);
                sum.linear += matrix.matrix3 * weight;
                sum.translation += matrix.translation * weight;
                sum.weight += weight;
            }
        }
    }
    Ok(blended)
}

/// The inverse transpose times the determinant: what turns normals.
fn cofactor(m: &DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn unit_or(v: DVec3, otherwise: Vec3) -> Vec3 {
    v.try_normalize().map_or(otherwise, DVec3::as_vec3)
}
