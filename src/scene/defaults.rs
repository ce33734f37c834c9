//! What a picture needs and a scene may lack: a camera and light.

use rayon::prelude::*;

use super::{Instance, NamedCamera, Notice, Scene};
use crate::camera::Camera;
use crate::light::Environment;
use crate::math::{Aabb, InstanceId, Vec3, turn_upright};

/// Vertical field of view of the automatic camera, degrees.
pub const AUTOMATIC_YFOV: f32 = 40.0;

/// Radiance of the automatic sky at the horizon.
const SKY_MEAN: f32 = 0.55;
/// How it grows with the direction: brightest above, a little to the left and in front, so that
/// shapes show. White paper under it comes out between 0.3 and 0.8.
const SKY_SLOPE: Vec3 = Vec3::new(-0.12, 0.35, 0.1);

/// The radiance of the automatic sky from a unit direction.
pub fn automatic_sky_radiance(direction: Vec3) -> f32 {
    SKY_MEAN + SKY_SLOPE.dot(direction)
}

impl Scene {
    /// Adds what a picture needs and the scene lacks: a camera that sees all of it in a picture of
    /// `aspect` (width over height), and a neutral sky where nothing shines. What was added is
    /// among the notices.
    ///
    /// # Examples
    /// ```
    /// let mut scene = dapple::Scene::default();
    /// scene.add_defaults(16.0 / 9.0);
    /// assert!(scene.environment.is_some());
    /// assert_eq!(scene.cameras.len(), 1);
    /// ```
    pub fn add_defaults(&mut self, aspect: f32) {
        if let Some((sky, notice)) = automatic_sky(self, "") {
            self.environment = Some(sky);
            self.notices.push(notice);
        }
        if self.cameras.is_empty() {
            let (camera, notice) = automatic_camera(self, Vec3::Y, aspect, "");
            self.cameras.push(NamedCamera {
                name: String::new(),
                aspect: None,
                camera,
                planes: None,
            });
            self.notices.push(notice);
        }
    }
}

/// The box of all triangles in the world, of those that move at some times of the shutter; empty
/// if there are none. Where more vertices are placed than can be looked at in a moment, it is the
/// box of the meshes' boxes, which may be larger.
pub fn bounds(scene: &Scene) -> Aabb {
    const MOST: usize = 200_000_000;
    let used: Vec<Vec<Vec3>> = scene.meshes.par_iter().map(|mesh| mesh.used_positions()).collect();
    let count = |instance: &Instance| used[instance.mesh.index()].len();
    let placed = scene.instances.iter().map(count).fold(0, usize::saturating_add);
    let at_first =
        if placed <= MOST { bounds_of_points(scene, &used) } else { bounds_of_boxes(scene) };
    at_first.union(bounds_of_moving(scene))
}

/// The box of what moves, at some times of the shutter.
fn bounds_of_moving(scene: &Scene) -> Aabb {
    const TIMES: u16 = 16;
    if scene.motion.is_none() {
        return Aabb::EMPTY;
    }
    let ids = (0..scene.instances.len()).into_par_iter().map(InstanceId::from_index);
    let over_time = |id: InstanceId| {
        let mesh = scene.instances[id.index()].mesh;
        let at = |time: f32| {
            let (posed, transform) = (scene.mesh_at(mesh, time), scene.transform_at(id, time));
            let corners = posed.mesh.indices.iter().flatten();
            Aabb::of_points(corners.map(|&i| transform.point(posed.position(i as usize))))
        };
        let times = (1..=TIMES).map(|i| at(f32::from(i) / f32::from(TIMES)));
        times.fold(Aabb::EMPTY, Aabb::union)
    };
    ids.filter(|&id| scene.moves(id)).map(over_time).reduce(|| Aabb::EMPTY, Aabb::union)
}

/// The box of all boxes of placed meshes.
fn bounds_of_boxes(scene: &Scene) -> Aabb {
    let corners: Vec<Vec<Vec3>> =
        scene.meshes.par_iter().map(|mesh| mesh.bounds().corners()).collect();
    bounds_of_points(scene, &corners)
}

/// The box of the points of each mesh, placed.
fn bounds_of_points(scene: &Scene, points: &[Vec<Vec3>]) -> Aabb {
    let placed = |instance: &Instance| {
        let points = points[instance.mesh.index()].iter();
        Aabb::of_points(points.map(|&point| instance.transform.point(point)))
    };
    scene.instances.par_iter().map(placed).reduce(|| Aabb::EMPTY, Aabb::union)
}

