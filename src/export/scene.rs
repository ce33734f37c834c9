//! Meshes and where they are placed, cameras and lights.

use std::collections::{HashMap, HashSet};
use std::io::{self, Write};

use serde_json::{Value, json};

use super::binary::{Binary, Chunk};
use super::camera;
use super::image::Images;
use super::material::write_material;
use super::object::{named, next_power_of_two};
use crate::geom::Mesh;
use crate::light::{Punctual, PunctualKind};
use crate::math::{Aabb, Affine3A, Frame, Mat3, MeshId, Vec2};
use crate::scene::{Scene, TextureRef};

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Exported {
    /// Triangles, each mesh once.
    pub triangles: u64,
    /// Placed meshes.
    pub placements: u64,
    /// Images.
    pub images: u64,
    /// Of the file.
    pub bytes: u64,
    /// What glTF has no place for, and animations: what was left out.
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
    let empty_uvs = empty_sets(scene);
    let mut meshes = Meshes { scene, empty_uvs: &empty_uvs, shared: HashMap::new() };
    let mut numbers = HashMap::new();
    let mut placements = 0;
    for instance in &scene.instances {
        // Without indices it would be read as triangles of whatever points it has.
        if triangles(scene, instance.mesh) == 0 {
            continue;
        }
        placements += 1;
        let key = (instance.mesh, instance.material);
        let mesh = *numbers.entry(key).or_insert_with(|| {
            let primitive = meshes.primitive(&mut binary, instance.mesh, instance.material.index());
            let name = &scene.meshes[instance.mesh.index()].name;
            binary.document.push("meshes", named(name, json!({ "primitives": [primitive] })))
        });
        let matrix = instance.transform.to_world();
        binary.document.root(at(matrix, json!({ "mesh": mesh })));
    }
    leave_out_meshes(scene, &mut left_out);
    for camera in &scene.cameras {
        match camera::lens(scene, camera) {
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
    leave_out_surroundings(scene, &mut left_out);
    let count = images.write(&mut binary, &mut left_out)?;
    Ok(Exported {
        triangles: meshes.shared.keys().map(|mesh| triangles(scene, *mesh)).sum(),
        placements,
        images: count,
        bytes: binary.write(out)?,
        left_out,
    })
}

/// Names what is around or between things, and how they move.
fn leave_out_surroundings(scene: &Scene, left_out: &mut Vec<String>) {
    for notice in scene.notices.iter().filter(|notice| notice.is_rest_pose()) {
        left_out.push(format!("{}: all is in its rest pose (--time poses them)", notice.place));
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
}

/// Names what is not as it was in meshes.
fn leave_out_meshes(scene: &Scene, left_out: &mut Vec<String>) {
    let mut told = HashSet::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh.index()];
        let material = &scene.materials[instance.material.index()];
        let what = if mesh.indices.is_empty() {
            "it has no triangles"
        } else if material.tangent_texture().is_some_and(|map| has_tangents_by_triangle(mesh, map))
        {
            "tangents by triangle: whoever reads it makes others, at vertices"
        } else {
            continue;
        };
        if told.insert((instance.mesh, what)) {
            left_out.push(format!("mesh {:?}: {what}", mesh.name));
        }
    }
}

/// Whether a map of normals is turned by tangents of triangles where glTF wants those of
/// MikkTSpace, as it does wherever there are normals and texture coordinates.
fn has_tangents_by_triangle(mesh: &Mesh, map: TextureRef) -> bool {
    let uvs = mesh.uv_set(map.uv_set as usize);
    mesh.tangents.is_empty() && !mesh.normals.is_empty() && !uvs.is_empty()
}

fn triangles(scene: &Scene, mesh: MeshId) -> u64 {
    scene.meshes[mesh.index()].indices.len() as u64
}

/// For meshes that lack a set of texture coordinates before others, what stands in its place:
/// numbers must follow each other.
fn empty_sets(scene: &Scene) -> HashMap<usize, Vec<Vec2>> {
    let needs =
        |mesh: &Mesh| mesh.uv_sets().skip_while(|set| !set.is_empty()).any(|set| !set.is_empty());
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
            let empty_uvs = empty.get(&mesh.index()).map_or(&[][..], Vec::as_slice);
            accessors(binary, &scene.meshes[mesh.index()], empty_uvs)
        });
        let mut primitive = shared.clone();
        primitive["material"] = material.into();
        primitive
    }
}

/// `empty_uvs` stands for sets of texture coordinates that are not there, but others after them.
fn accessors<'a>(binary: &mut Binary<'a>, mesh: &'a Mesh, empty_uvs: &'a [Vec2]) -> Value {
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
    let sets = mesh.uv_sets().enumerate().filter(|(_, set)| !set.is_empty());
    let count = sets.last().map_or(0, |(last, _)| last + 1);
    let mut empty = None;
    for (number, uvs) in mesh.uv_sets().take(count).enumerate() {
        let accessor = if uvs.is_empty() {
            *empty.get_or_insert_with(|| binary.accessor(Chunk::Vec2(empty_uvs)))
        } else {
            binary.accessor(Chunk::Vec2(uvs))
        };
        attribute(&format!("TEXCOORD_{number}"), accessor);
    }
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
    use std::sync::Arc;

    use super::*;
    use crate::formats::LoadOptions;
    use crate::math::{MaterialId, TextureId, Vec3};
    use crate::scene::{Instance, Material, Transform};

    /// A triangle and points alone, placed twice each.
    fn triangle_and_points() -> Scene {
        let triangle = Mesh {
            name: "triangle".to_owned(),
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::Y], Vec::new()],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let points =
            Mesh { name: "points".to_owned(), positions: vec![Vec3::X; 6], ..Mesh::default() };
        let instance = |mesh| Instance {
            mesh: MeshId(mesh),
            material: MaterialId(0),
            transform: Transform::new(Affine3A::IDENTITY),
        };
        Scene {
            meshes: vec![Arc::new(triangle), Arc::new(points)],
            materials: vec![Material::default()],
            instances: [0, 1, 0, 1].map(instance).to_vec(),
            ..Scene::default()
        }
    }

    #[test]
    fn points_alone_are_left_out_and_named() {
        let mut file = Vec::new();
        let exported = write(&triangle_and_points(), &mut file).expect("is written");
        assert_eq!((exported.triangles, exported.placements), (1, 2));
        assert_eq!(exported.left_out, ["mesh \"points\": it has no triangles"]);
        let read = crate::formats::gltf::parse("a.glb".as_ref(), &file, &LoadOptions::default());
        let meshes = read.expect("is read").meshes;
        assert_eq!(meshes.iter().map(|mesh| mesh.indices.len()).collect::<Vec<_>>(), [1]);
    }

    /// Readers of glTF make tangents where a map of normals needs them and there are none.
    #[test]
    fn tangents_that_become_others_are_named() {
        let map = Material {
            normal_texture: Some(TextureRef::new(TextureId::from_index(0))),
            ..Material::default()
        };
        let mut left_out = Vec::new();
        let mut scene = Scene { materials: vec![map], ..triangle_and_points() };
        scene.instances.truncate(1);
        leave_out_meshes(&scene, &mut left_out);
        let said = "mesh \"triangle\": tangents by triangle: whoever reads it makes others, at \
                    vertices";
        assert_eq!(left_out, [said]);
        left_out.clear();
        Arc::make_mut(&mut scene.meshes[0]).tangents = vec![Vec3::X.extend(1.0); 3];
        leave_out_meshes(&scene, &mut left_out);
        assert!(left_out.is_empty(), "{left_out:?}");
    }

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
