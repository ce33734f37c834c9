//! Plates, cups, glasses, pans, bottles, jars, fruit and cutlery.

use super::size::{ROOM, WORKTOP};
use super::stuff::Stuff;
use crate::generate::model::{at, facing};
use crate::generate::scenery::Scenery;
use crate::generate::shape::{Profile, Revolve, Rock};
use crate::math::DVec3;

/// Builds them.
pub fn build(k: &mut Scenery) {
    let (left, back) = (-0.5 * ROOM.x, -0.5 * ROOM.z);
    let table = DVec3::new(0.3, 0.752, 0.5);
    for (x, z, turn) in
        [(-0.45, -0.15, 1.57), (-0.45, 0.25, 1.57), (0.45, -0.2, -1.57), (0.45, 0.22, -1.57)]
    {
        cover(k, table + DVec3::new(x, 0.0, z), turn);
    }
    fruit(k, table + DVec3::new(0.05, 0.0, 0.02));
    for i in 0..3 {
        bottle(k, table + DVec3::new(0.02 + 0.1 * f64::from(i), 0.0, -0.28));
    }
    // A pile in the rack's place, pans on the stove, a row of hooks.
    for i in 0..7 {
        k.begin("pile", DVec3::new(left + 2.75, WORKTOP[1], back + 0.36), 0.0);
        plate(k, 0.012 * f64::from(i), 0.12);
    }
    pan(k, DVec3::new(left + 3.15, 0.94, back + 0.45), 0.11, 0.9);
    pan(k, DVec3::new(left + 3.45, 0.94, back + 0.17), 0.09, 2.2);
    hooks(k, DVec3::new(left + 1.5, 1.5, back + 0.05));
    for (row, y) in [1.215, 1.565, 1.915].into_iter().enumerate() {
        for i in 0..6 {
            let foot = DVec3::new(left + 0.13, y, -0.75 + 0.18 * f64::from(i));
            match (row + i as usize) % 3 {
                0 => jar(k, foot),
                1 => cup(k, foot, f64::from(i)),
                _ => bowl(k, foot),
            }
        }
    }
    for i in 0..5 {
        bottle(k, DVec3::new(left + 3.85 + 0.09 * f64::from(i), WORKTOP[1], back + 0.12));
        jar(k, DVec3::new(left + 0.75 + 0.11 * f64::from(i % 4), WORKTOP[1], back + 0.15));
    }
}

/// A plate, a bowl on it, a cup, a glass, and knife, fork and spoon.
fn cover(k: &mut Scenery, foot: DVec3, turn: f64) {
    k.begin("cover", foot, turn);
    plate(k, 0.0, 0.13);
    plate(k, 0.014, 0.09);
    let aside = |x: f64, z: f64| {
        foot + crate::math::DAffine3::from_rotation_y(turn).transform_vector3(DVec3::new(x, 0.0, z))
    };
    cup(k, aside(0.17, -0.14), turn);
    glass(k, aside(0.02, -0.19));
    k.begin("cutlery", foot, turn);
    let steel = Stuff::Steel.index();
    for (x, tines) in [(-0.17, 4), (0.16, 0), (0.185, 1)] {
        k.rod("handle", steel, &[[x, 0.004, 0.1], [x, 0.006, -0.01]], 0.0035);
        match tines {
            0 => k.slab("blade", steel, [x, 0.005, -0.06], [0.008, 0.0012, 0.055]),
            1 => {
                let half = DVec3::new(0.014, 0.004, 0.022);
                k.put("spoon", steel, at(x, 0.006, -0.03), Rock { half, seed: 1 });
            }
            _ => {
                for i in 0..tines {
                    let x = x + 0.005 * (f64::from(i) - 1.5);
                    k.rod("tine", steel, &[[x, 0.006, -0.01], [x, 0.005, -0.06]], 0.0014);
                }
            }
        }
    }
}

fn plate(k: &mut Scenery, height: f64, radius: f64) {
    let stuff = k.random.one_of(&[Stuff::Porcelain, Stuff::Porcelain, Stuff::Blue]).index();
    let points =
        [(0.0, 0.0), (0.6, 0.0), (0.65, 0.02), (1.0, 0.13), (1.0, 0.16), (0.63, 0.06), (0.0, 0.05)];
    let points = points.map(|(r, y)| (r * radius, y * radius));
    k.turned("plate", stuff, at(0.0, height, 0.0), &points, 0.004 * radius);
}

fn bowl(k: &mut Scenery, foot: DVec3) {
    k.begin("bowl", foot, 0.0);
    let stuff = k.random.one_of(&[Stuff::Porcelain, Stuff::Blue, Stuff::Red]).index();
    let points = [
        (0.0, 0.0),
        (0.03, 0.0),
        (0.035, 0.01),
        (0.065, 0.045),
        (0.07, 0.075),
        (0.066, 0.075),
        (0.06, 0.048),
        (0.03, 0.014),
        (0.0, 0.012),
    ];
    k.turned("bowl", stuff, at(0.0, 0.0, 0.0), &points, 0.001);
}

fn cup(k: &mut Scenery, foot: DVec3, turn: f64) {
    k.begin("cup", foot, turn);
    let stuff = k.random.one_of(&[Stuff::Porcelain, Stuff::Blue, Stuff::Red]).index();
    let points = [
        (0.0, 0.0),
        (0.028, 0.0),
        (0.036, 0.012),
        (0.039, 0.09),
        (0.036, 0.09),
        (0.033, 0.014),
        (0.0, 0.008),
    ];
    k.turned("cup", stuff, at(0.0, 0.0, 0.0), &points, 0.001);
    let ear = [[0.036, 0.075, 0.0], [0.062, 0.07, 0.0], [0.062, 0.03, 0.0], [0.036, 0.022, 0.0]];
    k.rod("ear", stuff, &ear, 0.005);
}

