//! Stove, fridge, sink, hood, and what stands on the worktop with a cable.

use super::size::{ROOM, WORKTOP};
use super::stuff::Stuff;
use crate::generate::model::{at, facing};
use crate::generate::scenery::Scenery;
use crate::generate::shape::{Honeycomb, Profile, Revolve};
use crate::math::DVec3;

/// Builds them.
pub fn build(k: &mut Scenery) {
    let (left, back) = (-0.5 * ROOM.x, -0.5 * ROOM.z);
    stove(k, DVec3::new(left + 3.3, 0.0, back));
    hood(k, DVec3::new(left + 3.3, 1.6, back));
    sink(k, DVec3::new(left + 1.5, WORKTOP[1], back + 0.33));
    fridge(k, DVec3::new(2.28, 0.0, 1.72));
    toaster(k, DVec3::new(left + 0.45, WORKTOP[1], back + 0.35));
    kettle(k, DVec3::new(left + 4.2, WORKTOP[1], back + 0.35));
    mixer(k, DVec3::new(left + 2.3, WORKTOP[1], back + 0.3));
}

fn stove(k: &mut Scenery, foot: DVec3) {
    k.begin("stove", foot, 0.0);
    k.slab("case", Stuff::Steel.index(), [0.0, 0.45, 0.31], [0.297, 0.45, 0.3]);
    k.slab("oven door", Stuff::Iron.index(), [0.0, 0.38, 0.62], [0.27, 0.28, 0.015]);
    let bar = [[-0.22, 0.62, 0.63], [-0.22, 0.62, 0.68], [0.22, 0.62, 0.68], [0.22, 0.62, 0.63]];
    k.rod("bar", Stuff::Steel.index(), &bar, 0.009);
    for i in 0..5 {
        let place = facing(DVec3::new((f64::from(i) - 2.0) * 0.1, 0.79, 0.615), DVec3::Z);
        let knob = [(0.0, 0.0), (0.024, 0.0), (0.02, 0.022), (0.012, 0.026), (0.0, 0.026)];
        k.turned("knob", Stuff::Iron.index(), place, &knob, 0.002);
    }
    for (x, z) in [(-0.15, 0.17), (0.15, 0.17), (0.15, 0.45), (-0.15, 0.45)] {
        let burner = Revolve(Profile::ring(0.02, 0.05, 0.012, 0.003));
        k.put("burner", Stuff::Brass.index(), at(x, 0.9, z), burner);
        for turn in 0..4 {
            let (sin, cos) = libm::sincos(f64::from(turn) * std::f64::consts::FRAC_PI_2);
            let foot = |r: f64, y: f64| [x + r * sin, y, z + r * cos];
            let grate = [foot(0.11, 0.9), foot(0.11, 0.93), foot(0.03, 0.93)];
            k.rod("grate", Stuff::Iron.index(), &grate, 0.006);
        }
    }
}

fn hood(k: &mut Scenery, foot: DVec3) {
    k.begin("hood", foot, 0.0);
    k.slab("canopy", Stuff::Steel.index(), [0.0, 0.06, 0.24], [0.3, 0.05, 0.24]);
    let filter = Honeycomb { half: crate::math::DVec2::new(0.26, 0.2), thickness: 0.012 };
    k.put("filter", Stuff::Steel.index(), at(0.0, 0.0, 0.24), filter);
    k.slab("flue", Stuff::Steel.index(), [0.0, 0.6, 0.14], [0.13, 0.49, 0.13]);
}

/// A basin in the gap of the worktop, a tap and a draining rack.
fn sink(k: &mut Scenery, rim: DVec3) {
    k.begin("sink", rim, 0.0);
    let steel = Stuff::Steel.index();
    k.slab("bottom", steel, [0.0, -0.18, 0.0], [0.29, 0.008, 0.21]);
    for (x, z, a, b) in [
        (-0.285, 0.0, 0.01, 0.21),
        (0.285, 0.0, 0.01, 0.21),
        (0.0, -0.2, 0.29, 0.01),
        (0.0, 0.2, 0.29, 0.01),
    ] {
        k.slab("side", steel, [x, -0.085, z], [a, 0.095, b]);
    }
    let drain = Revolve(Profile::ring(0.02, 0.04, 0.006, 0.002));
    k.put("drain", steel, at(0.0, -0.172, 0.0), drain);
    k.cylinder("tap foot", steel, [0.0, 0.0, -0.27], 0.025, 0.05);
    let spout = [[0.0, 0.05, -0.27], [0.0, 0.3, -0.27], [0.0, 0.3, -0.06], [0.0, 0.22, -0.06]];
    k.rod("spout", steel, &spout, 0.012);
    for x in [-0.09, 0.09] {
        k.cylinder("valve", steel, [x, 0.0, -0.27], 0.014, 0.06);
        k.rod("lever", steel, &[[x, 0.065, -0.27], [x, 0.075, -0.2]], 0.007);
    }
    // To the right, on the worktop.
    for i in 0..12 {
        let x = 0.36 + 0.03 * f64::from(i);
        let hoop = [[x, 0.01, -0.18], [x, 0.12, -0.18], [x, 0.12, 0.16], [x, 0.01, 0.16]];
        k.rod("rack", steel, &hoop, 0.003);
    }
    for z in [-0.18, 0.16] {
        k.rod("rack", steel, &[[0.34, 0.01, z], [0.72, 0.01, z]], 0.004);
    }
}

