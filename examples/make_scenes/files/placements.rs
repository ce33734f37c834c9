//! Few meshes in many places, many lights, and a camera without perspective.

use std::f32::consts::TAU;

use dapple::math::{Quat, Vec3};
use serde_json::json;

use super::gltf::{Gltf, perspective, rounded};
use super::materials::{emitter, matte, plastic};
use super::shapes::{cuboid, quad, shell};

type Files = Vec<(String, Vec<u8>)>;

/// One seashell in 85 places, by a graph of nodes: turned, mirrored and stretched.
pub fn instanced() -> Files {
    let mut g = Gltf::new("instanced");
    let sand = g.push("materials", matte([0.62, 0.53, 0.4]));
    let light = g.push("materials", emitter([26.0, 24.0, 21.0]));
    let floor = quad(Vec3::new(-60.0, 0.0, 40.0), Vec3::X * 120.0, Vec3::Z * -120.0).plain();
    g.place("sand", &floor, sand);
    let lamp = quad(Vec3::new(-18.0, 14.0, -1.0), Vec3::new(6.0, 6.0, 0.0), Vec3::Z * 9.0).plain();
    g.place("light", &lamp, light);
    g.light(
        json!({ "type": "directional", "color": [0.75, 0.85, 1.0], "intensity": 0.9 }),
        Vec3::ZERO,
        Vec3::new(-0.5, -1.0, -0.6),
    );
    let colors = [[0.85, 0.8, 0.72], [0.8, 0.42, 0.3], [0.55, 0.36, 0.5], [0.3, 0.45, 0.5]];
    let materials = colors.map(|color| g.push("materials", plastic(color, 0.25)));
    let first = g.mesh(&shell(24, 110).plain(), materials[0]);
    let meshes = [first, 0, 0, 0];
    let meshes: Vec<usize> = (0..4)
        .map(|k| if k == 0 { meshes[0] } else { g.mesh_again(first, materials[k]) })
        .collect();

    for ring in 0..5_usize {
        let count = if ring == 0 { 1 } else { 2 * (3 + 3 * ring) };
        let mut children = Vec::new();
        for k in 0..count {
            let around = Quat::from_rotation_y(TAU * k as f32 / count as f32);
            // The tip, which is the shell's origin, points up; every other shell is mirrored.
            let size = 0.42 + 0.05 * ring as f32;
            let mirror = if k % 2 == 0 { 1.0 } else { -1.0 };
            let stretch = if ring % 2 == 1 { 1.35 } else { 0.9 };
            let at = around * Vec3::new(0.0, 2.85 * size * stretch, 2.0 * ring as f32);
            let pose = around * Quat::from_rotation_x(std::f32::consts::PI);
            let scale = [size * mirror, size * stretch, size];
            children.push(g.push(
                "nodes",
                json!({
                    "mesh": meshes[(ring + 3 * (k % 2)) % 4],
                    "translation": rounded(at.to_array()), "rotation": rounded(pose.to_array()),
                    "scale": rounded(scale),
                }),
            ));
        }
        // A ring as a whole turns, shrinks towards the middle and stands on a stair.
        let turn = Quat::from_rotation_y(0.25 * ring as f32).to_array();
        g.root(json!({
            "name": format!("ring {ring}"), "children": children, "rotation": rounded(turn),
        }));
    }
    g.camera(Vec3::new(3.2, 10.0, 18.0), Vec3::new(0.0, 0.4, 0.3), perspective(35.0, 1.6));
    g.finish()
}

/// A town at night: 206 lit windows, 16 lanterns, and each kind of point-like light.
pub fn many_lights() -> Files {
    let mut g = Gltf::new("many_lights");
    let ground = g.push("materials", plastic([0.16, 0.17, 0.19], 0.35));
    let walls = [[0.36, 0.33, 0.3], [0.3, 0.34, 0.38], [0.42, 0.36, 0.3]];
    let walls = walls.map(|color| g.push("materials", matte(color)));
    let glows = [[14.0, 8.5, 3.4], [10.0, 8.6, 6.6], [4.5, 7.5, 11.0], [14.0, 4.6, 2.0]];
    let glows = glows.map(|radiance| g.push("materials", emitter(radiance)));

    let plain = quad(Vec3::new(-20.0, 0.0, 20.0), Vec3::X * 40.0, Vec3::Z * -40.0).plain();
    g.place("ground", &plain, ground);
    let block = cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5)).plain();
    let first = g.mesh(&block, walls[0]);
    let blocks = [first, g.mesh_again(first, walls[1]), g.mesh_again(first, walls[2])];
    let pane = quad(Vec3::new(-0.5, 0.0, 0.0), Vec3::X, Vec3::Y).plain();
    let first = g.mesh(&pane, glows[0]);
    let panes: Vec<usize> =
        (0..4).map(|k| if k == 0 { first } else { g.mesh_again(first, glows[k]) }).collect();

    let windows: usize = (0..25).map(|house| place_house(&mut g, house, blocks, &panes)).sum();
    assert_eq!(windows, 206);
    // Lanterns over the crossings.
    let lantern = g.mesh(&cuboid(Vec3::splat(-0.5), Vec3::splat(0.5)).plain(), glows[3]);
    for k in 0..16 {
        let (x, z) = (2.3 * ((k % 4) as f32 - 1.5), 2.3 * ((k / 4) as f32 - 1.5));
        g.root(json!({
            "mesh": lantern, "translation": rounded([x, 0.55, z]), "scale": [0.09, 0.13, 0.09],
        }));
    }

    let moon = json!({ "type": "directional", "color": [0.6, 0.75, 1.0], "intensity": 0.12 });
    g.light(moon, Vec3::ZERO, Vec3::new(0.6, -1.0, -0.3));
    let point = json!({ "type": "point", "color": [0.4, 1.0, 0.7], "intensity": 6.0 });
    g.light(point, Vec3::new(-3.45, 0.9, 5.8), Vec3::ZERO);
    let cone = json!({ "innerConeAngle": 0.25, "outerConeAngle": 0.4 });
    let spot = json!({ "type": "spot", "color": [1.0, 0.9, 0.8], "intensity": 60.0, "spot": cone });
    g.light(spot, Vec3::new(4.5, 6.0, 9.0), Vec3::new(2.3, 0.0, 6.0));
    g.camera(Vec3::new(7.2, 7.6, 14.0), Vec3::new(0.2, 0.55, 0.5), perspective(36.0, 16.0 / 9.0));
    g.finish()
}

