//! Pipes, hoses and cables between the units.

use super::finish::Finish;
use super::fittings::{pipe_flange, ring};
use super::grid::{CELL, Grid};
use super::machine::{Assembly, Port};
use crate::generate::model::{at, facing};
use crate::generate::shape::{Path, Tube};
use crate::math::DVec3;

/// Joins the ports in pairs of chance, and lays a bank of pipes along the front and the back.
pub fn build(a: &mut Assembly, grid: Grid) {
    let mut ports = std::mem::take(&mut a.ports);
    a.random.shuffle(&mut ports);
    for (i, pair) in ports.chunks_exact(2).enumerate() {
        a.unit = format!("run {i}");
        match route(a, pair[0], pair[1]) {
            Some(points) => pipe(a, pair, points),
            None => hose(a, pair[0], pair[1]),
        }
    }
    cables(a, &ports);
    thickets(a, grid);
    for (front, z) in [(1.0, 0.5 * grid.size().z + 0.035), (-1.0, -0.5 * grid.size().z - 0.035)] {
        bank(a, grid, z, front);
    }
}

/// A way along the axes out of one port and into the other; none if it would turn back on itself
/// or make steps too short for a bend.
fn route(a: &mut Assembly, from: Port, to: Port) -> Option<Vec<DVec3>> {
    let radius = from.radius.min(to.radius);
    let lead = a.random.between(0.05, 0.12);
    let start = from.at + from.direction * lead;
    let end = to.at + to.direction * lead;
    let way = end - start;
    let mut orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    a.random.shuffle(&mut orders);
    orders.into_iter().find_map(|order| {
        let mut points = vec![from.at, start];
        for axis in order {
            let mut next = *points.last().expect("has two");
            next[axis] = end[axis];
            if way[axis] != 0.0 {
                points.push(next);
            }
        }
        points.push(to.at);
        let bends = points.windows(3).all(|p| (p[1] - p[0]).dot(p[2] - p[1]) > -1e-9);
        let room = points.windows(2).all(|p| (p[1] - p[0]).length() > 2.5 * radius);
        (bends && room).then_some(points)
    })
}

fn pipe(a: &mut Assembly, ports: &[Port], points: Vec<DVec3>) {
    let radius = ports[0].radius.min(ports[1].radius);
    let finish = a.random.one_of(&[
        Finish::Steel,
        Finish::Copper,
        Finish::Yellow,
        Finish::Chrome,
        Finish::Green,
    ]);
    // A joint half-way along the longest leg.
    let leg = points
        .windows(2)
        .max_by(|p, q| (p[1] - p[0]).length_squared().total_cmp(&(q[1] - q[0]).length_squared()));
    if let Some(&[from, to]) = leg.filter(|leg| (leg[1] - leg[0]).length() > 0.3) {
        let direction = (to - from).normalize();
        pipe_flange(a, (from + to) * 0.5, direction, radius);
        pipe_flange(a, (from + to) * 0.5, -direction, radius);
    }
    let path = Path::Bends { points, radius: 2.2 * radius };
    a.put("pipe", finish, at(0.0, 0.0, 0.0), Tube { path, radius, ripples: 0 });
}

/// A corrugated hose with a clamp at each end.
fn hose(a: &mut Assembly, from: Port, to: Port) {
    let slack = 0.5 * (to.at - from.at).length().max(0.2);
    let radius = 0.9 * from.radius.min(to.radius);
    let [out, back] = [from, to].map(|port| port.at + port.direction * slack);
    let length = (to.at - from.at).length() + slack;
    let ripples = (length / (0.7 * radius)) as usize;
    let path = Path::Spline([from.at, out, back, to.at]);
    a.put("hose", Finish::Rubber, at(0.0, 0.0, 0.0), Tube { path, radius, ripples });
    for port in [from, to] {
        let place = facing(port.at + port.direction * 0.015, port.direction);
        ring(a, "clamp", Finish::Brass, place, [0.9 * radius, 1.15 * radius], 0.014);
    }
}

