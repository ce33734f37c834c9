//! A manifold block with valves, handwheels and a bank of small pipes.

use super::finish::Finish;
use super::fittings::{bolt, bolt_circle, cylinder, gauge, handwheel, nut, port, ring, turned};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, Profile, Revolve, RoundedBox, Tube};
use crate::math::DVec3;

pub fn build(a: &mut Assembly) {
    let half = DVec3::new(0.26, 0.06, 0.09);
    a.put("manifold", Finish::Aluminium, at(0.0, -0.12, 0.0), RoundedBox { half, fillet: 0.008 });
    let base = DVec3::new(0.28, 0.012, 0.16);
    a.put(
        "base",
        Finish::DarkSteel,
        at(0.0, -0.235, 0.0),
        RoundedBox { half: base, fillet: 0.004 },
    );
    for x in [-0.2, 0.2] {
        let leg = DVec3::new(0.015, 0.04, 0.07);
        a.put("bracket", Finish::Grey, at(x, -0.2, 0.0), RoundedBox { half: leg, fillet: 0.004 });
        for z in [-0.13, 0.13] {
            bolt(a, DVec3::new(x, -0.223, z), DVec3::Y, 0.008);
        }
    }
    let number = 3 + a.random.below(2);
    for i in 0..number {
        let x = 0.5 * ((i as f64 + 0.5) / number as f64 - 0.5);
        valve(a, x, if i % 2 == 0 { Finish::Red } else { Finish::Blue });
        front_wheel(a, x);
    }
    bank(a);
    gauge(a, DVec3::new(0.1, 0.12, 0.12), DVec3::Z, 0.04);
    gauge(a, DVec3::new(-0.1, 0.12, 0.12), DVec3::Z, 0.04);
    port(a, DVec3::new(0.27, -0.12, 0.0), DVec3::X, 0.024);
    port(a, DVec3::new(-0.27, -0.12, 0.0), DVec3::NEG_X, 0.024);
    port(a, DVec3::new(0.0, -0.1, -0.12), DVec3::NEG_Z, 0.02);
}

fn valve(a: &mut Assembly, x: f64, finish: Finish) {
    let body = [
        (0.0, 0.0),
        (0.045, 0.0),
        (0.05, 0.03),
        (0.035, 0.06),
        (0.03, 0.09),
        (0.022, 0.11),
        (0.0, 0.11),
    ];
    a.put("bonnet", Finish::Brass, at(x, -0.07, 0.0), Revolve(turned(&body, 0.008)));
    ring(a, "bonnet flange", Finish::Steel, at(x, -0.062, 0.0), [0.03, 0.064], 0.012);
    bolt_circle(a, DVec3::new(x, -0.05, 0.0), DVec3::Y, 0.055, 8, 0.0035);
    nut(a, Finish::Brass, at(x, 0.035, 0.0), 0.025, 0.02);
    handwheel(a, finish, at(x, 0.14, 0.0), 0.055);
}

/// A smaller valve towards the viewer.
fn front_wheel(a: &mut Assembly, x: f64) {
    let out = facing(DVec3::new(x, -0.13, 0.08), DVec3::Z);
    a.put("seat", Finish::Brass, out, Revolve(Profile::cylinder(0.03, 0.03, 0.006)));
    nut(a, Finish::Steel, out * at(0.0, 0.03, 0.0), 0.024, 0.02);
    handwheel(a, Finish::Yellow, out * at(0.0, 0.1, 0.0), 0.036);
}

/// Small pipes side by side that rise behind and bend forwards.
fn bank(a: &mut Assembly) {
    for i in 0..12 {
        let x = -0.253 + 0.046 * f64::from(i);
        let rise = 0.16 + 0.012 * f64::from(i % 4);
        let points = vec![
            DVec3::new(x, -0.08, -0.06),
            DVec3::new(x, rise, -0.06),
            DVec3::new(x, rise, 0.08 + 0.02 * f64::from(i % 3)),
            DVec3::new(x, 0.02, 0.08 + 0.02 * f64::from(i % 3)),
        ];
        let path = Path::Bends { points, radius: 0.035 };
        let finish = if i % 3 == 0 { Finish::Brass } else { Finish::Copper };
        a.put("capillary", finish, at(0.0, 0.0, 0.0), Tube { path, radius: 0.009, ripples: 0 });
        nut(a, Finish::Brass, at(x, -0.065, -0.06), 0.016, 0.016);
        cylinder(a, "ferrule", Finish::Steel, at(x, -0.05, -0.06), 0.012, 0.03);
    }
}
