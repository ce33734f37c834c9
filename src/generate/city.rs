//! A town of blocks along streets: few triangles, most of them large.
//!
//! Stands beside the city of Lext, Assarsson and Möller, "A benchmark for animated ray tracing"
//! (2001), which J. Barczak flew through. More triangles make more blocks, and more of each house.

use super::document::perspective;
use super::material::plain;
use super::model::{Model, Part, View, at, facing};
use super::scenery::Scenery;
use super::shape::{Bore, Foliage, Plate, Profile, Quad, Revolve, Ribbon, Rock};
use crate::camera::flight::Pose;
use crate::math::{DVec2, DVec3, Vec3};

/// From the middle of a block to that of the next, metres.
const PITCH: f64 = 46.0;
/// Half of a block's side; what is left is street.
const BLOCK: f64 = 16.0;

/// Materials by their place in the list.
#[derive(Clone, Copy)]
enum Stuff {
    Asphalt,
    Pavement,
    Grass,
    Brick,
    Plaster,
    Concrete,
    Glass,
    Tile,
    Steel,
    Wood,
    Leaf,
    Paint,
}

fn materials() -> Vec<serde_json::Value> {
    vec![
        plain("asphalt", [0.07, 0.07, 0.075], 0.0, 0.9),
        plain("pavement", [0.36, 0.35, 0.33], 0.0, 0.85),
        plain("grass", [0.09, 0.19, 0.05], 0.0, 0.95),
        plain("brick", [0.36, 0.13, 0.08], 0.0, 0.8),
        plain("plaster", [0.72, 0.64, 0.5], 0.0, 0.75),
        plain("concrete", [0.46, 0.46, 0.45], 0.0, 0.7),
        plain("glass", [0.12, 0.2, 0.26], 0.9, 0.12),
        plain("tile", [0.28, 0.1, 0.06], 0.0, 0.7),
        plain("steel", [0.5, 0.5, 0.52], 1.0, 0.4),
        plain("wood", [0.2, 0.12, 0.06], 0.0, 0.8),
        plain("leaf", [0.07, 0.22, 0.04], 0.0, 0.7),
        plain("paint", [0.55, 0.08, 0.05], 0.0, 0.3),
    ]
}

/// Walls that houses may have.
const WALLS: [Stuff; 4] = [Stuff::Brick, Stuff::Plaster, Stuff::Concrete, Stuff::Glass];

/// The parts of a town for a number of triangles.
pub fn model(triangles: u64, seed: u64) -> Model {
    let side = ((triangles as f64 / 250.0).sqrt() as usize).clamp(2, 40);
    let mut city = Scenery::new(seed, materials());
    let half = side as f64 * PITCH * 0.5;
    "town".clone_into(&mut city.unit);
    let ground = Quad { half: DVec2::splat(half + 30.0) };
    city.put("ground", Stuff::Asphalt as usize, at(0.0, 0.0, 0.0), ground);
    for i in 0..side {
        for j in 0..side {
            let middle = |n: usize| (n as f64 + 0.5) * PITCH - half;
            block(&mut city, DVec3::new(middle(i), 0.0, middle(j)), half);
        }
    }
    light_and_cameras(&mut city, half);
    city.model.rest = Some(Part {
        name: "bunting".to_owned(),
        material: Stuff::Paint as usize,
        place: at(0.0, 7.0, if side.is_multiple_of(2) { 0.0 } else { 0.5 * PITCH }),
        shape: Box::new(Ribbon { length: 1.6 * half, width: 0.6 }),
    });
    city.model
}

fn block(city: &mut Scenery, middle: DVec3, half: f64) {
    city.begin("block", middle, 0.0);
    let park = city.random.chance(0.12);
    let cover = if park { Stuff::Grass } else { Stuff::Pavement };
    city.slab("kerb", cover as usize, [0.0, 0.08, 0.0], [BLOCK + 2.0, 0.08, BLOCK + 2.0]);
    if park {
        for _ in 0..9 {
            let spot = DVec3::new(chance(city, BLOCK), 0.16, chance(city, BLOCK));
            tree(city, middle + spot);
        }
        city.begin("pond", middle, 0.0);
        let basin = Profile::ring(2.6, 3.0, 0.6, 0.1);
        city.put("basin", Stuff::Concrete as usize, at(0.0, 0.1, 0.0), Revolve(basin));
        return;
    }
    // Higher towards the middle of the town.
    let central = 1.0 - middle.length() / (half * 1.5);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let lot = middle + DVec3::new(x * 8.0, 0.16, z * 8.0);
        let high = city.random.chance(0.75 * central * central);
        if high {
            tower(city, lot, central);
        } else {
            house(city, lot, if x * z > 0.0 { 0.0 } else { std::f64::consts::FRAC_PI_2 });
        }
    }
    for (x, z, turn) in [(0.0, 1.0, 0.0), (1.0, 0.0, 1.0)] {
        street(city, middle, DVec3::new(x, 0.0, z) * (BLOCK + 1.2), turn);
    }
}

