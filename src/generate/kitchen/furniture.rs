//! Cupboards, shelves, the table and its chairs.

use super::size::{ROOM, WORKTOP};
use super::stuff::Stuff;
use crate::generate::scenery::Scenery;
use crate::math::DVec3;

/// Widths of a cupboard.
const WIDE: f64 = 0.6;

/// Builds them.
pub fn build(k: &mut Scenery) {
    let back = -0.5 * ROOM.z;
    let [depth, height] = WORKTOP;
    // Below the worktop, but for the places of sink (2), stove (5) and fridge (8).
    for i in 0..8 {
        if i != 5 {
            let x = (f64::from(i) + 0.5) * WIDE - 0.5 * ROOM.x;
            k.begin("cupboard", DVec3::new(x, 0.0, back), 0.0);
            cupboard(k, [0.5 * WIDE, 0.43, 0.5 * depth - 0.02], 0.47, i % 3 == 1);
        }
    }
    worktop(k, back, depth, height);
    for i in [0, 1, 3, 4, 6] {
        let x = (f64::from(i) + 0.5) * WIDE - 0.5 * ROOM.x;
        k.begin("wall cupboard", DVec3::new(x, 1.45, back), 0.0);
        cupboard(k, [0.5 * WIDE, 0.36, 0.17], 0.37, false);
    }
    shelves(k);
    table(k, DVec3::new(0.3, 0.0, 0.5));
    for (x, z, turn) in [(-0.4, 0.1, 1.4), (-0.4, 0.9, 1.75), (1.0, 0.1, -1.5), (1.1, 0.9, -1.8)] {
        chair(k, DVec3::new(x, 0.0, z), turn);
    }
}

/// A carcass against the wall with a door or drawers, and handles.
fn cupboard(k: &mut Scenery, [x, y, z]: [f64; 3], middle: f64, drawers: bool) {
    k.slab("carcass", Stuff::White.index(), [0.0, middle, z], [x - 0.002, y, z]);
    let front = 2.0 * z + 0.01;
    let leaves: &[(f64, f64)] =
        if drawers { &[(0.66, 0.3), (0.0, 0.3), (-0.66, 0.3)] } else { &[(0.0, 0.96)] };
    for &(up, share) in leaves {
        let at = [0.0, middle + up * y, front];
        k.slab("front", Stuff::Sage.index(), at, [x - 0.008, share * y, 0.01]);
        let inner = [x - 0.07, (share * y - 0.06).max(0.03), 0.008];
        k.slab("panel", Stuff::Sage.index(), [0.0, at[1], front + 0.008], inner);
        let (hx, hy) = if drawers { (0.0, at[1]) } else { (x - 0.06, middle + 0.1) };
        let (dx, dy) = if drawers { (0.07, 0.0) } else { (0.0, 0.07) };
        let out = front + 0.035;
        let handle = [
            [hx - dx, hy - dy, front],
            [hx - dx, hy - dy, out],
            [hx + dx, hy + dy, out],
            [hx + dx, hy + dy, front],
        ];
        k.rod("handle", Stuff::Brass.index(), &handle, 0.006);
    }
}

/// Slabs around the sink and the stove.
fn worktop(k: &mut Scenery, back: f64, depth: f64, height: f64) {
    k.begin("worktop", DVec3::new(-0.5 * ROOM.x, height - 0.02, back), 0.0);
    let mut piece = |from: f64, to: f64, near: f64, far: f64| {
        let place = [0.5 * (from + to), 0.0, 0.5 * (near + far)];
        let half = [0.5 * (to - from), 0.02, 0.5 * (far - near)];
        k.slab("slab", Stuff::Granite.index(), place, half);
    };
    piece(0.0, 1.2, 0.0, depth + 0.02);
    piece(1.2, 1.8, 0.0, 0.1);
    piece(1.2, 1.8, depth - 0.08, depth + 0.02);
    piece(1.8, 3.0, 0.0, depth + 0.02);
    piece(3.6, 4.8, 0.0, depth + 0.02);
}

/// Boards on brackets on the left wall.
fn shelves(k: &mut Scenery) {
    k.begin("shelves", DVec3::new(-0.5 * ROOM.x, 0.0, -0.3), 0.0);
    for y in [1.2, 1.55, 1.9] {
        k.slab("board", Stuff::Oak.index(), [0.13, y, 0.0], [0.13, 0.014, 0.6]);
        for z in [-0.5, 0.5] {
            let bracket = [[0.01, y - 0.16, z], [0.01, y - 0.02, z], [0.22, y - 0.02, z]];
            k.rod("bracket", Stuff::Iron.index(), &bracket, 0.008);
        }
    }
}

fn table(k: &mut Scenery, foot: DVec3) {
    k.begin("table", foot, 0.0);
    for i in 0..7 {
        let z = (f64::from(i) - 3.0) * 0.121;
        k.slab("plank", Stuff::Oak.index(), [0.0, 0.735, z], [0.75, 0.016, 0.06]);
    }
    for (x, z) in [(-0.66, -0.36), (0.66, -0.36), (0.66, 0.36), (-0.66, 0.36)] {
        let leg = [
            (0.0, 0.0),
            (0.022, 0.0),
            (0.03, 0.1),
            (0.02, 0.2),
            (0.034, 0.34),
            (0.026, 0.5),
            (0.04, 0.56),
            (0.04, 0.72),
            (0.0, 0.72),
        ];
        k.turned("leg", Stuff::Oak.index(), crate::generate::model::at(x, 0.0, z), &leg, 0.006);
    }
    for z in [-0.36, 0.36] {
        k.slab("apron", Stuff::Oak.index(), [0.0, 0.67, z], [0.64, 0.045, 0.012]);
    }
    for x in [-0.66, 0.66] {
        k.slab("apron", Stuff::Oak.index(), [x, 0.67, 0.0], [0.012, 0.045, 0.34]);
    }
}

fn chair(k: &mut Scenery, foot: DVec3, turn: f64) {
    let turn = turn + k.random.between(-0.15, 0.15);
    k.begin("chair", foot, turn);
    let oak = Stuff::Oak.index();
    k.slab("seat", oak, [0.0, 0.45, 0.0], [0.21, 0.018, 0.2]);
    for x in [-0.18, 0.18] {
        k.rod("leg", oak, &[[x, 0.0, 0.18], [x, 0.44, 0.17]], 0.016);
        k.rod("post", oak, &[[x, 0.0, -0.2], [x, 0.45, -0.17], [x, 0.92, -0.24]], 0.016);
        k.rod("stretcher", oak, &[[x, 0.2, 0.17], [x, 0.2, -0.18]], 0.01);
    }
    k.rod("stretcher", oak, &[[-0.18, 0.26, 0.175], [0.18, 0.26, 0.175]], 0.01);
    for i in 0..5 {
        let x = (f64::from(i) - 2.0) * 0.07;
        k.rod("spindle", oak, &[[x, 0.46, -0.17], [x, 0.88, -0.232]], 0.008);
    }
    let rail = [[-0.2, 0.9, -0.225], [0.0, 0.91, -0.255], [0.2, 0.9, -0.225]];
    k.rod("rail", oak, &rail, 0.02);
}
