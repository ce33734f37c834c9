//! What a generator makes: parts, not yet triangles.

use serde_json::Value;

use super::shape::Shape;
use crate::camera::flight::Pose;
use crate::math::{DAffine3, DVec3, Vec3};

/// A scene by its parts.
#[derive(Debug, Default)]
pub struct Model {
    /// glTF's objects.
    pub materials: Vec<Value>,
    /// What is made of triangles; where these are few, parts that need many for their size stay
    /// away.
    pub parts: Vec<Part>,
    /// Views, the first of which is the default.
    pub cameras: Vec<View>,
    /// Cameras that a flight leads through; see
    /// [`flight::through`](crate::camera::flight::through).
    pub flight: Vec<Pose>,
    /// Lights without extent.
    pub lights: Vec<Lamp>,
    /// What takes the triangles that are left over, in the way of [`Ribbon`](super::shape::Ribbon):
    /// of any number.
    pub rest: Option<Part>,
}

/// A shape at its place.
#[derive(Debug)]
pub struct Part {
    /// For the node.
    pub name: String,
    /// Index of its material.
    pub material: usize,
    /// A turn and a shift.
    pub place: DAffine3,
    /// What it looks like.
    pub shape: Box<dyn Shape>,
}

/// A camera.
#[derive(Debug)]
pub struct View {
    /// Where it stands.
    pub eye: Vec3,
    /// What it looks at.
    pub target: Vec3,
    /// glTF's object.
    pub lens: Value,
}

/// A light of KHR_lights_punctual.
#[derive(Debug)]
pub struct Lamp {
    /// glTF's object.
    pub light: Value,
    /// Where it is.
    pub at: Vec3,
    /// Where it shines.
    pub towards: Vec3,
}

/// A shift.
pub fn at(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A shift to `point` and a turn of +Y to `direction`, a unit vector.
pub fn facing(point: DVec3, direction: DVec3) -> DAffine3 {
    // Along the axes, which is where most parts face, the turn is without rounding.
    let (x, z) = if direction.y.abs() > 0.9 {
        let x = DVec3::X * direction.y.signum();
        let x = (x - direction * direction.dot(x)).normalize();
        (x, x.cross(direction))
    } else {
        let x = direction.cross(DVec3::Y).normalize();
        (x, x.cross(direction))
    };
    DAffine3::from_mat3_translation(crate::math::DMat3::from_cols(x, direction, z), point)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facing_is_a_turn_without_a_mirror() {
        for direction in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::ONE] {
            let direction = direction.normalize();
            let turn = facing(DVec3::ONE, direction);
            assert!((turn.transform_vector3(DVec3::Y) - direction).length() < 1e-12);
            assert!((turn.matrix3.determinant() - 1.0).abs() < 1e-12, "{direction}");
        }
    }
}