fn chance(city: &mut Scenery, half: f64) -> f64 {
    city.random.between(-half, half)
}

/// Storeys of one plan after the other, narrower ones above.
fn tower(city: &mut Scenery, foot: DVec3, central: f64) {
    city.begin("tower", foot, 0.0);
    let wall = city.random.one_of(&WALLS) as usize;
    let (mut x, mut z) = (city.random.between(5.5, 7.4), city.random.between(5.5, 7.4));
    let mut y = 0.0;
    for _ in 0..=city.random.below(3) {
        let height = city.random.between(6.0, 14.0 + 22.0 * central);
        city.slab("body", wall, [0.0, y + 0.5 * height, 0.0], [x, 0.5 * height, z]);
        y += height;
        city.slab("cornice", Stuff::Concrete as usize, [0.0, y, 0.0], [x + 0.35, 0.3, z + 0.35]);
        for storey in 1..(height / 3.4) as usize {
            let sill = y - height + 3.4 * storey as f64;
            city.slab("sill", Stuff::Glass as usize, [0.0, sill, 0.0], [x + 0.1, 0.5, z + 0.1]);
        }
        (x, z) = (x * city.random.between(0.55, 0.9), z * city.random.between(0.55, 0.9));
    }
    city.slab("hut", Stuff::Concrete as usize, [0.2 * x, y + 1.2, -0.3 * z], [1.2, 1.2, 1.5]);
    if city.random.chance(0.4) {
        city.cylinder("tank", Stuff::Wood as usize, [-0.4 * x, y + 0.3, 0.3 * z], 1.1, 2.6);
    }
    if city.random.chance(0.5) {
        let mast = [[0.5 * x, y, 0.4 * z], [0.5 * x, y + 9.0, 0.4 * z]];
        city.rod("mast", Stuff::Steel as usize, &mast, 0.12);
    }
}

/// A house under a gable.
fn house(city: &mut Scenery, foot: DVec3, turn: f64) {
    city.begin("house", foot, turn);
    let wall = city.random.one_of(&WALLS[..3]) as usize;
    let (x, z) = (city.random.between(5.2, 7.2), city.random.between(4.6, 6.6));
    let height = city.random.between(5.0, 12.0);
    city.slab("walls", wall, [0.0, 0.5 * height, 0.0], [x, 0.5 * height, z]);
    // A wedge along X: of its outline, the first axis lies upwards, the second along Z.
    let rise = city.random.between(2.0, 4.0);
    let corners = [(-rise / 3.0, -z - 0.5), (2.0 * rise / 3.0, 0.0), (-rise / 3.0, z + 0.5)];
    let outline = Profile::closed(&corners.map(|(up, side)| (DVec2::new(up, side), 0.0)));
    let roof = Plate { outline, bore: Bore::None, height: 2.0 * x + 0.8, twist: 0.0 };
    let eaves = DVec3::new(-x - 0.4, height + rise / 3.0, 0.0);
    city.put("roof", Stuff::Tile as usize, facing(eaves, DVec3::X), roof);
    let chimney = chance(city, 0.7 * x);
    let above = [chimney, height + 0.6 * rise, 0.3 * z];
    city.slab("chimney", Stuff::Brick as usize, above, [0.45, 1.6, 0.45]);
    for storey in 0..(height / 3.2) as usize {
        let y = 1.6 + 3.2 * storey as f64;
        for side in [-1.0, 1.0] {
            for i in 0..3 {
                let place = [(f64::from(i) - 1.0) * 0.6 * x, y, side * z];
                city.slab("window", Stuff::Glass as usize, place, [0.6, 0.75, 0.08]);
            }
        }
    }
    city.slab("door", Stuff::Wood as usize, [0.3 * x, 1.1, z], [0.55, 1.1, 0.12]);
}

