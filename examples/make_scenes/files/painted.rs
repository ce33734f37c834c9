//! What colours surfaces besides textures as they stand: vertices, transforms, variants.

use std::f32::consts::TAU;

use dapple::math::{Quat, Vec3};
use serde_json::json;

use super::gltf::{Gltf, perspective, rounded};
use super::materials::{emitter, matte, plastic};
use super::shapes::{Shape, cuboid, quad, sphere};

/// A ball and a veil with colours of vertices, 64 pebbles by one node, a wall whose normal map is
/// turned and brings no tangents, a sign that is not lit, and a box in two variants.
pub fn painted() -> Vec<(String, Vec<u8>)> {
    let mut g = Gltf::new("painted");
    let grey = g.push("materials", matte([0.5, 0.49, 0.47]));
    let light = g.push("materials", emitter([20.0, 19.0, 17.5]));
    let white = g.push("materials", plastic([1.0; 3], 0.35));
    let floor = quad(Vec3::new(-9.0, 0.0, 8.0), Vec3::X * 18.0, Vec3::Z * -11.0).plain();
    g.place("floor", &floor, grey);
    let lamp = quad(Vec3::new(-6.0, 7.0, 3.0), Vec3::new(3.5, 1.0, 0.0), Vec3::Z * 3.5).plain();
    g.place("light", &lamp, light);

    let mut ball = sphere(32).plain();
    ball.colors = ball.positions.iter().map(|&p| spectrum(p)).collect();
    let ball = g.mesh(&ball, white);
    g.root(json!({ "name": "ball", "mesh": ball, "translation": [-1.7, 1.0, 0.4] }));

    let mut veil = matte([1.0; 3]);
    veil["alphaMode"] = json!("BLEND");
    veil["doubleSided"] = json!(true);
    let veil = g.push("materials", veil);
    let mut cloth = quad(Vec3::new(-3.4, 0.4, 2.0), Vec3::X * 1.7, Vec3::Y * 2.0).plain();
    let (clear, dense) = ([0.2, 0.6, 0.9, 0.0], [0.9, 0.3, 0.6, 0.9]);
    cloth.colors = vec![clear, dense, dense, clear];
    g.place("veil", &cloth, veil);

    pebbles(&mut g);
    wall_and_sign(&mut g);
    boxes(&mut g);
    g.camera(Vec3::new(0.4, 2.6, 9.0), Vec3::new(0.0, 1.3, 0.0), perspective(33.0, 1.5));
    g.finish()
}

/// A colour by direction.
fn spectrum([x, y, z]: [f32; 3]) -> [f32; 4] {
    let share = |t: f32| ((0.5 + 0.5 * t) * 255.0).round() / 255.0;
    [share(x), share(y), share(z), 1.0]
}

/// One mesh, one node, 64 places on a spiral.
fn pebbles(g: &mut Gltf) {
    let clay = g.push("materials", plastic([0.55, 0.3, 0.2], 0.5));
    let pebble = g.mesh(&sphere(12).plain(), clay);
    let (mut places, mut turns, mut sizes) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..64 {
        let (angle, far) = (TAU * k as f32 * 0.618_034, 0.17 * (k as f32 + 1.0).sqrt());
        places.push([far * libm::cosf(angle), 0.0, far * libm::sinf(angle)]);
        turns.push(Quat::from_rotation_y(angle).to_array());
        let size = 0.05 + 0.0009 * k as f32;
        sizes.push([1.5 * size, size, size]);
    }
    let copies = g.copies(&places, &turns, &sizes);
    g.root(json!({
        "name": "pebbles", "mesh": pebble, "translation": [0.6, 0.06, 2.2], "extensions": copies,
    }));
}

fn wall_and_sign(g: &mut Gltf) {
    let sampler = json!({ "magFilter": 9729, "minFilter": 9729 });
    let normals = g.texture("textures/bricks_normal.png", sampler.clone());
    let colors = g.texture("textures/bricks.png", sampler.clone());
    let turn = json!({ "KHR_texture_transform": {
        "offset": [0.1, 0.3], "rotation": 0.5, "scale": [3.0, 3.0],
    } });
    let mut wall = plastic([1.0; 3], 0.6);
    wall["pbrMetallicRoughness"]["baseColorTexture"] =
        json!({ "index": colors, "extensions": turn });
    wall["normalTexture"] = json!({ "index": normals, "scale": 1.5, "extensions": turn });
    let wall = g.push("materials", wall);
    // The right half shows the left one's texture, mirrored.
    let mut sides = quad(Vec3::new(-5.0, 0.0, -2.0), Vec3::X * 5.0, Vec3::Y * 5.0);
    let mut right = quad(Vec3::new(0.0, 0.0, -2.0), Vec3::X * 5.0, Vec3::Y * 5.0);
    right.uvs[0].iter_mut().for_each(|uv| uv[0] = 1.0 - uv[0]);
    sides.add(&right);
    g.place("wall", &sides, wall);

    let arrow = g.texture("textures/arrow.png", sampler);
    let sign = json!({
        "pbrMetallicRoughness": { "baseColorTexture": { "index": arrow } },
        "extensions": { "KHR_materials_unlit": {} },
    });
    let sign = g.push("materials", sign);
    let board = quad(Vec3::new(0.9, 2.3, -1.6), Vec3::X * 1.4, Vec3::Y * 1.4);
    g.place("sign", &board, sign);
}

/// A box that is red, or blue in the second variant.
fn boxes(g: &mut Gltf) {
    let [red, blue] = [[0.7, 0.06, 0.04], [0.04, 0.12, 0.65]]
        .map(|color| g.push("materials", plastic(color, 0.2)));
    let shape: Shape = cuboid(Vec3::splat(-0.6), Vec3::splat(0.6)).plain();
    let mesh = g.mesh(&shape, red);
    g.list("meshes")[mesh]["primitives"][0]["extensions"] = json!({ "KHR_materials_variants": {
        "mappings": [
            { "material": red, "variants": [0] }, { "material": blue, "variants": [1] },
        ],
    } });
    g.variants(&["by day", "by night"]);
    let turn = Quat::from_rotation_y(0.6).to_array();
    g.root(json!({
        "name": "box", "mesh": mesh, "translation": [2.3, 0.6, 0.8], "rotation": rounded(turn),
    }));
}
