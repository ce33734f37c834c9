//! Near and far planes of cameras, which nothing is cut at here. Where they would cut something
//! away that the camera frames, that is said.

use super::notices::Notices;
use crate::camera::{Camera, Projection};
use crate::geom::Mesh;
use crate::math::{Aabb, Affine3A, Vec3};
use crate::scene::Scene;

/// Where a file says that a camera's sight begins and ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    /// The JSON pointer to the lens.
    pub place: String,
    /// Metres.
    pub near: f32,
    /// Metres; none: no end.
    pub far: Option<f32>,
}

/// Beyond this many triangles it is not looked at more closely, and said that something is cut.
const MOST_TRIANGLES: usize = 1 << 26;

/// What is nearer than a plane by less than this share is not told from what is on it.
const SLACK: f32 = 1e-4;

impl Planes {
    /// Notes what a camera would not see if its planes were honoured. `aspect` is width over height
    /// of its picture.
    pub fn note(&self, camera: &Camera, aspect: f32, scene: &Scene, notices: &mut Notices) {
        let Some(sides) = sides(camera, aspect) else { return };
        let mut say = |key: &str, message: String| {
            notices.add(format!("{}/{key}", self.place), message);
        };
        // Depth counts along -Z.
        let before = Side { normal: Vec3::Z, offset: self.near * (1.0 - SLACK) };
        let ahead = Side { normal: Vec3::NEG_Z, offset: 0.0 };
        let near = [&sides[..], &[before, ahead]].concat();
        if self.near > 0.0 && touches(&near, camera, scene) {
            let near = self.near;
            say("znear", format!("what is nearer than {near} is seen nevertheless"));
        }
        let Some(far) = self.far else { return };
        let beyond = Side { normal: Vec3::NEG_Z, offset: -far * (1.0 + SLACK) };
        if touches(&[&sides[..], &[beyond]].concat(), camera, scene) {
            say("zfar", format!("what is beyond {far} is seen nevertheless"));
        }
    }
}

/// The half of space where `normal . p + offset` is above 0.
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: Vec3,
    offset: f32,
}

impl Side {
    fn distance(&self, point: Vec3) -> f32 {
        self.normal.dot(point) + self.offset
    }
}

/// What bounds a camera's frame, in its own space.
fn sides(camera: &Camera, aspect: f32) -> Option<Vec<Side>> {
    let side = |normal: Vec3, offset: f32| Side { normal, offset };
    Some(match camera.projection {
        Projection::Perspective { yfov } => {
            let up = libm::tanf(0.5 * yfov);
            let (x, y) = (up * aspect, up);
            [(1.0, 0.0, x), (-1.0, 0.0, x), (0.0, 1.0, y), (0.0, -1.0, y)]
                .map(|(a, b, tangent)| side(Vec3::new(a, b, -tangent), 0.0))
                .to_vec()
        }
        Projection::Orthographic { xmag, ymag } => {
            [(Vec3::X, xmag), (Vec3::NEG_X, xmag), (Vec3::Y, ymag), (Vec3::NEG_Y, ymag)]
                .map(|(normal, reach)| side(normal, reach))
                .to_vec()
        }
        Projection::Panorama => return None,
    })
}

/// Whether any triangle is in part within all sides.
fn touches(sides: &[Side], camera: &Camera, scene: &Scene) -> bool {
    let from_world = camera.to_world.inverse();
    let boxes: Vec<Aabb> = scene.meshes.iter().map(|mesh| mesh.bounds()).collect();
    let mut looked_at = 0;
    scene.instances.iter().any(|instance| {
        let to_camera = from_world * instance.transform.to_world();
        let bounds = boxes[instance.mesh.index()];
        let corners = corners(bounds).map(|corner| to_camera.transform_point3(corner));
        if is_beyond(sides, &corners) {
            return false;
        }
        let mesh = &scene.meshes[instance.mesh.index()];
        looked_at += mesh.indices.len();
        looked_at > MOST_TRIANGLES || mesh_touches(sides, mesh, &to_camera)
    })
}

