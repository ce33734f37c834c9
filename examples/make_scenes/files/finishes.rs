//! What lies on surfaces: lacquer, cloth, brush strokes.

use std::f64::consts::FRAC_PI_2;

use dapple::math::Vec3;
use serde_json::json;

use super::gltf::{Gltf, perspective};
use super::materials::{brushed, cloth, lacquered, matte, metal, plastic};
use super::rooms::{spheres, studio};
use super::shapes::sphere;

/// Two rows of balls in a studio. In front a lacquered red, the same over flakes of metal, over
/// bricks whose relief the lacquer fills, and over bricks whose relief it follows; behind two kinds
/// of velvet and steel that is brushed both ways.
pub fn finishes() -> Vec<(String, Vec<u8>)> {
    let mut g = Gltf::new("finishes");
    studio(&mut g, [9.0, 8.6, 8.2], [7.0, 10.0, 16.0]);

    let sampler = json!({ "magFilter": 9729, "minFilter": 9729 });
    let normals = g.texture("textures/bricks_normal.png", sampler.clone());
    let leaf = g.texture("textures/bricks_roughness.png", sampler);
    let tiled = json!({ "KHR_texture_transform": { "scale": [4.0, 2.0] } });
    let relief = json!({ "index": normals, "extensions": tiled });
    let mut filled = lacquered(plastic([0.15, 0.3, 0.6], 0.6), 1.0, 0.0);
    filled["normalTexture"] = relief.clone();
    let mut followed = filled.clone();
    followed["extensions"]["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = relief;
    let mut flakes = lacquered(metal([0.5, 0.05, 0.08], 0.6), 1.0, 0.6);
    flakes["extensions"]["KHR_materials_clearcoat"]["clearcoatRoughnessTexture"] =
        json!({ "index": leaf, "extensions": tiled });
    let steel = || metal([0.75, 0.74, 0.72], 0.25);
    let red = matte([0.25, 0.02, 0.03]);
    let balls = [
        (lacquered(plastic([0.6, 0.03, 0.02], 0.7), 1.0, 0.05), [-2.25, 0.62, 1.7], 0.62),
        (flakes, [-0.75, 0.62, 1.7], 0.62),
        (filled, [0.75, 0.62, 1.7], 0.62),
        (followed, [2.25, 0.62, 1.7], 0.62),
        (cloth(red.clone(), [0.9, 0.25, 0.2], 0.3), [-3.1, 0.9, -0.5], 0.9),
        (lacquered(cloth(red, [0.9, 0.8, 0.4], 0.8), 0.5, 0.2), [-1.05, 0.9, -0.5], 0.9),
        (brushed(steel(), 0.8, 0.0), [1.05, 0.9, -0.5], 0.9),
        (brushed(steel(), 0.8, FRAC_PI_2), [3.1, 0.9, -0.5], 0.9),
    ];
    spheres(&mut g, &sphere(64), &balls);
    g.camera(Vec3::new(0.0, 3.4, 11.5), Vec3::new(0.0, 0.85, 0.0), perspective(31.0, 2.0));
    g.finish()
}
