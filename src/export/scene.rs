//! Meshes and where they are placed, cameras and lights.

use std::collections::HashMap;
use std::io::{self, Write};

use serde_json::{Value, json};

use super::binary::{Binary, Chunk};
use super::image::Images;
use super::material::write_material;
use super::object::{named, next_power_of_two};
use crate::camera::{Camera, Projection};
use crate::geom::Mesh;
use crate::light::{Punctual, PunctualKind};
use crate::math::{Aabb, Affine3A, Frame, Mat3, MeshId, Vec2};
use crate::scene::{NamedCamera, Scene};

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Triangles, each mesh once.
    pub triangles: u64,
    /// Placed meshes.
    pub placements: u64,
    /// Images.
    pub images: u64,
    /// Of the file.
    pub bytes: u64,
    /// What glTF has no place for and was left out.
    pub left_out: Vec<String>,
}

/// Writes a scene as binary glTF 2.0. Placed meshes become nodes in their order, with a matrix
/// each, so that triangles keep their numbers.
///
/// # Errors
/// Those of `out`, and a file that would exceed the 4 GiB of the format.
pub fn write(scene: &Scene, out: &mut dyn Write) -> io::Result<Exported> {
    let mut left_out = Vec::new();
    let mut binary = Binary::default();
    let mut images = Images::new(scene);
    for material in &scene.materials {
        let material = write_material(material, &mut images, &mut left_out);
        binary.document.push("materials", material);
    }
    let empty_uvs = first_sets(scene);
    let mut meshes = Meshes { scene, empty_uvs: &empty_uvs, shared: HashMap::new() };
    let mut numbers = HashMap::new();
    for instance in &scene.instances {
        let key = (instance.mesh, instance.material);
        let mesh = *numbers.entry(key).or_insert_with(|| {
            let primitive = meshes.primitive(&mut binary, instance.mesh, instance.material.index());
            let name = &scene.meshes[instance.mesh.index()].name;
            binary.document.push("meshes", named(name, json!({ "primitives": [primitive] })))
        });
        let matrix = instance.transform.to_world();
        binary.document.root(at(matrix, json!({ "mesh": mesh })));
    }
    for camera in &scene.cameras {
        match lens(camera) {
            Some(lens) => {
                let camera_number = binary.document.push("cameras", named(&camera.name, lens));
                let node = json!({ "camera": camera_number });
                binary.document.root(named(&camera.name, at(camera.camera.to_world, node)));
            }
            None => left_out.push(format!("camera {:?}: a panorama", camera.name)),
        }
        if camera.camera.lens.is_some() {
            left_out.push(format!("camera {:?}: its aperture", camera.name));
        }
    }
    for light in &scene.lights {
        let number = binary.document.punctual(punctual(light));
        let node = json!({ "extensions": { "KHR_lights_punctual": { "light": number } } });
        binary.document.root(at(towards(light), node));
    }
    if scene.environment.is_some() {
        left_out.push("what shines from all around: render with --env or --sky".to_owned());
    }
    if scene.medium.is_some() {
        left_out.push("the medium that fills all space".to_owned());
    }
    if scene.motion.is_some() {
        left_out.push("what moves while the shutter is open".to_owned());
    }
    let count = images.write(&mut binary, &mut left_out)?;
    Ok(Exported {
        triangles: meshes.shared.keys().map(|mesh| triangles(scene, *mesh)).sum(),
        placements: scene.instances.len() as u64,
        images: count,
        bytes: binary.write(out)?,
        left_out,
    })
}

fn triangles(scene: &Scene, mesh: MeshId) -> u64 {
    scene.meshes[mesh.index()].indices.len() as u64
}

/// For meshes that have the second set of texture coordinates alone, a first one.
fn first_sets(scene: &Scene) -> HashMap<usize, Vec<Vec2>> {
    let needs = |mesh: &Mesh| mesh.uvs[0].is_empty() && !mesh.uvs[1].is_empty();
    let meshes = scene.meshes.iter().enumerate().filter(|(_, mesh)| needs(mesh));
    meshes.map(|(number, mesh)| (number, vec![Vec2::ZERO; mesh.positions.len()])).collect()
}

/// The meshes that are written, each with its accessors.
struct Meshes<'a> {
    scene: &'a Scene,
    empty_uvs: &'a HashMap<usize, Vec<Vec2>>,
    shared: HashMap<MeshId, Value>,
}

