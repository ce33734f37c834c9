//! What holds the units: skids, posts, rails and decks, and the shafts that go through.

use super::finish::Finish;
use super::fittings::{bolt, cylinder, ring};
use super::grid::{BASE, CELL, Grid};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Plate, RoundedBox};
use crate::math::{DVec2, DVec3};

pub fn build(a: &mut Assembly, grid: Grid) {
    a.unit = String::from("frame");
    let size = grid.size();
    let [nx, ny, nz] = grid.0;
    let low = DVec3::new(-0.5 * size.x, 0.0, -0.5 * size.z);
    for k in 0..=nz {
        let z = low.z + k as f64 * CELL.z;
        let skid = facing(DVec3::new(low.x - 0.06, 0.045, z), DVec3::X);
        let section = DVec2::new(0.03, 0.045);
        a.put("skid", Finish::Grey, skid, Plate::beam(section, 0.008, size.x + 0.12));
        for i in 0..=nx {
            post(a, DVec3::new(low.x + i as f64 * CELL.x, 0.08, z), size.y - 0.08);
        }
        for j in 1..=ny {
            let y = BASE + j as f64 * CELL.y - 0.015;
            let rail = facing(DVec3::new(low.x - 0.03, y, z), DVec3::X);
            a.put(
                "rail",
                Finish::Grey,
                rail,
                Plate::beam(DVec2::new(0.014, 0.014), 0.004, size.x + 0.06),
            );
        }
    }
    for i in 0..=nx {
        for j in 0..=ny {
            let x = low.x + i as f64 * CELL.x;
            let y = BASE + j as f64 * CELL.y - 0.02;
            let tie = facing(DVec3::new(x, y, low.z), DVec3::Z);
            a.put("tie", Finish::Grey, tie, Plate::beam(DVec2::new(0.012, 0.016), 0.004, size.z));
        }
    }
    for j in 0..ny {
        for k in 0..nz {
            let centre = grid.centre(0, j, k);
            if a.random.chance(0.7) {
                shaft(
                    a,
                    DVec3::new(low.x - 0.04, centre.y - 0.02, centre.z - 0.02),
                    size.x + 0.08,
                    nx,
                );
            }
        }
    }
}

/// An upright with gussets and screws at its foot.
fn post(a: &mut Assembly, foot: DVec3, height: f64) {
    let beam = Plate::beam(DVec2::new(0.014, 0.014), 0.004, height);
    a.put("post", Finish::Grey, facing(foot, DVec3::Y), beam);
    let half = DVec3::new(0.04, 0.006, 0.04);
    a.put(
        "gusset",
        Finish::Steel,
        at(foot.x, foot.y + 0.012, foot.z),
        RoundedBox { half, fillet: 0.003 },
    );
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        bolt(a, foot + DVec3::new(0.028 * x, 0.018, 0.028 * z), DVec3::Y, 0.005);
    }
}

/// A shaft through a row of units, with a bearing and a gear at each end of theirs.
fn shaft(a: &mut Assembly, start: DVec3, length: f64, units: usize) {
    let axle = facing(start, DVec3::X);
    cylinder(a, "line shaft", Finish::Chrome, axle, 0.018, length);
    for i in 0..=units {
        let along = 0.04 + i as f64 * CELL.x - 0.015;
        ring(a, "bearing", Finish::DarkSteel, axle * at(0.0, along, 0.0), [0.017, 0.045], 0.035);
        ring(a, "collar", Finish::Brass, axle * at(0.0, along + 0.04, 0.0), [0.017, 0.03], 0.02);
        let teeth = 22 + a.random.below(14);
        let gear = Plate::gear(teeth, 0.0026 * teeth as f64, 0.016, 0.03, 0.1);
        a.put("gear", Finish::Steel, axle * at(0.0, along - 0.04, 0.0), gear);
    }
}
