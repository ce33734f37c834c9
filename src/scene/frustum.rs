//! What of a scene lies within a camera's frame, and in which depth.

use super::Scene;
use crate::camera::{Camera, Projection};
use crate::geom::Mesh;
use crate::math::{Aabb, Affine3A, Vec3};

/// Beyond this many triangles it is not looked at more closely, and all of a mesh counts as seen.
const MOST_TRIANGLES: usize = 1 << 26;

/// Beyond so many, boxes are taken for what is in them where depths are asked for.
const MOST_CUT: usize = 1 << 22;

/// The half of space where `normal . p + offset` is above 0.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// Of unit length or not.
    pub normal: Vec3,
    /// What is added.
    pub offset: f32,
}

impl Side {
    fn distance(&self, point: Vec3) -> f32 {
        self.normal.dot(point) + self.offset
    }
}

/// What bounds a camera's frame, in its own space; `aspect` is width over height of its picture.
pub fn sides(camera: &Camera, aspect: f32) -> Option<Vec<Side>> {
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

/// Whether any triangle is in part within all sides, which are in the camera's space.
pub fn touches(sides: &[Side], camera: &Camera, scene: &Scene) -> bool {
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
        inside(sides, &points).len() >= 3
    })
}

/// How far before a camera, along -Z, the nearest and the farthest is that lies within its frame;
/// `None` where nothing does.
pub fn depths(camera: &Camera, aspect: f32, scene: &Scene) -> Option<[f32; 2]> {
    let mut sides = sides(camera, aspect)?;
    sides.push(Side { normal: Vec3::NEG_Z, offset: 0.0 });
    let from_world = camera.to_world.inverse();
    let boxes: Vec<Aabb> = scene.meshes.iter().map(|mesh| mesh.bounds()).collect();
    let (mut nearest, mut farthest) = (f32::INFINITY, 0.0_f32);
    let mut widen = |points: &[Vec3]| {
        for point in points {
            nearest = nearest.min(-point.z);
            farthest = farthest.max(-point.z);
        }
    };
    let mut looked_at = 0;
    for instance in &scene.instances {
        let to_camera = from_world * instance.transform.to_world();
        let corners = corners(boxes[instance.mesh.index()]);
        let corners = corners.map(|corner| to_camera.transform_point3(corner));
        if is_beyond(&sides, &corners) {
            continue;
        }
        looked_at += scene.meshes[instance.mesh.index()].indices.len();
        if looked_at > MOST_CUT {
            widen(&corners.map(|corner| corner.min(Vec3::new(f32::MAX, f32::MAX, 0.0))));
            continue;
        }
        let mesh = &scene.meshes[instance.mesh.index()];
        for triangle in &mesh.indices {
            let place = |vertex: u32| to_camera.transform_point3(mesh.positions[vertex as usize]);
            widen(&inside(&sides, &triangle.map(place)));
        }
    }
    (nearest <= farthest).then_some([nearest, farthest])
}

/// What of a triangle is within all sides: a convex polygon.
fn inside(sides: &[Side], triangle: &[Vec3; 3]) -> Vec<Vec3> {
    if is_beyond(sides, triangle) {
        return Vec::new();
    }
    sides.iter().fold(triangle.to_vec(), |left, side| cut(side, &left))
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
    use super::*;

    /// A floor below the camera that reaches far behind and before it.
    #[test]
    fn depths_are_those_of_what_is_in_the_frame() {
        let corner = |x: f32, z: f32| Vec3::new(x, -1.0, z);
        let mesh = Mesh {
            positions: vec![corner(-1e3, 100.0), corner(1e3, 100.0), corner(0.0, -50.0)],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let scene = Scene::of_mesh(mesh);
        let right = Projection::Perspective { yfov: std::f32::consts::FRAC_PI_2 };
        let camera = |projection| Camera { projection, to_world: Affine3A::IDENTITY, lens: None };
        let [near, far] = depths(&camera(right), 1.0, &scene).expect("it is seen");
        assert!((near - 1.0).abs() < 1e-4 && (far - 50.0).abs() < 1e-3, "{near} {far}");
        let narrow = Projection::Orthographic { xmag: 0.5, ymag: 0.5 };
        assert_eq!(depths(&camera(narrow), 1.0, &scene), None);
        assert_eq!(depths(&camera(Projection::Panorama), 1.0, &scene), None);
    }
}
