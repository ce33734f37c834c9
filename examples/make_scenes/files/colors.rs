//! Colours of waves: thin films, glass that parts colours; and solids within solids.

use std::f64::consts::FRAC_PI_2;

use dapple::math::Vec3;
use serde_json::{Value, json};

use super::gltf::{Gltf, perspective, rounded};
use super::materials::{brushed, filmed, metal, plastic, solid_glass, thin_glass};
use super::rooms::{spheres, studio};
use super::shapes::{Shape, sphere};

type Files = Vec<(String, Vec<u8>)>;

/// Films in a studio. In front black plastic under films of 250 to 700 nanometres; behind a soap
/// bubble, a film on solid glass, tempered steel whose film is a brick wall, and brushed steel.
pub fn films() -> Files {
    let mut g = Gltf::new("films");
    studio(&mut g, [9.0, 8.8, 8.6], [9.0, 10.0, 12.0]);
    let leaf = g.texture("textures/bricks_roughness.png", json!({ "magFilter": 9729 }));
    let mut tempered = filmed(metal([0.7, 0.68, 0.65], 0.25), 2.2, [60.0, 420.0]);
    let film = &mut tempered["extensions"]["KHR_materials_iridescence"];
    film["iridescenceThicknessTexture"] = json!({
        "index": leaf, "extensions": { "KHR_texture_transform": { "scale": [4.0, 2.0] } },
    });
    let steel = brushed(metal([0.75, 0.74, 0.72], 0.25), 0.8, FRAC_PI_2);
    let clear = solid_glass([1.0; 3], 1.0, 0.0);
    let mut balls = vec![
        (filmed(thin_glass([1.0; 3], 0.0), 1.33, [420.0; 2]), [-3.1, 0.9, -0.5], 0.9),
        (filmed(clear, 1.8, [380.0; 2]), [-1.05, 0.9, -0.5], 0.9),
        (tempered, [1.05, 0.9, -0.5], 0.9),
        (filmed(steel, 1.5, [330.0; 2]), [3.1, 0.9, -0.5], 0.9),
    ];
    for k in 0..4_u8 {
        let thickness = 250.0 + 150.0 * f64::from(k);
        let black = plastic([0.01, 0.01, 0.01], 0.1 + 0.1 * f64::from(k));
        let at = [-2.25 + 1.5 * f32::from(k), 0.62, 1.7];
        balls.push((filmed(black, 1.33, [thickness; 2]), at, 0.62));
    }
    spheres(&mut g, &sphere(64), &balls);
    g.camera(Vec3::new(0.0, 3.4, 11.5), Vec3::new(0.0, 0.85, 0.0), perspective(31.0, 2.0));
    g.finish()
}

/// Glass of an index, whose dispersion is 20 over its Abbe number.
fn dispersing(ior: f64, dispersion: f64) -> Value {
    let mut glass = of_index(solid_glass([1.0; 3], 1.0, 0.0), ior);
    glass["extensions"]["KHR_materials_dispersion"] = json!({ "dispersion": dispersion });
    glass
}

fn of_index(mut glass: Value, ior: f64) -> Value {
    glass["extensions"]["KHR_materials_ior"]["ior"] = ior.into();
    glass
}

/// Cut stones that part colours, and glass around amber around air; of two balls that overlap, the
/// blue one is there where both are.
pub fn gems() -> Files {
    let mut g = Gltf::new("gems");
    studio(&mut g, [13.0, 12.7, 12.4], [16.0, 17.0, 19.0]);
    let cut = |columns| Shape { normals: Vec::new(), ..sphere(columns).plain() };
    for (name, columns, glass, at, size, turn) in [
        ("diamond", 8, dispersing(2.42, 1.2), [-2.9, 0.95, 0.2], [1.0, 0.95, 1.0], 0.2_f32),
        ("crystal", 6, dispersing(1.6, 2.0), [2.75, 0.95, 0.3], [0.85, 1.0, 0.85], 0.35),
    ] {
        let material = g.push("materials", glass);
        let mesh = g.mesh(&cut(columns), material);
        let (sin, cos) = libm::sincosf(turn);
        g.root(json!({
            "name": name, "mesh": mesh, "translation": rounded(at), "scale": rounded(size),
            "rotation": rounded([0.0, sin, 0.0, cos]),
        }));
    }
    let amber = of_index(solid_glass([0.85, 0.4, 0.08], 0.35, 0.0), 1.33);
    let blue = |priority: i32| {
        let mut glass = solid_glass([0.15, 0.35, 0.9], 0.5, 0.0);
        glass["extras"] = json!({ "dapple_priority": priority });
        glass
    };
    spheres(
        &mut g,
        &sphere(80).plain(),
        &[
            (solid_glass([1.0; 3], 1.0, 0.0), [0.0, 1.05, -0.6], 1.05),
            (amber, [0.0, 1.05, -0.6], 0.75),
            (of_index(solid_glass([1.0; 3], 1.0, 0.0), 1.0), [0.1, 1.2, -0.45], 0.3),
            (solid_glass([0.9, 0.75, 0.2], 0.5, 0.0), [-0.75, 0.5, 1.8], 0.5),
            (blue(1), [-0.2, 0.5, 1.9], 0.5),
            (dispersing(1.52, 3.0), [1.1, 0.5, 1.8], 0.5),
        ],
    );
    g.camera(Vec3::new(0.0, 3.4, 11.5), Vec3::new(0.0, 0.85, 0.0), perspective(31.0, 2.0));
    g.finish()
}