/// Lamps, trees and cars along a side of a block.
fn street(city: &mut Scenery, middle: DVec3, side: DVec3, turn: f64) {
    let quarter = turn * std::f64::consts::FRAC_PI_2;
    let along = DVec3::new(side.z, 0.0, side.x).normalize();
    for i in [-1.0, 1.0] {
        city.begin("lamp", middle + side + along * (9.0 * i), quarter);
        let pole = [[0.0, 0.1, 0.0], [0.0, 5.6, 0.0], [0.0, 5.9, 1.4]];
        city.rod("pole", Stuff::Steel as usize, &pole, 0.08);
        city.slab("head", Stuff::Concrete as usize, [0.0, 5.85, 1.5], [0.16, 0.08, 0.4]);
    }
    for i in [-0.45, 0.5] {
        if city.random.chance(0.6) {
            tree(city, middle + side + along * (BLOCK * i));
        }
    }
    for _ in 0..2 {
        if city.random.chance(0.6) {
            let along = along * chance(city, BLOCK);
            car(city, middle + side * 1.22 + along, quarter);
        }
    }
}

fn tree(city: &mut Scenery, foot: DVec3) {
    city.begin("tree", foot, 0.0);
    let high = city.random.between(3.5, 6.0);
    city.cylinder("trunk", Stuff::Wood as usize, [0.0, 0.0, 0.0], 0.22, high);
    let (wide, seed) = (city.random.between(1.5, 2.4), city.random.below(1 << 30) as u64);
    let half = DVec3::new(wide, 0.9 * wide, wide);
    let place = at(0.0, high + 0.5 * wide, 0.0);
    if city.random.chance(0.7) {
        city.put("crown", Stuff::Leaf as usize, place, Rock { half, seed });
    } else {
        city.put("leaves", Stuff::Leaf as usize, place, Foliage { half, seed });
    }
}

fn car(city: &mut Scenery, foot: DVec3, turn: f64) {
    city.begin("car", foot, turn);
    let paint = city.random.one_of(&[Stuff::Paint, Stuff::Steel, Stuff::Plaster]) as usize;
    city.slab("body", paint, [0.0, 0.65, 0.0], [2.1, 0.35, 0.85]);
    city.slab("cabin", Stuff::Glass as usize, [-0.2, 1.2, 0.0], [1.1, 0.28, 0.75]);
    for (x, z) in [(1.3, 0.8), (1.3, -0.8), (-1.3, 0.8), (-1.3, -0.8)] {
        let wheel = Profile::cylinder(0.33, 0.2, 0.04);
        let axle = facing(DVec3::new(x, 0.33, z - 0.1), DVec3::Z);
        city.put("wheel", Stuff::Asphalt as usize, axle, Revolve(wheel));
    }
}

/// Along a street, up over the roofs, around, and down into another.
fn light_and_cameras(city: &mut Scenery, half: f64) {
    city.sun(Vec3::new(0.55, 0.75, 0.35), 3.0);
    city.sun(Vec3::new(-0.5, 0.6, -0.6), 0.8);
    // The middle of a street: between two blocks.
    let street =
        PITCH as f32 * if ((half * 2.0 / PITCH) as u64).is_multiple_of(2) { 0.0 } else { 0.5 };
    let edge = half as f32;
    let key = |eye: [f32; 3], target: [f32; 3]| Pose::new(eye.into(), target.into(), 60.0);
    city.model.flight = vec![
        key([-edge - 20.0, 6.0, street], [0.0, 10.0, street]),
        key([-0.6 * edge, 3.0, street + 2.0], [0.2 * edge, 8.0, street]),
        key([-0.2 * edge, 12.0, street], [0.6 * edge, 10.0, street + 8.0]),
        key([0.1 * edge, 45.0, street + 10.0], [0.5 * edge, 12.0, -0.5 * edge]),
        key([0.4 * edge, 60.0, 0.4 * edge], [-0.1 * edge, 10.0, -0.3 * edge]),
        key([street, 40.0, 0.7 * edge], [street, 8.0, -0.2 * edge]),
        key([street, 5.0, 0.45 * edge], [street, 6.0, -0.5 * edge]),
        key([street - 2.0, 2.0, 0.1 * edge], [street, 9.0, -0.8 * edge]),
    ];
    city.model.cameras.push(View {
        eye: Vec3::new(0.75 * edge, 62.0, 0.95 * edge),
        target: Vec3::new(-0.05 * edge, 6.0, 0.0),
        lens: perspective(45.0, 16.0 / 9.0),
    });
}
