//! A kitchen: a closed room with furniture, crockery and appliances.
//!
//! Stands beside the kitchen of Lext, Assarsson and Möller, "A benchmark for animated ray tracing"
//! (2001), which J. Barczak flew through. No ray gets out. More triangles make all of it finer.

mod appliances;
mod crockery;
mod furniture;
mod size;
mod stuff;

use serde_json::json;

pub use self::size::ROOM;
use self::size::WORKTOP;
use self::stuff::Stuff;
use super::document::perspective;
use super::model::{Lamp, Model, Part, View, at};
use super::scenery::Scenery;
use super::shape::{Ribbon, Shell};
use crate::camera::flight::Pose;
use crate::math::{DVec2, DVec3, Vec3};

/// The parts of a kitchen.
pub fn model(_: u64, seed: u64) -> Model {
    let mut kitchen = Scenery::new(seed, stuff::materials());
    room(&mut kitchen);
    furniture::build(&mut kitchen);
    appliances::build(&mut kitchen);
    crockery::build(&mut kitchen);
    light_and_cameras(&mut kitchen);
    kitchen.model.rest = Some(Part {
        name: "towel".to_owned(),
        material: Stuff::Cloth.index(),
        place: at(0.2, WORKTOP[1] + 0.03, -0.5 * ROOM.z + 0.35),
        shape: Box::new(Ribbon { length: 0.5, width: 0.3 }),
    });
    kitchen.model
}

/// Walls, floor and ceiling in one, and what is laid on them.
fn room(k: &mut Scenery) {
    k.begin("room", DVec3::ZERO, 0.0);
    let half = ROOM * 0.5;
    k.put("walls", Stuff::Wall.index(), at(0.0, half.y, 0.0), Shell { half });
    let (columns, rows) = (13, 10);
    let tile = DVec2::new(ROOM.x / f64::from(columns), ROOM.z / f64::from(rows));
    for i in 0..columns * rows {
        let (x, z) = (f64::from(i % columns) + 0.5, f64::from(i / columns) + 0.5);
        let place = [x * tile.x - half.x, 0.006, z * tile.y - half.z];
        let stuff = if (i % columns + i / columns) % 2 == 0 { Stuff::Slate } else { Stuff::Cream };
        k.slab("tile", stuff.index(), place, [0.49 * tile.x, 0.006, 0.49 * tile.y]);
    }
    // Wall tiles behind the worktop.
    for i in 0..2 * 26 {
        let (column, row) = (i % 26, i / 26);
        let x = (f64::from(column) + 0.5) * ROOM.x / 26.0 - half.x;
        let place = [x, 1.02 + 0.2 * f64::from(row), -half.z + 0.006];
        let stuff = if k.random.chance(0.15) { Stuff::Blue } else { Stuff::Porcelain };
        k.slab("wall tile", stuff.index(), place, [0.096, 0.096, 0.006]);
    }
    for (x, z, along) in [(0.0, half.z - 0.01, true), (half.x - 0.01, 0.0, false)] {
        let long = if along { half.x } else { half.z };
        let size = if along { [long, 0.05, 0.01] } else { [0.01, 0.05, long] };
        k.slab("skirting", Stuff::White.index(), [x, 0.06, z], size);
    }
    window(k, half);
    door(k, half);
}

/// A window that is a bright panel: the room stays closed.
fn window(k: &mut Scenery, half: DVec3) {
    k.begin("window", DVec3::new(half.x - 0.02, 1.5, -0.5), 0.0);
    let pane = DVec2::new(0.5, 0.7);
    k.panel("sky", Stuff::Sky.index(), DVec3::ZERO, DVec3::NEG_X, pane);
    for z in [-0.72, 0.0, 0.72] {
        k.slab("stile", Stuff::White.index(), [-0.02, 0.0, z], [0.03, 0.56, 0.035]);
    }
    for y in [-0.53, 0.0, 0.53] {
        k.slab("rail", Stuff::White.index(), [-0.02, y, 0.0], [0.028, 0.03, 0.75]);
    }
    k.slab("sill", Stuff::White.index(), [-0.09, -0.58, 0.0], [0.1, 0.02, 0.85]);
    k.rod("rail", Stuff::Brass.index(), &[[-0.08, 0.64, -0.95], [-0.08, 0.64, 0.95]], 0.012);
    for side in [-1.0, 1.0] {
        for fold in 0..6 {
            let z = side * (0.86 - 0.028 * f64::from(fold));
            let points = [[-0.08, 0.62, z], [-0.07, 0.0, z + 0.01 * side], [-0.08, -0.75, z]];
            k.rod("curtain", Stuff::Cloth.index(), &points, 0.017);
        }
    }
}

