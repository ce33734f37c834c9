//! What covers surfaces: textures, holes and the sky's reflection.

use dapple::math::{Quat, Vec3};
use serde_json::{Value, json};

use super::gltf::{Gltf, perspective, rounded};
use super::materials::{emitter, matte, metal, plastic, solid_glass};
use super::shapes::{cuboid, quad, sphere, torus};

type Files = Vec<(String, Vec<u8>)>;

const LINEAR: u32 = 9729;
const NEAREST: u32 = 9728;
const REPEAT: u32 = 10497;
const CLAMP: u32 = 33071;
const MIRROR: u32 = 33648;

fn sampler(filter: u32, wrap: u32) -> Value {
    json!({ "magFilter": filter, "minFilter": filter, "wrapS": wrap, "wrapT": wrap })
}

fn textured_matte(texture: usize) -> Value {
    let mut material = matte([1.0; 3]);
    material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
    material
}

/// Colours, metalness, roughness and normals by textures, two sets of coordinates, and panels for
/// each way to wrap (columns) and to filter (rows).
pub fn textured() -> Files {
    let mut g = Gltf::new("textured");
    let grey = g.push("materials", matte([0.42, 0.43, 0.45]));
    let light = g.push("materials", emitter([22.0, 20.5, 18.5]));
    let floor = quad(Vec3::new(-9.0, 0.0, 8.0), Vec3::X * 18.0, Vec3::Z * -11.0).plain();
    g.place("floor", &floor, grey);
    let wall = quad(Vec3::new(-9.0, 0.0, -3.0), Vec3::X * 18.0, Vec3::Y * 9.0).plain();
    g.place("wall", &wall, grey);
    let lamp = quad(Vec3::new(-6.0, 7.0, 3.0), Vec3::new(3.5, 1.0, 0.0), Vec3::Z * 3.5).plain();
    g.place("light", &lamp, light);

    for (row, filter) in [NEAREST, LINEAR].into_iter().enumerate() {
        for (column, wrap) in [REPEAT, CLAMP, MIRROR].into_iter().enumerate() {
            let texture = g.texture("textures/arrow.png", sampler(filter, wrap));
            let material = g.push("materials", textured_matte(texture));
            let corner = Vec3::new(-3.0 + 2.1 * column as f32, 3.35 - 2.1 * row as f32, -2.9);
            let mut panel = quad(corner, Vec3::X * 1.8, Vec3::Y * 1.8).tiled(2.5, 2.5);
            panel.uvs[0].iter_mut().for_each(|uv| *uv = uv.map(|value| value - 0.75));
            g.place("panel", &panel, material);
        }
    }

    let bricks = ["bricks", "bricks_normal", "bricks_roughness"]
        .map(|name| g.texture(&format!("textures/{name}.png"), sampler(LINEAR, REPEAT)));
    let mut wall = plastic([1.0; 3], 1.0);
    wall["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": bricks[0] });
    wall["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": bricks[2] });
    wall["normalTexture"] = json!({ "index": bricks[1], "scale": 1.2 });
    let wall = g.push("materials", wall);
    let ball = g.mesh(&sphere(64).tiled(4.0, 2.0), wall);
    g.root(json!({ "name": "bricks", "mesh": ball, "translation": [-2.5, 1.0, 0.3] }));

    let inlay = ["inlay", "inlay_metal"]
        .map(|name| g.texture(&format!("textures/{name}.png"), sampler(LINEAR, REPEAT)));
    let mut material = metal([1.0; 3], 1.0);
    material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": inlay[0] });
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = json!({ "index": inlay[1] });
    let material = g.push("materials", material);
    let ball = g.mesh(&sphere(64).tiled(8.0, 4.0), material);
    g.root(json!({ "name": "inlay", "mesh": ball, "translation": [0.0, 1.0, 1.0] }));

    // Colours by the second set of coordinates, normals by the first.
    let arrow = g.texture("textures/arrow.png", sampler(NEAREST, REPEAT));
    let mut material = plastic([1.0; 3], 0.3);
    material["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": arrow, "texCoord": 1 });
    material["normalTexture"] = json!({ "index": bricks[1] });
    let material = g.push("materials", material);
    let mut cube = cuboid(Vec3::splat(-0.8), Vec3::splat(0.8));
    cube.uvs[1] = cube.uvs[0].iter().map(|[u, v]| [0.125 + 0.75 * u, 0.125 + 0.75 * v]).collect();
    let cube = g.mesh(&cube, material);
    let turn = Quat::from_rotation_y(-0.6).to_array();
    g.root(json!({
        "name": "cube", "mesh": cube, "translation": [2.6, 0.8, 0.5], "rotation": rounded(turn),
    }));
    g.camera(Vec3::new(0.5, 3.1, 9.6), Vec3::new(0.0, 2.1, 0.0), perspective(35.0, 1.5));
    g.finish()
}

