//! Open land: hills around a lake, woods, rocks, a hut and fences.
//!
//! Stands beside the environment of the game "Outbound" that J. Barczak flew through. More
//! triangles make a finer ground, and more trees and finer ones.

use super::document::perspective;
use super::ground::Ground;
use super::material::plain;
use super::model::{Model, Part, View, at, facing};
use super::scenery::Scenery;
use super::shape::{Foliage, Quad, Ribbon, Rock, RoundedBox, Terrain};
use crate::camera::flight::Pose;
use crate::math::{DVec2, DVec3, Vec3};

/// Half the side of the land, metres.
const HALF: f64 = 300.0;

/// Materials by their place in the list.
#[derive(Clone, Copy)]
enum Stuff {
    Meadow,
    Water,
    Stone,
    Bark,
    Needle,
    Leaf,
    Shrub,
    Timber,
    Shingle,
}

fn materials() -> Vec<serde_json::Value> {
    vec![
        plain("meadow", [0.16, 0.22, 0.07], 0.0, 0.95),
        plain("water", [0.03, 0.08, 0.1], 0.0, 0.08),
        plain("stone", [0.32, 0.3, 0.28], 0.0, 0.85),
        plain("bark", [0.15, 0.1, 0.06], 0.0, 0.9),
        plain("needle", [0.03, 0.11, 0.04], 0.0, 0.8),
        plain("leaf", [0.11, 0.24, 0.04], 0.0, 0.6),
        plain("shrub", [0.14, 0.2, 0.06], 0.0, 0.8),
        plain("timber", [0.3, 0.19, 0.1], 0.0, 0.75),
        plain("shingle", [0.2, 0.16, 0.14], 0.0, 0.8),
    ]
}

/// The parts of a land for a number of triangles.
pub fn model(triangles: u64, seed: u64) -> Model {
    let mut land = Scenery::new(seed, materials());
    let ground = Ground { seed, half: HALF };
    "land".clone_into(&mut land.unit);
    land.put("ground", Stuff::Meadow as usize, at(0.0, 0.0, 0.0), Terrain(ground));
    let lake = Quad { half: DVec2::splat(HALF * 0.6) };
    land.put("lake", Stuff::Water as usize, at(0.0, 0.0, 0.0), lake);
    hut(&mut land, ground);
    fence(&mut land, ground);
    // Four hundred triangles a tree or rock, with the ground beneath it.
    let number = (triangles / 400).clamp(8, 12_000) as usize;
    for _ in 0..number {
        let (x, z) = (place(&mut land), place(&mut land));
        plant(&mut land, ground, x, z);
    }
    light_and_cameras(&mut land, ground);
    land.model.rest = Some(Part {
        name: "footpath".to_owned(),
        material: Stuff::Timber as usize,
        place: at(-20.0, ground.height(-20.0, 40.0).max(0.0) + 0.4, 40.0),
        shape: Box::new(Ribbon { length: 24.0, width: 1.2 }),
    });
    land.model
}

fn place(land: &mut Scenery) -> f64 {
    // Two numbers: more in the middle, where one walks.
    0.5 * (land.random.between(-HALF, HALF) + land.random.between(-HALF, HALF))
}

/// What grows, by height and chance.
fn plant(land: &mut Scenery, ground: Ground, x: f64, z: f64) {
    let foot = ground.at(x, z);
    let turn = land.random.between(0.0, 6.0);
    let kind = land.random.unit();
    if foot.y < 0.4 || kind < 0.16 {
        rock(land, foot, turn);
    } else if kind < 0.3 {
        land.begin("shrub", foot, turn);
        let wide = land.random.between(0.5, 1.3);
        let half = DVec3::new(wide, 0.8 * wide, wide);
        let seed = land.random.below(1 << 30) as u64;
        land.put("leaves", Stuff::Shrub as usize, at(0.0, 0.6 * wide, 0.0), Foliage { half, seed });
    } else if foot.y > 9.0 || kind < 0.62 {
        conifer(land, foot, turn);
    } else {
        broadleaf(land, foot, turn);
    }
}

fn rock(land: &mut Scenery, foot: DVec3, turn: f64) {
    land.begin("rock", foot, turn);
    let size = land.random.between(0.3, 2.2);
    let seed = land.random.below(1 << 30) as u64;
    let half = DVec3::new(1.0, land.random.between(0.5, 0.9), land.random.between(0.6, 1.0)) * size;
    land.put("rock", Stuff::Stone as usize, at(0.0, 0.2 * size, 0.0), Rock { half, seed });
}

fn conifer(land: &mut Scenery, foot: DVec3, turn: f64) {
    land.begin("conifer", foot, turn);
    let high = land.random.between(7.0, 16.0);
    let wide = high * land.random.between(0.16, 0.24);
    land.cylinder("trunk", Stuff::Bark as usize, [0.0, -0.4, 0.0], 0.02 * high, 0.4 * high);
    // Tiers that hang over one another.
    let tiers = 4 + land.random.below(3);
    let mut points = vec![(0.0, 0.18 * high)];
    for tier in 0..tiers {
        let share = tier as f64 / tiers as f64;
        let (radius, y) = (wide * (1.0 - 0.85 * share), high * (0.14 + 0.8 * share));
        points.extend([(radius, y), (0.45 * radius, y + 0.75 * 0.8 * high / tiers as f64)]);
    }
    points.push((0.0, high));
    land.turned("needles", Stuff::Needle as usize, at(0.0, 0.0, 0.0), &points, 0.0);
}

