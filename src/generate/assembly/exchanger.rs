//! A heat exchanger: copper serpentines through thin fins between two headers.

use super::finish::Finish;
use super::fittings::{bolt_row, cylinder, port};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, RoundedBox, Tube};
use crate::math::DVec3;

pub fn build(a: &mut Assembly) {
    for x in [-0.22, 0.22] {
        let half = DVec3::new(0.008, 0.24, 0.17);
        a.put("tube sheet", Finish::Steel, at(x, 0.0, 0.0), RoundedBox { half, fillet: 0.004 });
        let side = if x < 0.0 { DVec3::NEG_X } else { DVec3::X };
        for z in [-0.155, 0.155] {
            let [from, to] = [-0.22, 0.22].map(|y| DVec3::new(x, y, z) + side * 0.008);
            bolt_row(a, from, to, side, 7, 0.0045);
        }
    }
    let rows = 5 + a.random.below(3);
    for row in 0..rows {
        let z = 0.27 * ((row as f64 + 0.5) / rows as f64 - 0.5);
        serpentine(a, z, row % 2 == 0);
    }
    let fins = 26 + a.random.below(8);
    for i in 0..fins {
        let x = 0.42 * ((i as f64 + 0.5) / fins as f64 - 0.5);
        let half = DVec3::new(0.0008, 0.19, 0.145);
        a.put("fin", Finish::Aluminium, at(x, 0.0, 0.0), RoundedBox { half, fillet: 0.0004 });
    }
    for y in [-0.23, 0.23] {
        let header = facing(DVec3::new(-0.28, y, 0.0), DVec3::X);
        cylinder(a, "header", Finish::Brass, header, 0.03, 0.56);
        let rail = DVec3::new(0.24, 0.008, 0.012);
        for z in [-0.165, 0.165] {
            a.put("rail", Finish::Grey, at(0.0, y, z), RoundedBox { half: rail, fillet: 0.003 });
        }
    }
    port(a, DVec3::new(-0.27, 0.23, 0.08), DVec3::Z, 0.022);
    port(a, DVec3::new(0.27, -0.23, 0.08), DVec3::Z, 0.022);
    port(a, DVec3::new(0.1, 0.26, 0.0), DVec3::Y, 0.018);
}

/// A pipe to and fro, with bends outside of the tube sheets.
fn serpentine(a: &mut Assembly, z: f64, shifted: bool) {
    let passes = 9;
    let step = 0.4 / f64::from(passes);
    let mut points = Vec::new();
    for pass in 0..passes {
        let y = step * (f64::from(pass) - 0.5 * f64::from(passes - 1))
            + if shifted { 0.3 * step } else { 0.0 };
        let ends = if pass % 2 == 0 { [-0.262, 0.262] } else { [0.262, -0.262] };
        points.extend(ends.map(|x| DVec3::new(x, y, z)));
    }
    let path = Path::Bends { points, radius: 0.5 * step };
    a.put(
        "serpentine",
        Finish::Copper,
        at(0.0, 0.0, 0.0),
        Tube { path, radius: 0.2 * step, ripples: 0 },
    );
}
