//! What moves: a pinwheel, and a ball that is thrown.

use dapple::math::Vec3;
use serde_json::json;

use super::gltf::{Gltf, perspective};
use super::materials::{metal, plastic};
use super::rooms::{spheres, studio};
use super::shapes::{cuboid, sphere};

type Files = Vec<(String, Vec<u8>)>;

/// A pinwheel that turns once a second, and a ball that flies for a second:
/// `--time 0.55 --shutter 0.08`.
pub fn motion() -> Files {
    let mut g = Gltf::new("motion");
    studio(&mut g, [7.0, 6.7, 6.4], [5.0, 7.5, 12.0]);
    spheres(
        &mut g,
        &sphere(80).plain(),
        &[(metal([0.95, 0.93, 0.88], 0.05), [0.3, 0.7, -0.8], 0.7)],
    );

    let colors = [[0.8, 0.1, 0.05], [0.9, 0.6, 0.05], [0.1, 0.5, 0.2], [0.1, 0.25, 0.7]];
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, half, half], [0.0, 0.0, 1.0, 0.0]];
    let turns: Vec<[f32; 4]> = turns.into_iter().chain([[0.0, 0.0, half, -half]]).collect();
    let blade = cuboid(Vec3::new(0.1, -0.02, -0.04), Vec3::new(1.25, 0.42, 0.04)).plain();
    let blades = colors.iter().zip(&turns).map(|(&color, turn)| {
        let paper = g.push("materials", plastic(color, 0.5));
        let mesh = g.mesh(&blade, paper);
        g.push("nodes", json!({ "mesh": mesh, "rotation": turn }))
    });
    let blades: Vec<usize> = blades.collect();
    let at = [-1.9, 1.6, -0.2];
    let wheel = g.root(json!({ "name": "pinwheel", "children": blades, "translation": at }));
    let wood = g.push("materials", plastic([0.35, 0.2, 0.1], 0.6));
    let stick = cuboid(Vec3::new(-1.95, 0.0, -0.36), Vec3::new(-1.85, 1.65, -0.26));
    g.place("stick", &stick.plain(), wood);

    let rubber = g.push("materials", plastic([0.75, 0.12, 0.08], 0.25));
    let mesh = g.mesh(&sphere(64).plain(), rubber);
    let scale = [0.45; 3];
    let ball = g.root(json!({ "name": "ball", "mesh": mesh, "scale": scale }));

    // Constant gravity is a cubic: half of 9.81 m/s² down, thrown upwards at 4.9 m/s.
    let up = 4.905;
    let ends = [[0.3, 0.45, 1.2], [3.9, 0.45, 0.6]];
    let speeds = [[3.6, up, -0.6], [3.6, -up, -0.6]];
    let flight = [[0.0; 3], ends[0], speeds[0], speeds[1], ends[1], [0.0; 3]];
    let flight = g.floats(&flight, "VEC3");
    let second = g.times(&[0.0, 1.0]);
    let quarters = g.times(&[0.0, 0.25, 0.5, 0.75, 1.0]);
    let once: Vec<[f32; 4]> = turns.iter().copied().chain([[0.0, 0.0, 0.0, -1.0]]).collect();
    let once = g.floats(&once, "VEC4");
    g.push(
        "animations",
        json!({
            "samplers": [
                { "input": quarters, "output": once },
                { "input": second, "output": flight, "interpolation": "CUBICSPLINE" },
            ],
            "channels": [
                { "sampler": 0, "target": { "node": wheel, "path": "rotation" } },
                { "sampler": 1, "target": { "node": ball, "path": "translation" } },
            ],
        }),
    );
    g.camera(Vec3::new(0.4, 2.2, 9.0), Vec3::new(0.4, 1.25, 0.0), perspective(30.0, 2.0));
    g.finish()
}
