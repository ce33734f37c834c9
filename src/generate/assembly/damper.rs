//! Coil springs around dampers, between two crossbeams.

use super::finish::Finish;
use super::fittings::{bolt, bolt_circle, cylinder, nut, port, ring, spring, turned};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, Plate, Revolve, RoundedBox, Tube};
use crate::math::{DVec2, DVec3};

pub fn build(a: &mut Assembly) {
    for (y, z) in [(-0.24, -0.1), (-0.24, 0.1), (0.23, -0.1), (0.23, 0.1)] {
        let beam = facing(DVec3::new(-0.29, y, z), DVec3::X);
        a.put("crossbeam", Finish::Grey, beam, Plate::beam(DVec2::new(0.03, 0.022), 0.006, 0.58));
    }
    let number = 3 + a.random.below(2);
    let finish = a.random.one_of(&[Finish::Red, Finish::Yellow, Finish::Blue]);
    for row in [-0.1, 0.1] {
        for i in 0..number {
            let x = 0.5 * ((i as f64 + 0.5) / number as f64 - 0.5);
            damper(a, DVec3::new(x, 0.0, row), finish);
        }
    }
    let half = DVec3::new(0.27, 0.01, 0.15);
    a.put("tie plate", Finish::Steel, at(0.0, 0.255, 0.0), RoundedBox { half, fillet: 0.004 });
    for x in [-0.25, -0.08, 0.08, 0.25] {
        for z in [-0.13, 0.13] {
            bolt(a, DVec3::new(x, 0.265, z), DVec3::Y, 0.007);
        }
    }
    brake_line(a);
}

fn damper(a: &mut Assembly, foot: DVec3, finish: Finish) {
    let place = at(foot.x, -0.22, foot.z);
    let body = [
        (0.0, 0.0),
        (0.03, 0.0),
        (0.03, 0.04),
        (0.024, 0.05),
        (0.024, 0.22),
        (0.02, 0.225),
        (0.0, 0.225),
    ];
    a.put("damper", Finish::DarkSteel, place, Revolve(turned(&body, 0.003)));
    cylinder(a, "piston rod", Finish::Chrome, place * at(0.0, 0.2, 0.0), 0.011, 0.24);
    ring(a, "lower seat", Finish::Steel, place * at(0.0, 0.045, 0.0), [0.02, 0.056], 0.01);
    ring(a, "upper seat", Finish::Steel, place * at(0.0, 0.375, 0.0), [0.01, 0.056], 0.012);
    let turns = 8 + a.random.below(3);
    spring(a, finish, place * at(0.0, 0.058, 0.0), [0.045, 0.0075], 0.315, turns);
    let boot = [
        (0.013, 0.0),
        (0.024, 0.004),
        (0.013, 0.008),
        (0.024, 0.012),
        (0.013, 0.016),
        (0.024, 0.02),
        (0.013, 0.024),
    ];
    a.put("boot", Finish::Rubber, place * at(0.0, 0.23, 0.0), Revolve(turned(&boot, 0.001)));
    nut(a, Finish::Brass, place * at(0.0, 0.43, 0.0), 0.02, 0.015);
    bolt_circle(a, DVec3::new(foot.x, -0.165, foot.z), DVec3::Y, 0.045, 6, 0.003);
}

/// A thin pipe that dips between the dampers.
fn brake_line(a: &mut Assembly) {
    for (z, y) in [(0.165, 0.0), (0.18, 0.02), (0.195, 0.04)] {
        let mut points = Vec::new();
        for i in 0..6 {
            let x = -0.28 + 0.112 * f64::from(i);
            let [from, to] = if i % 2 == 0 { [y - 0.06, y + 0.06] } else { [y + 0.06, y - 0.06] };
            points.extend([DVec3::new(x, from, z), DVec3::new(x, to, z)]);
        }
        let path = Path::Bends { points, radius: 0.02 };
        a.put("line", Finish::Brass, at(0.0, 0.0, 0.0), Tube { path, radius: 0.005, ripples: 0 });
    }
    port(a, DVec3::new(0.2, -0.24, 0.15), DVec3::Z, 0.016);
}
