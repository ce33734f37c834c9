//! The shape of a primitive as its morph targets and its skin bend it.

use glam::DAffine3;

use super::json::Fault;
use super::mesh::Primitive;
use super::notices::Notices;
use super::primitive;
use super::read::Storage;
use super::skin;
use crate::geom::Mesh;

/// Builds the mesh of a primitive, whose weights are settled, and bends it as the matrices of its
/// skin tell, if there are any.
///
/// # Errors
/// What is wrong with its accessors.
pub fn shape(
    primitive: &Primitive,
    matrices: Option<&[DAffine3]>,
    storage: &Storage,
    notices: &mut Notices,
) -> Result<Mesh, Fault> {
    let mut mesh = primitive::build(primitive, "", storage, notices)?;
    if let Some(matrices) = matrices {
        skin::pose(&mut mesh, primitive, matrices, storage)?;
    }
    Ok(mesh)
}