fn glass(k: &mut Scenery, foot: DVec3) {
    k.begin("glass", foot, 0.0);
    let points = [
        (0.0, 0.0),
        (0.034, 0.0),
        (0.034, 0.003),
        (0.005, 0.01),
        (0.004, 0.075),
        (0.028, 0.105),
        (0.036, 0.14),
        (0.031, 0.19),
        (0.029, 0.19),
        (0.034, 0.14),
        (0.026, 0.107),
        (0.0, 0.082),
    ];
    k.turned("glass", Stuff::Green.index(), at(0.0, 0.0, 0.0), &points, 0.0008);
}

fn bottle(k: &mut Scenery, foot: DVec3) {
    k.begin("bottle", foot, 0.0);
    let size = k.random.between(0.8, 1.1);
    let points = [
        (0.0, 0.0),
        (0.036, 0.0),
        (0.036, 0.19),
        (0.014, 0.23),
        (0.013, 0.29),
        (0.016, 0.295),
        (0.0, 0.3),
    ];
    let points = points.map(|(r, y)| (r * size, y * size));
    let stuff = k.random.one_of(&[Stuff::Green, Stuff::Green, Stuff::Oak]).index();
    k.turned("bottle", stuff, at(0.0, 0.0, 0.0), &points, 0.006);
}

fn jar(k: &mut Scenery, foot: DVec3) {
    k.begin("jar", foot, 0.0);
    let size = k.random.between(0.8, 1.2);
    let points =
        [(0.0, 0.0), (0.045, 0.0), (0.048, 0.01), (0.048, 0.1), (0.036, 0.12), (0.0, 0.12)];
    let stuff = k.random.one_of(&[Stuff::Cream, Stuff::Yellow, Stuff::Oak, Stuff::Sage]).index();
    k.turned("jar", stuff, at(0.0, 0.0, 0.0), &points.map(|(r, y)| (r * size, y * size)), 0.006);
    k.cylinder("lid", Stuff::Iron.index(), [0.0, 0.12 * size, 0.0], 0.04 * size, 0.016);
}

fn pan(k: &mut Scenery, foot: DVec3, radius: f64, turn: f64) {
    k.begin("pan", foot, turn);
    let stuff = k.random.one_of(&[Stuff::Copper, Stuff::Steel]).index();
    let points =
        [(0.0, 0.0), (0.9, 0.0), (1.0, 0.1), (1.0, 0.75), (0.97, 0.75), (0.96, 0.12), (0.0, 0.06)];
    let points = points.map(|(r, y)| (r * radius, y * radius));
    k.turned("pan", stuff, at(0.0, 0.0, 0.0), &points, 0.03 * radius);
    let handle = [[0.95 * radius, 0.5 * radius, 0.0], [radius + 0.16, 0.6 * radius, 0.0]];
    k.rod("handle", Stuff::Iron.index(), &handle, 0.008);
}

/// Ladles and spoons on a rail.
fn hooks(k: &mut Scenery, middle: DVec3) {
    k.begin("hooks", middle, 0.0);
    let steel = Stuff::Steel.index();
    k.rod("rail", steel, &[[-0.28, 0.0, 0.0], [0.28, 0.0, 0.0]], 0.006);
    for i in 0..6 {
        let x = (f64::from(i) - 2.5) * 0.09;
        let long = k.random.between(0.18, 0.28);
        let hook = [[x, 0.012, 0.0], [x, 0.012, 0.014], [x, -long, 0.014]];
        k.rod("hook", steel, &hook, 0.003);
        if i % 2 == 0 {
            let ladle = [
                (0.0, 0.0),
                (0.03, 0.01),
                (0.04, 0.035),
                (0.038, 0.035),
                (0.028, 0.013),
                (0.0, 0.003),
            ];
            let place = at(x, -long - 0.03, 0.03);
            k.turned("ladle", Stuff::Copper.index(), place, &ladle, 0.001);
        } else {
            let place = facing(DVec3::new(x, -long - 0.02, 0.012), DVec3::Z);
            k.put("skimmer", steel, place, Revolve(Profile::cylinder(0.038, 0.003, 0.001)));
        }
    }
}

fn fruit(k: &mut Scenery, foot: DVec3) {
    k.begin("fruit", foot, 0.0);
    let points = [
        (0.0, 0.0),
        (0.06, 0.0),
        (0.05, 0.02),
        (0.12, 0.05),
        (0.15, 0.09),
        (0.146, 0.09),
        (0.115, 0.056),
        (0.0, 0.035),
    ];
    k.turned("bowl", Stuff::Copper.index(), at(0.0, 0.0, 0.0), &points, 0.002);
    for i in 0..8 {
        let (sin, cos) = libm::sincos(f64::from(i) * 0.9);
        let (out, up) = if i < 6 { (0.085, 0.085) } else { (0.03, 0.13) };
        let stuff = k.random.one_of(&[Stuff::Red, Stuff::Yellow, Stuff::Green]).index();
        let half = DVec3::new(0.036, 0.034, 0.036);
        let seed = k.random.below(1000) as u64;
        k.put("fruit", stuff, at(out * sin, up, out * cos), Rock { half, seed });
    }
}