/// Adds a house whose windows glow here and there, and counts these.
fn place_house(g: &mut Gltf, house: usize, blocks: [usize; 3], panes: &[usize]) -> usize {
    let (column, row) = (house % 5, house / 5);
    let (x, z) = (2.3 * (column as f32 - 2.0), 2.3 * (row as f32 - 2.0));
    let mut windows = 0;
    let floors = 2 + (house * 7 + row * 3) % 5;
    let height = 0.62 * floors as f32 + 0.3;
    let mut children =
        vec![g.push(
            "nodes",
            json!({ "mesh": blocks[house % 3], "scale": rounded([1.3, height, 1.3]) }),
        )];
    for floor in 0..floors {
        for side in 0..4_usize {
            // Two of three windows are dark.
            if !(house * 5 + floor * 3 + side * 7 + floor * side).is_multiple_of(2) {
                continue;
            }
            let turn = Quat::from_rotation_y(TAU / 4.0 * side as f32);
            let at = turn * Vec3::new(0.0, 0.28 + 0.62 * floor as f32, 0.655);
            children.push(g.push(
                "nodes",
                json!({
                    "mesh": panes[(house + floor + side) % 4],
                    "translation": rounded(at.to_array()),
                    "rotation": rounded(turn.to_array()), "scale": [0.5, 0.32, 1.0],
                }),
            ));
            windows += 1;
        }
    }
    g.root(json!({
        "name": format!("house {house}"), "children": children,
        "translation": rounded([x, 0.0, z]),
    }));
    windows
}

/// Blocks in parallel projection: edges that are parallel stay so.
pub fn orthographic() -> Files {
    let mut g = Gltf::new("orthographic");
    let light = g.push("materials", emitter([24.0, 22.5, 20.0]));
    let lamp = quad(Vec3::new(-20.0, 22.0, 4.0), Vec3::new(9.0, 6.5, 0.0), Vec3::Z * 12.0).plain();
    g.place("light", &lamp, light);
    let sun = json!({ "type": "directional", "color": [0.8, 0.88, 1.0], "intensity": 1.4 });
    g.light(sun, Vec3::ZERO, Vec3::new(-0.3, -1.0, -0.75));

    let paper = g.push("materials", matte([0.5, 0.48, 0.44]));
    let ground = quad(Vec3::new(-30.0, 0.0, 30.0), Vec3::X * 60.0, Vec3::Z * -60.0).plain();
    g.place("ground", &ground, paper);
    let block = cuboid(Vec3::new(-0.5, 0.0, -0.5), Vec3::new(0.5, 1.0, 0.5)).plain();
    let (mut first, mut meshes) = (None, Vec::new());
    for k in 0..6 {
        let t = k as f32 / 5.0;
        let color = Vec3::new(0.04, 0.18, 0.3).lerp(Vec3::new(0.9, 0.36, 0.08), t);
        let material = g.push("materials", matte(color.to_array().map(f64::from)));
        meshes.push(match first {
            Some(first) => g.mesh_again(first, material),
            None => *first.insert(g.mesh(&block, material)),
        });
    }
    for cell in 0..121 {
        let (x, z) = ((cell % 11) as f32 - 5.0, (cell / 11) as f32 - 5.0);
        let radius = (x * x + z * z).sqrt();
        let wave = 0.5 + 0.5 * libm::cosf(1.1 * radius);
        let height = 0.4 + 3.2 * wave * libm::expf(-0.17 * radius);
        let mesh = meshes[((height - 0.4) / 3.2 * 5.0).round() as usize];
        g.root(json!({
            "mesh": mesh, "translation": rounded([x, 0.0, z]),
            "scale": rounded([0.94, height, 0.94]),
        }));
    }
    let camera = json!({ "type": "orthographic", "orthographic": {
        "xmag": 8.4, "ymag": 5.6, "znear": 0.01, "zfar": 100.0,
    } });
    g.camera(Vec3::new(14.0, 12.0, 14.0), Vec3::new(0.0, 0.4, 0.0), camera);
    g.finish()
}
