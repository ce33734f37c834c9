//! Gears between two plates, the front one open to view.

use super::finish::Finish;
use super::fittings::{bolt, bolt_circle, cylinder, nut, port, ring, spring};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Plate, RoundedBox};
use crate::math::DVec3;

/// Pitch diameter of a gear for each of its teeth.
const MODULE: f64 = 0.0062;

pub fn build(a: &mut Assembly) {
    let plate = DVec3::new(0.27, 0.24, 0.012);
    let paint = a.random.one_of(&[Finish::Grey, Finish::Green, Finish::Blue]);
    a.put("back plate", paint, at(0.0, 0.0, -0.17), RoundedBox { half: plate, fillet: 0.01 });
    let foot = DVec3::new(0.28, 0.015, 0.19);
    a.put("foot", paint, at(0.0, -0.245, 0.0), RoundedBox { half: foot, fillet: 0.008 });
    let bridge = DVec3::new(0.27, 0.035, 0.012);
    a.put("bridge", paint, at(0.0, 0.02, 0.16), RoundedBox { half: bridge, fillet: 0.01 });
    for (x, y) in [(-0.25, 0.21), (0.25, 0.21), (-0.25, -0.2), (0.25, -0.2), (0.0, 0.22)] {
        let post = facing(DVec3::new(x, y, -0.16), DVec3::Z);
        cylinder(a, "pillar", Finish::Chrome, post, 0.014, 0.32);
        nut(a, Finish::Steel, post * at(0.0, 0.32, 0.0), 0.02, 0.014);
        bolt(a, DVec3::new(x, y, 0.185), DVec3::Z, 0.006);
    }
    for x in [-0.25, -0.1, 0.1, 0.25] {
        bolt(a, DVec3::new(x, 0.02, 0.172), DVec3::Z, 0.006);
        bolt(a, DVec3::new(x, -0.23, 0.17), DVec3::Y, 0.007);
    }
    trains(a);
    for x in [-0.22, 0.22] {
        spring(a, Finish::Red, at(x, -0.2, 0.1), [0.02, 0.004], 0.2, 9);
    }
    port(a, DVec3::new(0.2, 0.12, -0.15), DVec3::Z, 0.014);
    port(a, DVec3::new(-0.2, -0.2, 0.13), DVec3::Z, 0.016);
}

/// Two rows of gears that mesh, one before the other, on common shafts.
fn trains(a: &mut Assembly) {
    let [big, middle, small] =
        [36 + a.random.below(6), 26 + a.random.below(6), 16 + a.random.below(4)];
    for (row, z) in [(0, -0.135), (1, -0.045), (2, 0.065)] {
        let teeth = [[big, small, middle], [small, big, small], [middle, small, big]][row];
        let mut x = -0.16;
        let mut y = 0.02;
        for (i, &number) in teeth.iter().enumerate() {
            if i > 0 {
                let step = 0.5 * MODULE * (teeth[i - 1] + number) as f64;
                let rise = a.random.between(-0.4, 0.4);
                x += step * (1.0 - rise * rise).sqrt();
                y += step * rise;
            }
            let turn = if i % 2 == 0 { 0.0 } else { std::f64::consts::PI / number as f64 };
            gear(a, DVec3::new(x, y.clamp(-0.09, 0.1), z), number, turn, i);
        }
    }
    for x in [-0.16, 0.04] {
        let shaft = facing(DVec3::new(x, 0.02, -0.2), DVec3::Z);
        cylinder(a, "shaft", Finish::Chrome, shaft, 0.016, 0.42);
        for y in [0.02, 0.36] {
            ring(a, "bearing", Finish::Steel, shaft * at(0.0, y, 0.0), [0.015, 0.036], 0.02);
            rollers(a, DVec3::new(x, 0.02, -0.178 + y));
        }
        nut(a, Finish::Brass, shaft * at(0.0, 0.39, 0.0), 0.026, 0.015);
    }
}

fn gear(a: &mut Assembly, centre: DVec3, number: usize, turn: f64, place: usize) {
    let radius = 0.5 * MODULE * (number + 2) as f64;
    let bore = 0.45 * radius;
    let width = 0.05;
    let finish = [Finish::Steel, Finish::Brass, Finish::DarkSteel][place % 3];
    let twist = [0.12, 0.0, -0.12][place % 3];
    let axle = facing(centre, DVec3::Z);
    let turned = axle * crate::math::DAffine3::from_rotation_y(turn);
    a.put("gear", finish, turned, Plate::gear(number, radius, bore, width, twist));
    ring(
        a,
        "web",
        finish,
        axle * at(0.0, 0.35 * width, 0.0),
        [0.3 * bore, 1.05 * bore],
        0.3 * width,
    );
    ring(a, "hub", Finish::Steel, axle * at(0.0, -0.1 * width, 0.0), [0.012, 0.026], 1.2 * width);
    bolt_circle(a, centre + DVec3::Z * (0.65 * width), DVec3::Z, 0.65 * bore, 5, 0.003);
    cylinder(a, "axle", Finish::Chrome, axle * at(0.0, -0.03, 0.0), 0.012, 0.1);
}

/// The rollers of a bearing.
fn rollers(a: &mut Assembly, centre: DVec3) {
    for i in 0..7 {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / 7.0);
        let place = facing(centre + DVec3::new(cos, sin, 0.0) * 0.026, DVec3::Z);
        cylinder(a, "roller", Finish::Chrome, place, 0.005, 0.026);
    }
}