fn fridge(k: &mut Scenery, foot: DVec3) {
    k.begin("fridge", foot, std::f64::consts::PI);
    let white = Stuff::White.index();
    k.slab("case", white, [0.0, 0.92, 0.0], [0.3, 0.9, 0.3]);
    for (y, half) in [(0.62, 0.57), (1.52, 0.29)] {
        k.slab("door", white, [0.0, y, 0.32], [0.298, half, 0.02]);
        let handle = [
            [-0.25, y - 0.12, 0.34],
            [-0.25, y - 0.12, 0.38],
            [-0.25, y + 0.12, 0.38],
            [-0.25, y + 0.12, 0.34],
        ];
        k.rod("handle", Stuff::Steel.index(), &handle, 0.009);
    }
    for i in 0..6 {
        let (x, y) = (k.random.between(-0.15, 0.2), k.random.between(0.9, 1.7));
        let stuff = k.random.one_of(&[Stuff::Red, Stuff::Yellow, Stuff::Blue]).index();
        let magnet = Revolve(Profile::cylinder(0.014, 0.006, 0.002));
        k.put("magnet", stuff, facing(DVec3::new(x, y, 0.34), DVec3::Z), magnet);
        if i % 2 == 0 {
            k.slab("note", Stuff::Cream.index(), [x, y - 0.04, 0.342], [0.04, 0.05, 0.0008]);
        }
    }
}

fn toaster(k: &mut Scenery, foot: DVec3) {
    k.begin("toaster", foot, 0.3);
    k.slab("case", Stuff::Steel.index(), [0.0, 0.1, 0.0], [0.15, 0.085, 0.085]);
    for z in [-0.03, 0.03] {
        k.slab("slot", Stuff::Iron.index(), [0.0, 0.186, z], [0.11, 0.002, 0.014]);
    }
    k.slab("toast", Stuff::Oak.index(), [0.0, 0.19, 0.03], [0.055, 0.04, 0.008]);
    k.slab("lever", Stuff::Iron.index(), [0.157, 0.13, 0.0], [0.01, 0.008, 0.02]);
    let cable = [[-0.15, 0.03, 0.0], [-0.2, 0.02, 0.0], [-0.25, 0.02, -0.15], [-0.25, 0.1, -0.3]];
    k.rod("cable", Stuff::Iron.index(), &cable, 0.004);
}

fn kettle(k: &mut Scenery, foot: DVec3) {
    k.begin("kettle", foot, -0.6);
    let body = [(0.0, 0.0), (0.09, 0.0), (0.1, 0.03), (0.07, 0.16), (0.04, 0.18), (0.0, 0.185)];
    k.turned("body", Stuff::Red.index(), at(0.0, 0.0, 0.0), &body, 0.012);
    let knob = [(0.0, 0.0), (0.012, 0.0), (0.016, 0.015), (0.0, 0.024)];
    k.turned("knob", Stuff::Iron.index(), at(0.0, 0.185, 0.0), &knob, 0.004);
    k.rod(
        "spout",
        Stuff::Red.index(),
        &[[0.07, 0.06, 0.0], [0.12, 0.1, 0.0], [0.14, 0.16, 0.0]],
        0.014,
    );
    let handle = [[-0.06, 0.16, 0.0], [-0.07, 0.25, 0.0], [0.05, 0.25, 0.0], [0.05, 0.17, 0.0]];
    k.rod("handle", Stuff::Iron.index(), &handle, 0.008);
}

fn mixer(k: &mut Scenery, foot: DVec3) {
    k.begin("mixer", foot, 0.5);
    let paint = Stuff::Blue.index();
    k.slab("foot", paint, [0.0, 0.02, 0.0], [0.17, 0.02, 0.1]);
    k.slab("column", paint, [-0.11, 0.15, 0.0], [0.045, 0.13, 0.05]);
    k.slab("head", paint, [0.02, 0.3, 0.0], [0.18, 0.055, 0.06]);
    let bowl = [(0.0, 0.0), (0.05, 0.0), (0.06, 0.01), (0.1, 0.12), (0.105, 0.12), (0.062, 0.004)];
    k.turned("bowl", Stuff::Steel.index(), at(0.07, 0.045, 0.0), &bowl, 0.002);
    for turn in 0..5 {
        let (sin, cos) = libm::sincos(f64::from(turn) * 1.2566);
        let wire = [[0.07, 0.24, 0.0], [0.07 + 0.05 * sin, 0.14, 0.05 * cos], [0.07, 0.07, 0.0]];
        k.rod("whisk", Stuff::Steel.index(), &wire, 0.002);
    }
}
