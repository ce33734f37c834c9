//! A combustion engine: block, finned cylinders, manifolds, pulleys.

use super::finish::Finish;
use super::fittings::{bolt, bolt_circle, bolt_row, cylinder, finned, nut, port, ring, turned};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, Revolve, RoundedBox, Tube};
use crate::math::DVec3;

pub fn build(a: &mut Assembly) {
    let paint = a.random.one_of(&[Finish::Green, Finish::Blue, Finish::Aluminium]);
    let half = DVec3::new(0.25, 0.085, 0.15);
    a.put("block", paint, at(0.0, -0.13, 0.0), RoundedBox { half, fillet: 0.02 });
    let rim = DVec3::new(0.265, 0.012, 0.165);
    a.put(
        "sump rim",
        Finish::DarkSteel,
        at(0.0, -0.2, 0.0),
        RoundedBox { half: rim, fillet: 0.005 },
    );
    let sump = DVec3::new(0.2, 0.04, 0.12);
    a.put("sump", Finish::DarkSteel, at(0.0, -0.23, 0.0), RoundedBox { half: sump, fillet: 0.03 });
    let deck = DVec3::new(0.262, 0.01, 0.16);
    a.put(
        "deck",
        Finish::Aluminium,
        at(0.0, -0.045, 0.0),
        RoundedBox { half: deck, fillet: 0.004 },
    );
    for side in [-1.0, 1.0] {
        let z = 0.155 * side;
        let [from, to] = [-0.25, 0.25].map(|x| DVec3::new(x, -0.188, z));
        bolt_row(a, from, to, DVec3::Y, 8, 0.004);
        let [from, to] = [-0.25, 0.25].map(|x| DVec3::new(x, -0.035, z - 0.01 * side));
        bolt_row(a, from, to, DVec3::Y, 9, 0.004);
        for i in 0..5 {
            let x = -0.2 + 0.1 * f64::from(i);
            let rib = DVec3::new(0.006, 0.07, 0.012);
            a.put(
                "rib",
                paint,
                at(x, -0.125, side * 0.152),
                RoundedBox { half: rib, fillet: 0.005 },
            );
        }
    }
    let number = 3 + a.random.below(2);
    for i in 0..number {
        let x = 0.42 * ((i as f64 + 0.5) / number as f64 - 0.5);
        cylinder_head(a, x, 0.042 + 0.012 * (4 - number) as f64);
    }
    exhaust(a, number);
    front(a);
    port(a, DVec3::new(0.1, -0.12, 0.165), DVec3::Z, 0.018);
    port(a, DVec3::new(-0.12, -0.1, -0.16), DVec3::NEG_Z, 0.022);
}

fn cylinder_head(a: &mut Assembly, x: f64, radius: f64) {
    let fins = finned(radius, 1.35 * radius, 0.15, 9);
    a.put("cylinder", Finish::Aluminium, at(x, -0.04, 0.0), Revolve(fins));
    let half = DVec3::new(1.15 * radius, 0.028, 1.6 * radius);
    a.put("head", Finish::Steel, at(x, 0.135, 0.0), RoundedBox { half, fillet: 0.01 });
    let cover = DVec3::new(1.0 * radius, 0.022, 1.35 * radius);
    let paint = a.random.one_of(&[Finish::Red, Finish::Chrome, Finish::DarkSteel]);
    a.put("rocker cover", paint, at(x, 0.178, 0.0), RoundedBox { half: cover, fillet: 0.016 });
    for (dx, dz) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let point = DVec3::new(x + dx * radius, 0.163, dz * 1.45 * radius);
        bolt(a, point, DVec3::Y, 0.0045);
    }
    let plug = facing(DVec3::new(x, 0.15, 1.5 * radius), DVec3::new(0.0, 0.6, 0.8));
    nut(a, Finish::Brass, plug, 0.012, 0.014);
    let insulator =
        [(0.0, 0.0), (0.007, 0.0), (0.006, 0.02), (0.008, 0.022), (0.005, 0.04), (0.0, 0.042)];
    a.put("plug", Finish::Grey, plug * at(0.0, 0.012, 0.0), Revolve(turned(&insulator, 0.001)));
    let from = plug.transform_point3(DVec3::Y * 0.05);
    let to = DVec3::new(0.2, 0.05, 0.17);
    let path = Path::Spline([from, from + DVec3::new(0.0, 0.06, 0.09), to + DVec3::Z * 0.1, to]);
    a.put(
        "ignition lead",
        Finish::Rubber,
        at(0.0, 0.0, 0.0),
        Tube { path, radius: 0.005, ripples: 0 },
    );
}

/// A bent pipe from each head into a common one behind.
fn exhaust(a: &mut Assembly, number: usize) {
    for i in 0..number {
        let x = 0.42 * ((i as f64 + 0.5) / number as f64 - 0.5);
        let points = vec![
            DVec3::new(x, 0.13, -0.05),
            DVec3::new(x, 0.13, -0.17),
            DVec3::new(x, 0.02, -0.17),
            DVec3::new(x + 0.06, -0.06, -0.2),
        ];
        let path = Path::Bends { points, radius: 0.05 };
        a.put(
            "exhaust",
            Finish::Copper,
            at(0.0, 0.0, 0.0),
            Tube { path, radius: 0.02, ripples: 0 },
        );
        let flange = facing(DVec3::new(x, 0.13, -0.085), DVec3::NEG_Z);
        ring(a, "exhaust flange", Finish::Steel, flange, [0.018, 0.034], 0.01);
    }
    let points = vec![DVec3::new(-0.22, -0.07, -0.2), DVec3::new(0.3, -0.07, -0.2)];
    let path = Path::Bends { points, radius: 0.05 };
    a.put("collector", Finish::Copper, at(0.0, 0.0, 0.0), Tube { path, radius: 0.03, ripples: 0 });
}

/// Crankshaft pulley, oil filter and an alternator on the right and in front.
fn front(a: &mut Assembly) {
    let axle = facing(DVec3::new(0.24, -0.13, 0.0), DVec3::X);
    let groove =
        |r: f64, y: f64| [(r, y), (r - 0.012, y + 0.006), (r - 0.012, y + 0.009), (r, y + 0.015)];
    let mut points = vec![(0.0, 0.0), (0.03, 0.0), (0.03, 0.01), (0.075, 0.01)];
    points.extend((0..3).flat_map(|i| groove(0.075, 0.013 + 0.018 * f64::from(i))));
    points.extend([(0.075, 0.07), (0.06, 0.07), (0.05, 0.05), (0.0, 0.05)]);
    a.put("pulley", Finish::DarkSteel, axle, Revolve(turned(&points, 0.001)));
    bolt_circle(a, DVec3::new(0.29, -0.13, 0.0), DVec3::X, 0.03, 6, 0.005);
    let filter = facing(DVec3::new(-0.13, -0.13, 0.14), DVec3::Z);
    cylinder(a, "oil filter", Finish::Red, filter, 0.042, 0.11);
    nut(a, Finish::Steel, filter * at(0.0, 0.108, 0.0), 0.02, 0.012);
    let alternator = facing(DVec3::new(0.08, -0.02, 0.19), DVec3::X);
    a.put("alternator", Finish::Aluminium, alternator, Revolve(finned(0.044, 0.05, 0.11, 12)));
    ring(
        a,
        "alternator pulley",
        Finish::Steel,
        alternator * at(0.0, 0.115, 0.0),
        [0.01, 0.033],
        0.025,
    );
}
