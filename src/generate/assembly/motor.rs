//! An electric motor with a ribbed housing, a fan behind a honeycomb, a coupling.

use super::finish::Finish;
use super::fittings::{bolt_circle, bolt_row, cylinder, nut, port, ring, turned};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Bore, Honeycomb, Path, Plate, Profile, Revolve, RoundedBox, Tube};
use crate::math::{DVec2, DVec3};

pub fn build(a: &mut Assembly) {
    let paint = a.random.one_of(&[Finish::Blue, Finish::Green, Finish::Grey]);
    let radius = 0.15;
    let axle = facing(DVec3::new(-0.17, -0.02, 0.0), DVec3::X);
    let ribs = Profile::teeth(44, 0.87 * radius, radius);
    a.put(
        "housing",
        paint,
        axle,
        Plate { outline: ribs, bore: Bore::Round(0.8 * radius), height: 0.3, twist: 0.0 },
    );
    windings(a, 0.6 * radius);
    let bell = [
        (0.03, -0.07),
        (0.06, -0.075),
        (0.12, -0.03),
        (0.155, -0.02),
        (0.155, 0.012),
        (0.125, 0.02),
    ];
    a.put("end bell", paint, axle, Revolve(turned(&bell, 0.008)));
    let mirrored =
        axle * at(0.0, 0.3, 0.0) * crate::math::DAffine3::from_rotation_x(std::f64::consts::PI);
    a.put("end bell", paint, mirrored, Revolve(turned(&bell, 0.008)));
    bolt_circle(a, DVec3::new(0.15, -0.02, 0.0), DVec3::X, 0.143, 8, 0.005);
    cylinder(a, "shaft", Finish::Chrome, axle * at(0.0, -0.1, 0.0), 0.022, 0.56);
    coupling(a);
    fan_cover(a, paint);
    for z in [-0.11, 0.11] {
        let half = DVec3::new(0.14, 0.02, 0.045);
        a.put("foot", paint, at(-0.02, -0.22, z), RoundedBox { half, fillet: 0.008 });
        let web = DVec3::new(0.12, 0.06, 0.01);
        a.put(
            "foot web",
            paint,
            at(-0.02, -0.15, z * 0.85),
            RoundedBox { half: web, fillet: 0.006 },
        );
        let row = [-0.13, 0.09].map(|x| DVec3::new(x, -0.2, z * 1.2));
        bolt_row(a, row[0], row[1], DVec3::Y, 2, 0.009);
    }
    terminal_box(a);
    port(a, DVec3::new(0.06, 0.17, -0.05), DVec3::Y, 0.014);
}

/// Copper between the housing and the rotor.
fn windings(a: &mut Assembly, radius: f64) {
    let axle = facing(DVec3::new(-0.15, -0.02, 0.0), DVec3::X);
    let path = Path::Helix { radius, pitch: 0.012, turns: 20 };
    a.put("winding", Finish::Copper, axle, Tube { path, radius: 0.0055, ripples: 0 });
    let rotor = Plate::gear(28, 0.85 * radius, 0.02, 0.24, 0.2);
    a.put("rotor", Finish::DarkSteel, axle, rotor);
}

fn coupling(a: &mut Assembly) {
    let axle = facing(DVec3::new(0.19, -0.02, 0.0), DVec3::X);
    for y in [0.0, 0.03] {
        ring(a, "coupling flange", Finish::Steel, axle * at(0.0, y, 0.0), [0.02, 0.07], 0.018);
    }
    ring(a, "coupling disc", Finish::Rubber, axle * at(0.0, 0.017, 0.0), [0.02, 0.064], 0.014);
    ring(a, "coupling hub", Finish::Steel, axle * at(0.0, 0.04, 0.0), [0.02, 0.038], 0.05);
    bolt_circle(a, DVec3::new(0.238, -0.02, 0.0), DVec3::X, 0.054, 8, 0.005);
}

fn fan_cover(a: &mut Assembly, paint: Finish) {
    let axle = facing(DVec3::new(-0.19, -0.02, 0.0), DVec3::NEG_X);
    ring(a, "fan cover", paint, axle, [0.15, 0.16], 0.07);
    let half = DVec2::new(0.108, 0.108);
    a.put(
        "grille",
        Finish::DarkSteel,
        axle * at(0.0, 0.065, 0.0),
        Honeycomb { half, thickness: 0.008 },
    );
    ring(a, "grille rim", paint, axle * at(0.0, 0.06, 0.0), [0.1, 0.158], 0.012);
    for i in 0..7 {
        let turn =
            crate::math::DAffine3::from_rotation_y(std::f64::consts::TAU * f64::from(i) / 7.0);
        let tilt = crate::math::DAffine3::from_rotation_x(0.6);
        let half = DVec3::new(0.055, 0.0015, 0.022);
        let place = axle * turn * at(0.075, 0.03, 0.0) * tilt;
        a.put("fan blade", Finish::Aluminium, place, RoundedBox { half, fillet: 0.001 });
    }
}

fn terminal_box(a: &mut Assembly) {
    let half = DVec3::new(0.075, 0.04, 0.06);
    a.put("terminal box", Finish::Grey, at(-0.04, 0.16, 0.03), RoundedBox { half, fillet: 0.008 });
    let lid = DVec3::new(0.08, 0.008, 0.065);
    a.put(
        "terminal lid",
        Finish::Aluminium,
        at(-0.04, 0.205, 0.03),
        RoundedBox { half: lid, fillet: 0.004 },
    );
    for z in [-0.028, 0.088] {
        let [from, to] = [-0.112, 0.032].map(|x| DVec3::new(x, 0.213, z));
        bolt_row(a, from, to, DVec3::Y, 3, 0.003);
    }
    for x in [-0.08, -0.04, 0.0] {
        let gland = facing(DVec3::new(x, 0.16, 0.09), DVec3::Z);
        nut(a, Finish::Brass, gland, 0.016, 0.012);
        let from = DVec3::new(x, 0.16, 0.09);
        let to = DVec3::new(x * 0.6, -0.24, 0.2);
        let path = Path::Spline([from, from + DVec3::Z * 0.12, to + DVec3::Y * 0.3, to]);
        a.put(
            "cable",
            Finish::Rubber,
            at(0.0, 0.0, 0.0),
            Tube { path, radius: 0.007, ripples: 30 },
        );
    }
}