/// A camera that sees all of the scene, from the front, a little to the right and above, in a
/// picture of `aspect`, and how to say so. `up` is a unit direction; `file` is for the message.
pub fn automatic_camera(scene: &Scene, up: Vec3, aspect: f32, file: &str) -> (Camera, Notice) {
    let bounds = bounds(scene);
    let camera = Camera::framing_upright(&bounds, up, AUTOMATIC_YFOV.to_radians(), aspect);
    let eye = camera.to_world.translation;
    // To the last bit: who goes on from there starts with the same picture.
    let message = format!(
        "no camera: looking at all of it, as with --look-from {},{},{}",
        eye.x, eye.y, eye.z
    );
    (camera, Notice { place: file.to_owned(), message })
}

/// What to say of a scene without a triangle; none if it has one.
pub fn describe_empty_scene(scene: &Scene, file: &str) -> Option<Notice> {
    let has_triangles =
        |instance: &Instance| !scene.meshes[instance.mesh.index()].indices.is_empty();
    if scene.instances.iter().any(has_triangles) {
        return None;
    }
    let message = "no triangles: there is nothing to see or to hit".to_owned();
    Some(Notice { place: file.to_owned(), message })
}

/// A neutral sky for a scene without any light, brightest above, and how to say so; none if
/// something shines.
pub fn automatic_sky(scene: &Scene, file: &str) -> Option<(Environment, Notice)> {
    if shines(scene) {
        return None;
    }
    let message = "no light: under a neutral sky, brightest above (--light sky, --env)".to_owned();
    Some((neutral_sky(Vec3::Y), Notice { place: file.to_owned(), message }))
}

/// Whether anything in or around a scene is said to shine, whatever its light does.
pub fn shines(scene: &Scene) -> bool {
    let emits = scene.instances.iter().any(|instance| {
        scene.materials[instance.material.index()].is_emissive()
            && !scene.meshes[instance.mesh.index()].indices.is_empty()
    });
    emits || !scene.lights.is_empty() || scene.environment.is_some()
}

