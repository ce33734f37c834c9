//! What is left of a transform of something without size.

use glam::{DAffine3, DMat3};

use super::path::Motion;

/// Where something stands that has no size, such as a camera: without scale, mirroring and shear,
/// looking along the node's -Z with its +Y up. None if the node has no such directions.
pub fn rigid(to_world: &DAffine3) -> Option<DAffine3> {
    let z = to_world.matrix3.z_axis.try_normalize()?;
    let x = to_world.matrix3.y_axis.cross(z).try_normalize()?;
    let matrix3 = DMat3::from_cols(x, z.cross(x), z);
    let translation = to_world.translation;
    (matrix3.is_finite() && translation.is_finite()).then_some(DAffine3 { matrix3, translation })
}

impl Motion {
    /// Where something stands that has no size, at a `time` from 0 to 1; see [`rigid`].
    pub fn rigid_at(&self, time: f32) -> Option<DAffine3> {
        rigid(&self.at(f64::from(time)))
    }
}