fn broadleaf(land: &mut Scenery, foot: DVec3, turn: f64) {
    land.begin("tree", foot, turn);
    let high = land.random.between(3.0, 6.0);
    let wide = high * land.random.between(0.5, 0.75);
    land.cylinder("trunk", Stuff::Bark as usize, [0.0, -0.4, 0.0], 0.05 * high, high);
    for i in 0..3 {
        let (sin, cos) = libm::sincos(2.1 * f64::from(i));
        let tip = [0.6 * wide * sin, high + 0.3 * wide, 0.6 * wide * cos];
        let bough = [[0.0, 0.7 * high, 0.0], tip];
        land.rod("bough", Stuff::Bark as usize, &bough, 0.018 * high);
    }
    let seed = land.random.below(1 << 30) as u64;
    let half = DVec3::new(wide, 0.8 * wide, wide);
    land.put(
        "crown",
        Stuff::Leaf as usize,
        at(0.0, high + 0.4 * wide, 0.0),
        Foliage { half, seed },
    );
}

/// A log hut by the shore.
fn hut(land: &mut Scenery, ground: Ground) {
    // The first place along a line from the middle that is dry.
    let spot = |i: u32| ground.at(8.0 + f64::from(i) * 3.0, 14.0 + f64::from(i) * 2.0);
    let foot = (0..60).map(spot).find(|spot| spot.y > 1.2).unwrap_or(DVec3::new(30.0, 2.0, 30.0));
    land.begin("hut", foot, 0.4);
    for layer in 0..9 {
        let y = 0.2 + 0.3 * f64::from(layer);
        for side in [-1.0, 1.0] {
            let z = side * 2.2;
            land.rod("log", Stuff::Timber as usize, &[[-3.3, y, z], [3.3, y, z]], 0.16);
            let x = side * 3.0;
            land.rod(
                "log",
                Stuff::Timber as usize,
                &[[x, y + 0.15, -2.5], [x, y + 0.15, 2.5]],
                0.16,
            );
        }
    }
    for side in [-1.0, 1.0] {
        let slope =
            facing(DVec3::new(0.0, 3.6, side * 1.3), DVec3::new(0.0, 1.0, side * 0.7).normalize());
        let roof = RoundedBox { half: DVec3::new(3.6, 0.08, 1.75), fillet: 0.01 };
        land.put("roof", Stuff::Shingle as usize, slope, roof);
    }
    land.slab("chimney", Stuff::Stone as usize, [1.8, 3.6, 0.9], [0.35, 1.3, 0.35]);
}

/// Posts and rails up a slope.
fn fence(land: &mut Scenery, ground: Ground) {
    land.begin("fence", DVec3::ZERO, 0.0);
    let post =
        |i: u32| ground.at(-60.0 + 3.0 * f64::from(i), 55.0 + 12.0 * libm::sin(f64::from(i) * 0.2));
    for i in 0..40 {
        let (here, next) = (post(i), post(i + 1));
        let top = here + DVec3::Y * 1.2;
        land.rod(
            "post",
            Stuff::Timber as usize,
            &[(here - DVec3::Y * 0.3).into(), top.into()],
            0.07,
        );
        for height in [0.5, 1.0] {
            let ends = [here, next].map(|point| (point + DVec3::Y * height).into());
            land.rod("rail", Stuff::Timber as usize, &ends, 0.05);
        }
    }
}

/// Over the lake, along a slope through the woods, and up to a view of all.
fn light_and_cameras(land: &mut Scenery, ground: Ground) {
    land.sun(Vec3::new(-0.6, 0.62, 0.5), 3.2);
    land.sun(Vec3::new(0.4, 0.8, -0.3), 0.7);
    let over = |x: f64, z: f64, above: f64| {
        (ground.at(x, z).max(DVec3::new(x, 0.0, z)) + DVec3::Y * above).as_vec3()
    };
    let key = |eye: [f64; 3], target: [f64; 3]| {
        let [eye, target] = [eye, target].map(|[x, z, above]| over(x, z, above));
        Pose::new(eye, target, 55.0)
    };
    land.model.flight = vec![
        key([-150.0, 90.0, 14.0], [0.0, 0.0, 2.0]),
        key([-80.0, 60.0, 9.0], [30.0, 0.0, 3.0]),
        key([-20.0, 45.0, 6.0], [70.0, -20.0, 4.0]),
        key([40.0, 25.0, 4.0], [120.0, -70.0, 6.0]),
        key([90.0, -30.0, 5.0], [60.0, -150.0, 8.0]),
        key([70.0, -100.0, 9.0], [-60.0, -120.0, 6.0]),
        key([-10.0, -120.0, 20.0], [-60.0, 20.0, 2.0]),
        key([-60.0, -150.0, 45.0], [20.0, 40.0, 0.0]),
    ];
    land.model.cameras.push(View {
        eye: over(-110.0, 120.0, 16.0),
        target: over(30.0, -20.0, 4.0),
        lens: perspective(45.0, 16.0 / 9.0),
    });
}
