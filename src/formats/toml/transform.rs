//! Where something stands, as a table tells it.

use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::reader::Table;
use crate::formats::LoadError;

/// A matrix by columns, or else scale, then rotation, then translation.
pub fn transform(table: &Table) -> Result<DAffine3, LoadError> {
    let translate = table.numbers::<3>("translate")?.map(DVec3::from_array);
    let rotate = table.one_of_numbers::<3, 4>("rotate")?;
    let scale = table.scale("scale")?.map(DVec3::from_array);
    if let Some(columns) = table.numbers::<16>("matrix")? {
        if translate.is_some() || rotate.is_some() || scale.is_some() {
            return Err(table.fault("has both a matrix and translate, rotate or scale"));
        }
        let matrix = DMat4::from_cols_array(&columns);
        if matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
            let message = "its columns must end in 0, 0, 0 and 1: the translation comes last";
            return Err(table.fault_at("matrix", message));
        }
        return Ok(DAffine3::from_mat4(matrix));
    }
    let rotation = match rotate {
        None => DQuat::IDENTITY,
        Some(Ok(degrees)) => {
            let [x, y, z] = degrees.map(f64::to_radians);
            DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
        }
        Some(Err(quaternion)) => {
            let quaternion = DQuat::from_array(quaternion);
            if quaternion.length() < 1e-6 {
                return Err(table.fault_at("rotate", "is no rotation: its length is 0"));
            }
            quaternion.normalize()
        }
    };
    let (scale, translate) = (scale.unwrap_or(DVec3::ONE), translate.unwrap_or_default());
    Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translate))
}