impl<'a> Meshes<'a> {
    /// A mesh of a material.
    fn primitive(&mut self, binary: &mut Binary<'a>, mesh: MeshId, material: usize) -> Value {
        let (scene, empty) = (self.scene, self.empty_uvs);
        let shared = self.shared.entry(mesh).or_insert_with(|| {
            let first_uvs = empty.get(&mesh.index()).map(Vec::as_slice);
            accessors(binary, &scene.meshes[mesh.index()], first_uvs)
        });
        let mut primitive = shared.clone();
        primitive["material"] = material.into();
        primitive
    }
}

fn accessors<'a>(binary: &mut Binary<'a>, mesh: &'a Mesh, first_uvs: Option<&'a [Vec2]>) -> Value {
    let mut attributes = json!({});
    let mut attribute = |name: &str, accessor: Option<usize>| {
        if let Some(accessor) = accessor {
            attributes[name] = accessor.into();
        }
    };
    let positions = binary.accessor(Chunk::Vec3(&mesh.positions));
    if let Some(positions) = positions {
        let bounds = Aabb::of_points(mesh.positions.iter().copied());
        binary.bound(positions, [bounds.min, bounds.max]);
    }
    attribute("POSITION", positions);
    attribute("NORMAL", binary.accessor(Chunk::Vec3(&mesh.normals)));
    attribute("TANGENT", binary.accessor(Chunk::Vec4(&mesh.tangents)));
    let first = first_uvs.unwrap_or(&mesh.uvs[0]);
    attribute("TEXCOORD_0", binary.accessor(Chunk::Vec2(first)));
    attribute("TEXCOORD_1", binary.accessor(Chunk::Vec2(&mesh.uvs[1])));
    attribute("COLOR_0", binary.accessor(Chunk::Vec4(&mesh.colors)));
    let mut primitive = json!({ "attributes": attributes });
    if let Some(indices) = binary.accessor(Chunk::Indices(&mesh.indices)) {
        primitive["indices"] = indices.into();
    }
    primitive
}

/// A node at a place.
fn at(to_world: Affine3A, mut node: Value) -> Value {
    if to_world != Affine3A::IDENTITY {
        let [x, y, z] = to_world.matrix3.to_cols_array_2d();
        let t = to_world.translation;
        let columns = [[x[0], x[1], x[2], 0.0], [y[0], y[1], y[2], 0.0], [z[0], z[1], z[2], 0.0]];
        let last = [t.x, t.y, t.z, 1.0];
        node["matrix"] = json!([columns[0], columns[1], columns[2], last].concat());
    }
    node
}

/// glTF's camera; `None` for what it has none.
fn lens(NamedCamera { camera, aspect, .. }: &NamedCamera) -> Option<Value> {
    let Camera { projection, .. } = camera;
    match *projection {
        Projection::Perspective { yfov } => {
            let mut view = json!({ "yfov": yfov, "znear": 0.01 });
            if let Some(aspect) = aspect {
                view["aspectRatio"] = json!(aspect);
            }
            Some(json!({ "type": "perspective", "perspective": view }))
        }
        Projection::Orthographic { xmag, ymag } => {
            let view = json!({ "xmag": xmag, "ymag": ymag, "znear": 0.0, "zfar": 1e6 });
            Some(json!({ "type": "orthographic", "orthographic": view }))
        }
        Projection::Panorama => None,
    }
}

/// glTF's light.
fn punctual(light: &Punctual) -> Value {
    // The power of two next above makes factor and strength exact.
    let strength = next_power_of_two(light.intensity.max_element());
    let color = light.intensity / strength;
    let mut object = json!({ "color": color.to_array(), "intensity": strength });
    match light.kind {
        PunctualKind::Point => object["type"] = "point".into(),
        PunctualKind::Directional => object["type"] = "directional".into(),
        PunctualKind::Spot { inner, outer } => {
            object["type"] = "spot".into();
            object["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
        }
    }
    if let Some(range) = light.range {
        object["range"] = json!(range);
    }
    object
}

/// Where a light stands, with its -Z the way that it shines.
fn towards(light: &Punctual) -> Affine3A {
    let Frame { tangent, bitangent, normal } = Frame::from_normal(-light.direction);
    Affine3A::from_mat3_translation(Mat3::from_cols(tangent, bitangent, normal), light.position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn lights_keep_their_direction() {
        let direction = Vec3::new(0.6, -0.48, 0.64);
        let light = Punctual {
            kind: PunctualKind::Directional,
            position: Vec3::ZERO,
            direction,
            intensity: Vec3::ONE,
            range: None,
        };
        let back = towards(&light).matrix3.z_axis;
        assert_eq!(Vec3::from(-back), direction);
    }
}
