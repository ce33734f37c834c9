//! Cameras and their planes.

use serde_json::{Value, json};

use crate::camera::{Camera, Projection};
use crate::scene::{ClipPlanes, NamedCamera, Scene, frustum};

/// The nearest plane that is written where nothing is near.
const NEAR: f32 = 0.01;

/// Width over height of the widest picture that planes are chosen for where no camera tells it.
const WIDEST: f32 = 4.0;

/// glTF's camera; `None` for what it has none.
pub fn lens(scene: &Scene, named: &NamedCamera) -> Option<Value> {
    let NamedCamera { camera, aspect, .. } = named;
    let Camera { projection, .. } = camera;
    match *projection {
        Projection::Perspective { yfov } => {
            let ClipPlanes { near, far } = planes(scene, named);
            let mut view = json!({ "yfov": yfov, "znear": near });
            if let Some(far) = far {
                view["zfar"] = json!(far);
            }
            if let Some(aspect) = aspect {
                view["aspectRatio"] = json!(aspect);
            }
            Some(json!({ "type": "perspective", "perspective": view }))
        }
        Projection::Orthographic { xmag, ymag } => {
            let ClipPlanes { near, far } = planes(scene, named);
            let view = json!({ "xmag": xmag, "ymag": ymag, "znear": near, "zfar": far });
            Some(json!({ "type": "orthographic", "orthographic": view }))
        }
        Projection::Panorama => None,
    }
}

/// The planes that the camera's file had; else such that they cut nothing of the scene away.
fn planes(scene: &Scene, named: &NamedCamera) -> ClipPlanes {
    if let Some(planes) = named.planes {
        return planes;
    }
    let NamedCamera { camera, aspect, .. } = named;
    let depths = frustum::depths(camera, aspect.unwrap_or(WIDEST), scene);
    if let Projection::Orthographic { .. } = camera.projection {
        // All of these have an end.
        let far = depths.map_or(1.0, |[_, farthest]| 2.0 * farthest);
        let far = far.clamp(f32::MIN_POSITIVE, f32::MAX);
        return ClipPlanes { near: 0.0, far: Some(far) };
    }
    // Halfway, so that rounding cuts nothing either.
    let near = depths.map_or(NEAR, |[nearest, _]| (0.5 * nearest).min(NEAR));
    ClipPlanes { near: near.max(f32::MIN_POSITIVE), far: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Mesh;
    use crate::math::{Affine3A, Vec3};

    /// A triangle in that depth.
    fn scene(depth: f32) -> Scene {
        let corner = |x: f32, y: f32| Vec3::new(x * depth, y * depth, -depth);
        let mesh = Mesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        Scene::of_mesh(mesh)
    }

    fn camera(projection: Projection, planes: Option<ClipPlanes>) -> NamedCamera {
        let camera = Camera { projection, to_world: Affine3A::IDENTITY, lens: None };
        NamedCamera { name: String::new(), aspect: None, camera, planes }
    }

    #[test]
    fn a_files_own_planes_are_kept() {
        let own = ClipPlanes { near: 1e-4, far: Some(7.5) };
        let written = lens(&scene(3.0), &camera(Projection::Perspective { yfov: 1.0 }, Some(own)));
        let lens = &written.expect("it has one")["perspective"];
        assert_eq!((&lens["znear"], &lens["zfar"]), (&json!(1e-4_f32), &json!(7.5)));
    }

    #[test]
    fn others_cut_nothing() {
        let lens_at = |depth: f32, projection| {
            lens(&scene(depth), &camera(projection, None)).expect("it has one")
        };
        for depth in [1e-20, 1e-4, 1.0, 1e6, 1e30_f32] {
            let lens = lens_at(depth, Projection::Perspective { yfov: 1.0 });
            let near = lens["perspective"]["znear"].as_f64().expect("a number") as f32;
            assert!(near > 0.0 && near <= 0.51 * depth, "{depth}: {near}");
            assert!(lens["perspective"].get("zfar").is_none());
            let box_lens = Projection::Orthographic { xmag: depth, ymag: depth };
            let lens = lens_at(depth, box_lens);
            let far = lens["orthographic"]["zfar"].as_f64().expect("a number") as f32;
            assert!(far > 1.9 * depth && lens["orthographic"]["znear"] == 0.0, "{depth}: {far}");
        }
        let empty = lens(&Scene::default(), &camera(Projection::Perspective { yfov: 1.0 }, None));
        assert_eq!(empty.expect("it has one")["perspective"]["znear"], json!(0.01_f32));
    }
}