fn door(k: &mut Scenery, half: DVec3) {
    k.begin("door", DVec3::new(-half.x + 0.03, 0.0, 1.1), 0.0);
    k.slab("leaf", Stuff::White.index(), [0.0, 1.02, 0.0], [0.025, 1.0, 0.42]);
    for (y, z) in [(0.55, -0.2), (0.55, 0.2), (1.45, -0.2), (1.45, 0.2)] {
        k.slab("panel", Stuff::White.index(), [0.025, y, z], [0.012, 0.36, 0.15]);
    }
    for z in [-0.46, 0.46] {
        k.slab("jamb", Stuff::Oak.index(), [0.01, 1.04, z], [0.04, 1.04, 0.04]);
    }
    k.slab("lintel", Stuff::Oak.index(), [0.01, 2.1, 0.0], [0.04, 0.04, 0.5]);
    let handle = [[0.03, 1.0, 0.36], [0.08, 1.0, 0.36], [0.08, 1.0, 0.26]];
    k.rod("handle", Stuff::Brass.index(), &handle, 0.009);
}

fn light_and_cameras(k: &mut Scenery) {
    k.begin("light", DVec3::ZERO, 0.0);
    for x in [-1.2, 1.2] {
        let at = DVec3::new(x, ROOM.y - 0.02, 0.2);
        k.panel("panel", Stuff::Lamp.index(), at, DVec3::NEG_Y, DVec2::new(0.45, 0.3));
    }
    // A pendant over the table.
    k.rod("flex", Stuff::Iron.index(), &[[0.3, 2.69, 0.5], [0.3, 1.95, 0.5]], 0.005);
    let shade = [(0.03, 0.16), (0.2, 0.0), (0.205, 0.0), (0.035, 0.17)];
    k.turned("shade", Stuff::Red.index(), at(0.3, 1.8, 0.5), &shade, 0.001);
    let bulb = [(0.0, 0.0), (0.03, 0.02), (0.03, 0.06), (0.0, 0.09)];
    k.turned("bulb", Stuff::Lamp.index(), at(0.3, 1.83, 0.5), &bulb, 0.015);
    k.model.lights.push(Lamp {
        light: json!({ "type": "point", "intensity": 12.0, "range": 3.0 }),
        at: Vec3::new(0.3, 1.7, 0.5),
        towards: Vec3::new(0.3, 0.0, 0.5),
    });
    let key = |eye: [f32; 3], target: [f32; 3]| Pose::new(eye.into(), target.into(), 65.0);
    // Around the table, along the worktop, and down to the crockery.
    k.model.flight = vec![
        key([-2.1, 1.6, 1.7], [0.6, 0.9, -0.8]),
        key([-1.6, 1.7, 0.2], [0.8, 1.0, -1.4]),
        key([-0.9, 1.4, -0.7], [0.2, 1.0, -2.0]),
        key([0.6, 1.5, -0.8], [1.6, 0.95, -1.8]),
        key([1.7, 1.4, 0.0], [0.3, 0.8, 0.5]),
        key([1.6, 1.1, 1.4], [-0.4, 0.8, 0.3]),
        key([0.3, 1.2, 1.7], [0.2, 0.75, 0.3]),
        key([-1.2, 2.0, 1.8], [0.5, 0.7, -0.6]),
    ];
    k.model.cameras.push(View {
        eye: Vec3::new(-2.2, 1.75, 1.8),
        target: Vec3::new(0.5, 0.85, -0.6),
        lens: perspective(52.0, 16.0 / 9.0),
    });
}