fn corners(bounds: Aabb) -> [Vec3; 8] {
    std::array::from_fn(|k| {
        let pick = |axis: usize| if k >> axis & 1 == 0 { bounds.min } else { bounds.max }[axis];
        Vec3::new(pick(0), pick(1), pick(2))
    })
}

/// Whether all points are on the other side of one of the sides.
fn is_beyond(sides: &[Side], points: &[Vec3]) -> bool {
    sides.iter().any(|side| points.iter().all(|&point| side.distance(point) <= 0.0))
}

fn mesh_touches(sides: &[Side], mesh: &Mesh, to_camera: &Affine3A) -> bool {
    mesh.indices.iter().any(|triangle| {
        let points =
            triangle.map(|vertex| to_camera.transform_point3(mesh.positions[vertex as usize]));
        if is_beyond(sides, &points) {
            return false;
        }
        let mut left = points.to_vec();
        for side in sides {
            left = cut(side, &left);
        }
        left.len() >= 3
    })
}

/// What of a convex polygon is on a side (Sutherland and Hodgman, 1974).
fn cut(side: &Side, polygon: &[Vec3]) -> Vec<Vec3> {
    let mut left = Vec::with_capacity(polygon.len() + 1);
    for (k, &b) in polygon.iter().enumerate() {
        let a = polygon[(k + polygon.len() - 1) % polygon.len()];
        let (of_a, of_b) = (side.distance(a), side.distance(b));
        if (of_a > 0.0) != (of_b > 0.0) {
            left.push(a + (b - a) * (of_a / (of_a - of_b)));
        }
        if of_b > 0.0 {
            left.push(b);
        }
    }
    left
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::math::{MaterialId, MeshId};
    use crate::scene::{Instance, Transform};

    /// A triangle across the view, of that size, in that depth before a camera at the origin.
    fn said(depth: f32, at: [f32; 2], size: f32, projection: Projection) -> Vec<String> {
        let [x, y] = at;
        let corner = |a: f32, b: f32| Vec3::new(x + a * size, y + b * size, -depth);
        let mesh = Mesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(0.0, 1.0)],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let instance = Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(Affine3A::IDENTITY),
        };
        let meshes = vec![Arc::new(mesh)];
        let scene = Scene { meshes, instances: vec![instance], ..Scene::default() };
        let camera = Camera { projection, to_world: Affine3A::IDENTITY, lens: None };
        let planes = Planes { place: "/cameras/0/lens".to_owned(), near: 1.0, far: Some(10.0) };
        let mut notices = Notices::default();
        planes.note(&camera, 1.0, &scene, &mut notices);
        let all = notices.finish(std::path::Path::new("a"));
        all.into_iter().map(|notice| format!("{} {}", notice.place, notice.message)).collect()
    }

    const LENS: Projection = Projection::Perspective { yfov: std::f32::consts::FRAC_PI_2 };

    #[test]
    fn what_the_planes_would_cut_is_said() {
        let near = ["a: /cameras/0/lens/znear what is nearer than 1 is seen nevertheless"];
        let far = ["a: /cameras/0/lens/zfar what is beyond 10 is seen nevertheless"];
        let box_lens = Projection::Orthographic { xmag: 1.0, ymag: 1.0 };
        for lens in [LENS, box_lens] {
            assert_eq!(said(0.5, [0.0; 2], 0.1, lens), near);
            // None of its corners is in sight.
            assert_eq!(said(0.5, [0.0; 2], 50.0, lens), near);
            assert_eq!(said(20.0, [0.0; 2], 0.1, lens), far);
            assert!(said(5.0, [0.0; 2], 0.1, lens).is_empty());
            assert!(said(-0.5, [0.0; 2], 0.1, lens).is_empty(), "behind the camera");
            assert!(said(0.5, [9.0, 0.0], 0.1, lens).is_empty(), "beside the frame");
        }
        // Its box reaches into the frame, itself it does not.
        assert!(said(0.5, [-1.3, -1.3], 0.9, LENS).is_empty());
    }
}
