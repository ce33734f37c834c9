//! A pressure vessel with a manhole, bands, gauges and nozzles.

use super::finish::Finish;
use super::fittings::{bolt_circle, cylinder, gauge, nut, port, ring, turned};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, Profile, Revolve, RoundedBox, Tube};
use crate::math::DVec3;

pub fn build(a: &mut Assembly) {
    let finish = a.random.one_of(&[Finish::Chrome, Finish::Yellow, Finish::Aluminium]);
    let radius = 0.19;
    let vessel = [(0.0, -0.21), (radius, -0.19), (radius, 0.16), (0.0, 0.2)];
    a.put("vessel", finish, at(0.0, 0.0, 0.0), Revolve(turned(&vessel, 0.07)));
    for y in [-0.12, -0.02, 0.1] {
        let place = at(0.0, y, 0.0);
        ring(a, "band", Finish::DarkSteel, place, [radius - 0.004, radius + 0.006], 0.025);
        let half = DVec3::new(0.02, 0.016, 0.012);
        a.put(
            "clamp",
            Finish::Steel,
            at(0.09, y + 0.012, 0.172),
            RoundedBox { half, fillet: 0.004 },
        );
    }
    a.put("weld", Finish::Steel, at(0.0, 0.055, 0.0), Revolve(Profile::torus(radius, 0.004)));
    ring(a, "manhole", Finish::Steel, at(0.0, 0.19, 0.0), [0.06, 0.095], 0.022);
    let lid = [(0.0, 0.0), (0.095, 0.0), (0.095, 0.016), (0.06, 0.022), (0.0, 0.034)];
    a.put("lid", Finish::Aluminium, at(0.0, 0.214, 0.0), Revolve(turned(&lid, 0.004)));
    bolt_circle(a, DVec3::new(0.0, 0.23, 0.0), DVec3::Y, 0.082, 14, 0.005);
    for i in 0..3 {
        let (sin, cos) = libm::sincos(2.1 * f64::from(i) + 0.5);
        let top = DVec3::new(0.17 * sin, -0.1, 0.17 * cos);
        let foot = DVec3::new(0.21 * sin, -0.26, 0.21 * cos);
        let path = Path::Bends { points: vec![top, foot], radius: 0.1 };
        a.put(
            "leg",
            Finish::DarkSteel,
            at(0.0, 0.0, 0.0),
            Tube { path, radius: 0.018, ripples: 0 },
        );
        cylinder(a, "pad", Finish::Steel, at(foot.x, -0.265, foot.z), 0.04, 0.012);
        bolt_circle(a, foot + DVec3::Y * 0.008, DVec3::Y, 0.03, 4, 0.004);
    }
    sight_glass(a);
    gauge(a, DVec3::new(-0.07, 0.1, 0.2), DVec3::Z, 0.035);
    gauge(a, DVec3::new(0.02, 0.12, 0.21), DVec3::Z, 0.025);
    port(a, DVec3::new(0.22, 0.02, 0.0), DVec3::X, 0.024);
    port(a, DVec3::new(0.06, -0.13, 0.21), DVec3::Z, 0.02);
    port(a, DVec3::new(-0.14, 0.24, -0.1), DVec3::Y, 0.018);
}

fn sight_glass(a: &mut Assembly) {
    let tube = at(-0.13, -0.12, 0.18);
    cylinder(a, "sight glass", Finish::Chrome, tube, 0.009, 0.2);
    for y in [0.0, 0.2] {
        nut(a, Finish::Brass, tube * at(0.0, y - 0.008, 0.0), 0.018, 0.02);
        let stub =
            facing(DVec3::new(-0.1, -0.12 + y, 0.12), DVec3::new(-0.4472, 0.0, 0.8944).normalize());
        cylinder(a, "stub", Finish::Brass, stub, 0.008, 0.065);
    }
    for x in [-0.012, 0.012] {
        cylinder(a, "guard", Finish::Steel, tube * at(x, 0.0, 0.01), 0.002, 0.2);
    }
}
