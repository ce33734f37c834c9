//! Floor, lamps and camera.

use serde_json::json;

use super::finish::Finish;
use super::grid::Grid;
use super::machine::Assembly;
use crate::camera::flight::Pose;
use crate::generate::document::perspective;
use crate::generate::model::{Lamp, View, at, facing};
use crate::generate::shape::Quad;
use crate::math::{DVec2, DVec3, Vec3};

/// Puts the machine on a floor between lamps and before a camera.
///
/// Lamps are close: rays between points of the scene's box should mostly meet the machine. They
/// count among the triangles; where there are too few for them a light without extent is left.
pub fn light(a: &mut Assembly, grid: Grid) {
    a.unit = String::from("studio");
    let size = grid.size();
    let (w, h, d) = (0.5 * size.x, size.y, 0.5 * size.z);
    a.put("floor", Finish::Floor, at(0.0, 0.0, 0.0), Quad { half: DVec2::new(w + 0.15, d + 0.2) });
    let mut panel = |point: DVec3, towards: DVec3, half: DVec2| {
        let direction = (towards - point).normalize();
        a.put("lamp", Finish::Lamp, facing(point, direction), Quad { half });
    };
    let middle = DVec3::new(0.0, 0.5 * h, 0.0);
    // Above, in front above the picture's edge, and to the right with its back to the camera.
    panel(DVec3::new(0.0, h + 0.3, 0.0), middle, DVec2::new(0.85 * w, 0.5 * d));
    panel(DVec3::new(0.0, h + 0.3 + 0.1 * d, d + 0.3), middle, DVec2::new(0.9 * w, 0.16));
    panel(DVec3::new(w + 0.25, 0.6 * h, 0.3 * d), middle, DVec2::new(0.5 * d, 0.45 * h));

    let towards = middle.as_vec3();
    let eye = towards + DVec3::new(0.42, 0.2, 1.0).normalize().as_vec3() * distance(size);
    a.model.cameras.push(View { eye, target: towards, lens: perspective(30.0, 4.0 / 3.0) });
    // Half around it, from so far that all of it is small, and a little nearer.
    let around = |i: u16| {
        let (sin, cos) = libm::sincosf(0.6 * f32::from(i) - 0.9);
        let away = distance(size) * (2.0 - 0.12 * f32::from(i));
        let eye = towards + Vec3::new(sin, 0.25 + 0.05 * f32::from(i), cos) * away;
        Pose::new(eye, towards, 30.0)
    };
    a.model.flight = (0..6).map(around).collect();
    a.model.lights.push(Lamp {
        light: json!({ "type": "directional", "intensity": 4.0 }),
        at: (middle + DVec3::new(-0.6, 0.3, 1.0)).as_vec3(),
        towards,
    });
}

/// From the middle, so that all is in the picture, be it a square one.
fn distance(size: DVec3) -> f32 {
    let across = (1.1 * size.x + 0.42 * size.z).max(1.45 * size.y);
    (across * 1.85 + 0.5 * size.z) as f32
}