/// Bundles of thin cables that hang from unit to unit.
fn cables(a: &mut Assembly, ports: &[Port]) {
    a.unit = String::from("cables");
    for (i, pair) in ports.windows(2).enumerate() {
        let finish = [Finish::Red, Finish::Yellow, Finish::Rubber, Finish::Blue][i % 4];
        let [from, to] = [pair[0].at, pair[1].at];
        if (to - from).length() > 2.2 * CELL.x {
            continue;
        }
        for strand in 0..3 {
            let shift = DVec3::new(0.012 * f64::from(strand), 0.03, -0.05);
            let sag = DVec3::new(a.random.between(-0.1, 0.1), -0.2, a.random.between(0.0, 0.25));
            let (from, to) = (from + shift, to + shift);
            let third = (to - from) / 3.0;
            let path = Path::Spline([from, from + third + sag, to - third + sag, to]);
            a.put("cable", finish, at(0.0, 0.0, 0.0), Tube { path, radius: 0.0045, ripples: 0 });
        }
    }
}

/// Pipes that fill what the units leave of their rooms: from wall to wall, around corners.
fn thickets(a: &mut Assembly, grid: Grid) {
    let [nx, ny, nz] = grid.0;
    for number in 0..nx * ny * nz {
        a.unit = format!("thicket {number}");
        let centre = grid.centre(number % nx, number / nx % ny, number / (nx * ny));
        for _ in 0..9 {
            let mut place = || {
                let share = DVec3::from([(); 3].map(|()| a.random.between(-0.48, 0.48)));
                // Mostly behind and above: the units are to be seen.
                centre + (share - DVec3::new(0.0, -0.05, 0.12)) * CELL
            };
            let (from, to) = (place(), place());
            let step = to - from;
            let mut order = [0, 1, 2];
            a.random.shuffle(&mut order);
            let mut points = vec![from];
            for axis in order {
                let mut next = points[points.len() - 1];
                next[axis] = to[axis];
                points.push(next);
            }
            let radius = a.random.between(0.004, 0.013);
            if step.abs().min_element() < 6.0 * radius {
                continue;
            }
            let finish =
                a.random.one_of(&[Finish::Steel, Finish::Copper, Finish::Brass, Finish::Red]);
            for (end, next) in [(0, 1), (3, 2)] {
                let direction = (points[next] - points[end]).normalize();
                let place = facing(points[end], direction);
                ring(a, "socket", Finish::Steel, place, [0.9 * radius, 1.7 * radius], 2.0 * radius);
            }
            let path = Path::Bends { points, radius: 2.5 * radius };
            a.put("pipe", finish, at(0.0, 0.0, 0.0), Tube { path, radius, ripples: 0 });
        }
    }
}

/// Parallel pipes along the machine at the height of each deck, stepping down here and there.
fn bank(a: &mut Assembly, grid: Grid, z: f64, front: f64) {
    let size = grid.size();
    for deck in 0..=grid.0[1] {
        a.unit = format!("bank {deck}");
        let pipes = 2 + a.random.below(3);
        let drop = a.random.between(0.08, 0.14);
        let turn = a.random.between(-0.3, 0.3) * size.x;
        for i in 0..pipes {
            let shift = 0.024 * i as f64;
            let y = 0.075 + deck as f64 * CELL.y + shift;
            let x = 0.5 * size.x + 0.03;
            let z = z + 0.006 * front;
            let points = vec![
                DVec3::new(-x, y, z),
                DVec3::new(turn + shift, y, z),
                DVec3::new(turn + shift, y + drop, z),
                DVec3::new(x, y + drop, z),
            ];
            let finish = [Finish::Copper, Finish::Steel, Finish::Brass][(i + deck) % 3];
            let path = Path::Bends { points, radius: 0.03 };
            a.put("line", finish, at(0.0, 0.0, 0.0), Tube { path, radius: 0.009, ripples: 0 });
            for k in 0..=grid.0[0] {
                let x = (k as f64 / grid.0[0] as f64 - 0.5) * 0.9 * size.x;
                let y = if x < turn { y } else { y + drop };
                let clip = facing(DVec3::new(x, y, z), DVec3::X);
                ring(a, "clip", Finish::Rubber, clip, [0.008, 0.012], 0.012);
            }
        }
    }
}