/// A plant of leaves cut out of squares (MASK), and faded leaves that let light through (BLEND).
pub fn alpha() -> Files {
    let mut g = Gltf::new("alpha");
    let wall = g.push("materials", matte([0.74, 0.68, 0.6]));
    let floor = g.push("materials", matte([0.5, 0.42, 0.36]));
    let clay = g.push("materials", plastic([0.55, 0.22, 0.12], 0.6));
    let wood = g.push("materials", matte([0.2, 0.13, 0.08]));
    let light = g.push("materials", emitter([34.0, 31.0, 26.0]));
    let texture = g.texture("textures/leaf.png", sampler(LINEAR, CLAMP));
    let mut mask = plastic([1.0; 3], 0.5);
    mask["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": texture });
    mask["doubleSided"] = json!(true);
    let mut blend = mask.clone();
    mask["alphaMode"] = json!("MASK");
    mask["alphaCutoff"] = json!(0.5);
    blend["alphaMode"] = json!("BLEND");
    blend["pbrMetallicRoughness"]["baseColorFactor"] = json!([1.0, 0.8, 0.4, 0.55]);
    let (mask, blend) = (g.push("materials", mask), g.push("materials", blend));

    let ground = quad(Vec3::new(-6.0, 0.0, 5.0), Vec3::X * 12.0, Vec3::Z * -7.5).plain();
    g.place("floor", &ground, floor);
    let back = quad(Vec3::new(-6.0, 0.0, -2.5), Vec3::X * 12.0, Vec3::Y * 7.0).plain();
    g.place("wall", &back, wall);
    let right = Vec3::new(1.3, 0.0, -1.22);
    let lamp = quad(Vec3::new(2.2, 6.2, 3.4), right, Vec3::new(0.8, -1.33, 0.85)).plain();
    g.place("light", &lamp, light);
    let pot = g.mesh(&sphere(48).plain(), clay);
    g.root(json!({
        "name": "pot", "mesh": pot, "translation": [0, 0.42, 0], "scale": [0.62, 0.5, 0.62],
    }));
    let trunk = cuboid(Vec3::new(-0.035, 0.7, -0.035), Vec3::new(0.035, 2.75, 0.035)).plain();
    g.place("trunk", &trunk, wood);

    let square = quad(Vec3::new(-0.5, 0.0, 0.0), Vec3::X, Vec3::Y);
    let green = g.mesh(&square, mask);
    let faded = g.mesh_again(green, blend);
    for k in 0..70 {
        let t = k as f32 / 69.0;
        // Each leaf turns by the golden angle from the last, and stands steeper towards the top.
        let around = Quat::from_rotation_y(2.399_963 * k as f32);
        let lean = Quat::from_rotation_x(1.75 - 1.35 * t);
        let at = Vec3::new(0.0, 0.95 + 1.75 * t, 0.0) + around * Vec3::Z * 0.02;
        let size = 1.15 - 0.6 * t;
        g.root(json!({
            "mesh": green, "translation": rounded(at.to_array()),
            "rotation": rounded((around * lean).to_array()),
            "scale": rounded([0.55 * size, size, size]),
        }));
    }
    for k in 0..14 {
        let spread = |a: f32| (libm::sinf(a * (k as f32 + 1.0)) * 0.5 + 0.5) * 4.4 - 2.2;
        let at = Vec3::new(spread(12.9), 0.03 + 0.004 * k as f32, spread(78.2) * 0.6 + 1.2);
        let flat = Quat::from_rotation_y(1.7 * k as f32) * Quat::from_rotation_x(1.5);
        g.root(json!({
            "mesh": faded, "translation": rounded(at.to_array()),
            "rotation": rounded(flat.to_array()), "scale": [0.5, 0.8, 0.8],
        }));
    }
    g.camera(Vec3::new(-1.2, 2.3, 7.2), Vec3::new(0.0, 1.55, 0.0), perspective(32.0, 1.0));
    g.finish()
}

/// Shiny things on a plain, lit by `--env scenes/sky.hdr` alone.
pub fn sky() -> Files {
    let mut g = Gltf::new("sky");
    let plain = g.push("materials", matte([0.45, 0.37, 0.27]));
    let ground = quad(Vec3::new(-40.0, 0.0, 40.0), Vec3::X * 80.0, Vec3::Z * -80.0).plain();
    g.place("plain", &ground, plain);
    let copper = g.push("materials", metal([0.96, 0.64, 0.54], 0.12));
    let ring = g.mesh(&torus(96, 40, 0.34).plain(), copper);
    let tilt = Quat::from_rotation_z(0.25) * Quat::from_rotation_x(1.25);
    g.root(json!({
        "name": "ring", "mesh": ring, "translation": [0.0, 1.27, -0.4],
        "rotation": rounded(tilt.to_array()),
    }));
    let balls = [
        (solid_glass([1.0; 3], 1.0, 0.0), [1.75, 0.62, 0.7], 0.62),
        (plastic([0.02, 0.11, 0.3], 0.05), [-1.7, 0.7, 0.5], 0.7),
        (metal([0.95, 0.93, 0.88], 0.0), [0.15, 0.42, 1.35], 0.42),
        (plastic([0.75, 0.72, 0.66], 0.6), [-0.75, 0.25, 1.75], 0.25),
    ];
    let mut mesh: Option<usize> = None;
    for (material, at, radius) in balls {
        let material = g.push("materials", material);
        let mesh = match mesh {
            Some(first) => g.mesh_again(first, material),
            None => *mesh.insert(g.mesh(&sphere(80).plain(), material)),
        };
        g.root(json!({
            "mesh": mesh, "translation": rounded(at), "scale": rounded([radius; 3]),
        }));
    }
    g.camera(Vec3::new(0.0, 1.7, 7.5), Vec3::new(0.0, 0.95, 0.0), perspective(32.0, 1.6));
    g.finish()
}