/// A neutral sky, brightest above: [`automatic_sky_radiance`], turned to where `up` is.
pub fn neutral_sky(up: Vec3) -> Environment {
    let to_sky = turn_upright(up).transpose();
    const HEIGHT: usize = 64;
    const WIDTH: usize = 2 * HEIGHT;
    let pixel = |i: usize| {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let longitude = ((x as f32 + 0.5) / WIDTH as f32 - 0.5) * std::f32::consts::TAU;
        let latitude = (0.5 - (y as f32 + 0.5) / HEIGHT as f32) * std::f32::consts::PI;
        let (sin, cos) = (libm::sinf(latitude), libm::cosf(latitude));
        let across = Vec3::new(libm::sinf(longitude), 0.0, -libm::cosf(longitude));
        [automatic_sky_radiance(to_sky * (across * cos + Vec3::Y * sin)); 3]
    };
    Environment::image(WIDTH, HEIGHT, (0..WIDTH * HEIGHT).map(pixel).collect(), 1.0, 0.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Material, Transform};
    use super::*;
    use crate::geom::Mesh;
    use crate::math::{Affine3A, MaterialId, MeshId};

    /// A triangle of side `size` at `at`, beside a vertex far away that nothing uses.
    fn scene(size: f32, at: Vec3) -> Scene {
        let positions = vec![Vec3::ZERO, Vec3::X * size, Vec3::Y * size, Vec3::splat(1e9)];
        let mesh = Mesh { positions, indices: vec![[0, 1, 2]], ..Mesh::default() };
        let transform = Transform::new(Affine3A::from_translation(at));
        let (mesh_id, material) = (MeshId::from_index(0), MaterialId::from_index(0));
        Scene {
            meshes: vec![Arc::new(mesh)],
            instances: vec![Instance { mesh: mesh_id, material, transform }],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    #[test]
    fn the_automatic_camera_sees_all_of_the_scene() {
        for (size, at) in [(1.0, Vec3::ZERO), (1e-3, Vec3::X), (1e5, Vec3::new(3e6, 0.0, -1e6))] {
            for aspect in [0.5, 1.0, 2.0] {
                let scene = scene(size, at);
                let box_of_it = bounds(&scene);
                assert_eq!(box_of_it.min, at);
                let (camera, _) = automatic_camera(&scene, Vec3::Y, aspect, "a.obj");
                let half_y = libm::tanf(0.5 * AUTOMATIC_YFOV.to_radians());
                let to_camera = camera.to_world.inverse();
                for corner in [at, at + Vec3::X * size, at + Vec3::Y * size] {
                    let p = to_camera.transform_point3(corner);
                    let (x, y) = (p.x / -p.z / (half_y * aspect), p.y / -p.z / half_y);
                    assert!(p.z < 0.0 && x.abs() < 1.0 && y.abs() < 1.0, "{x} {y}");
                }
            }
        }
    }

    #[test]
    fn who_pastes_the_automatic_cameras_place_stands_there() {
        let scene = scene(1e-3, Vec3::new(0.1, 1e-7, -77.3));
        let (camera, notice) = automatic_camera(&scene, Vec3::Y, 1.5, "a.obj");
        let (_, place) = notice.message.split_once("--look-from ").expect("it says where");
        let place: Vec<f32> = place.split(',').map(|x| x.parse().expect("a number")).collect();
        assert_eq!(place, camera.to_world.translation.to_array());
        let centre = bounds(&scene).centre();
        let yfov = AUTOMATIC_YFOV.to_radians();
        assert_eq!(Camera::look_at(Vec3::from_slice(&place), centre, Vec3::Y, yfov), camera);
    }

    #[test]
    fn with_z_up_camera_and_sky_turn() {
        let scene = scene(1.0, Vec3::ZERO);
        let (camera, _) = automatic_camera(&scene, Vec3::Z, 1.0, "a.obj");
        let turned = camera.to_world.matrix3;
        // From the front, which is -Y, from above, and upright.
        assert!(camera.to_world.translation.y < 0.0 && camera.to_world.translation.z > 0.0);
        assert!(turned.x_axis.z.abs() < 1e-6 && turned.y_axis.z > 0.5, "{turned:?}");
        let sky = neutral_sky(Vec3::Z);
        let radiance = |direction| sky.radiance(direction).x;
        assert!(radiance(Vec3::Z) > radiance(Vec3::Y) && radiance(Vec3::Y) > radiance(-Vec3::Z));
        assert!((radiance(Vec3::Z) - automatic_sky_radiance(Vec3::Y)).abs() < 0.01);
    }

    #[test]
    fn boxes_of_boxes_hold_all_triangles() {
        let mut scene = scene(2.0, Vec3::new(1.0, -3.0, 0.5));
        let turned =
            Affine3A::from_rotation_z(0.7) * Affine3A::from_scale(Vec3::new(-1.0, 2.0, 3.0));
        let transform = Transform::new(turned);
        scene.instances.push(Instance { transform, ..scene.instances[0].clone() });
        scene.meshes.push(Arc::new(Mesh::default()));
        let mesh = MeshId::from_index(1);
        scene.instances.push(Instance { mesh, ..scene.instances[0].clone() });
        let (exact, outer) = (bounds(&scene), bounds_of_boxes(&scene));
        assert!(outer.min.cmple(exact.min).all() && outer.max.cmpge(exact.max).all());
        assert!(outer.extent().max_element() < 2.0 * exact.extent().max_element());
    }

    #[test]
    fn a_scene_without_triangles_is_told_of() {
        assert_eq!(describe_empty_scene(&scene(1.0, Vec3::ZERO), "a.obj"), None);
        let notice = describe_empty_scene(&Scene::default(), "a.obj").expect("it is empty");
        assert!(notice.message.starts_with("no triangles"), "{notice:?}");
    }

    #[test]
    fn the_automatic_sky_shines_where_nothing_else_does() {
        let mut scene = scene(1.0, Vec3::ZERO);
        let (sky, notice) = automatic_sky(&scene, "a.obj").expect("nothing shines");
        for direction in [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::new(-0.48, 0.6, 0.64)] {
            let radiance = sky.radiance(direction);
            assert!((radiance.x - automatic_sky_radiance(direction)).abs() < 0.01, "{radiance}");
            assert!(radiance.x == radiance.y && radiance.y == radiance.z, "it is grey");
        }
        assert!(notice.message.starts_with("no light: under a neutral sky"), "{notice:?}");
        scene.materials[0].emissive = Vec3::X;
        assert!(automatic_sky(&scene, "a.obj").is_none());
        scene.materials[0].emissive = Vec3::ZERO;
        scene.environment = Some(Environment::constant(Vec3::ONE));
        assert!(automatic_sky(&scene, "a.obj").is_none());
    }
}
