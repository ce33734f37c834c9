//! Small parts that units share: screws, flanges, wheels, springs.

use std::f64::consts::TAU;

use super::finish::Finish;
use super::machine::{Assembly, Port};
use crate::generate::model::{at, facing};
use crate::generate::shape::{Bolt, Path, Plate, Profile, Revolve, Tube};
use crate::math::{DAffine3, DVec2, DVec3};

/// A screw at a point, its head towards `up`.
pub fn bolt(a: &mut Assembly, point: DVec3, up: DVec3, radius: f64) {
    // Screws are never all tightened to the same angle.
    let turn = DAffine3::from_rotation_y(a.random.between(0.0, 1.0));
    let bolt = Bolt { radius, length: 7.0 * radius };
    a.put("screw", Finish::Steel, facing(point, up) * turn, bolt);
}

/// Screws on a circle about `centre`.
pub fn bolt_circle(
    a: &mut Assembly,
    centre: DVec3,
    up: DVec3,
    circle: f64,
    number: usize,
    radius: f64,
) {
    let place = facing(centre, up);
    for i in 0..number {
        let (sin, cos) = libm::sincos(TAU * (i as f64 + 0.5) / number as f64);
        let point = place.transform_point3(DVec3::new(sin, 0.0, cos) * circle);
        bolt(a, point, up, radius);
    }
}

/// Screws along a straight line, at both its ends too.
pub fn bolt_row(a: &mut Assembly, from: DVec3, to: DVec3, up: DVec3, number: usize, radius: f64) {
    for i in 0..number {
        let share = if number == 1 { 0.5 } else { i as f64 / (number - 1) as f64 };
        bolt(a, from + (to - from) * share, up, radius);
    }
}

/// A flange for a pipe of `radius` that leaves towards `direction`, and a neck behind it.
pub fn pipe_flange(a: &mut Assembly, point: DVec3, direction: DVec3, radius: f64) {
    let thickness = 0.4 * radius + 0.003;
    let ring = Profile::ring(0.8 * radius, 2.1 * radius, thickness, 0.1 * radius);
    let place = facing(point, direction);
    a.put("flange", Finish::Steel, place, Revolve(ring));
    let neck = Profile::ring(0.7 * radius, 1.25 * radius, 0.06 + radius, 0.05 * radius);
    a.put("neck", Finish::DarkSteel, place * at(0.0, -0.06 - radius, 0.0), Revolve(neck));
    let front = point + direction * thickness;
    bolt_circle(a, front, direction, 1.65 * radius, 6, 0.14 * radius + 0.0008);
}

/// A cylinder with its lower end at a point.
pub fn cylinder(
    a: &mut Assembly,
    name: &str,
    finish: Finish,
    place: DAffine3,
    radius: f64,
    height: f64,
) {
    let fillet = 0.15 * radius.min(height);
    a.put(name, finish, place, Revolve(Profile::cylinder(radius, height, fillet)));
}

/// A ring with its lower end at a point.
pub fn ring(
    a: &mut Assembly,
    name: &str,
    finish: Finish,
    place: DAffine3,
    [inner, outer]: [f64; 2],
    height: f64,
) {
    let fillet = 0.2 * (outer - inner).min(height);
    a.put(name, finish, place, Revolve(Profile::ring(inner, outer, height, fillet)));
}

/// A coil spring that stands on a point.
pub fn spring(
    a: &mut Assembly,
    finish: Finish,
    place: DAffine3,
    [radius, wire]: [f64; 2],
    height: f64,
    turns: usize,
) {
    let path = Path::Helix { radius, pitch: height / turns as f64, turns };
    a.put("spring", finish, place, Tube { path, radius: wire, ripples: 0 });
}

/// A wheel to turn by hand, with its stem below.
pub fn handwheel(a: &mut Assembly, finish: Finish, place: DAffine3, radius: f64) {
    let rim = Profile::torus(radius, 0.12 * radius);
    a.put("handwheel", finish, place, Revolve(rim));
    cylinder(
        a,
        "hub",
        Finish::DarkSteel,
        place * at(0.0, -0.15 * radius, 0.0),
        0.25 * radius,
        0.4 * radius,
    );
    for i in 0..5 {
        let turn = DAffine3::from_rotation_y(TAU * f64::from(i) / 5.0);
        let along = facing(DVec3::ZERO, DVec3::X);
        cylinder(a, "spoke", finish, place * turn * along, 0.07 * radius, 0.95 * radius);
    }
    cylinder(
        a,
        "stem",
        Finish::Chrome,
        place * at(0.0, -1.8 * radius, 0.0),
        0.13 * radius,
        1.8 * radius,
    );
}

/// A dial under glass: a case, a bezel and a face.
pub fn gauge(a: &mut Assembly, point: DVec3, direction: DVec3, radius: f64) {
    let place = facing(point, direction);
    cylinder(a, "gauge case", Finish::Chrome, place, radius, 0.5 * radius);
    ring(
        a,
        "bezel",
        Finish::Brass,
        place * at(0.0, 0.4 * radius, 0.0),
        [0.85 * radius, 1.08 * radius],
        0.2 * radius,
    );
    cylinder(
        a,
        "dial",
        Finish::Grey,
        place * at(0.0, 0.48 * radius, 0.0),
        0.86 * radius,
        0.05 * radius,
    );
    cylinder(a, "gauge pipe", Finish::Brass, place * at(0.0, -0.1, 0.0), 0.25 * radius, 0.1);
}

/// A hexagonal nut or gland.
pub fn nut(a: &mut Assembly, finish: Finish, place: DAffine3, radius: f64, height: f64) {
    let bore = super::super::shape::Bore::Round(0.55 * radius);
    let outline = Profile::polygon(6, radius, 0.08 * radius);
    a.put("nut", finish, place, Plate { outline, bore, height, twist: 0.0 });
}

/// A profile from pairs of radius and height, each corner rounded alike but on the axis.
pub fn turned(points: &[(f64, f64)], fillet: f64) -> Profile {
    let corner = |&(r, y): &(f64, f64)| (DVec2::new(r, y), if r > 0.0 { fillet } else { 0.0 });
    Profile::open(&points.iter().map(corner).collect::<Vec<_>>())
}

/// The profile of a cylinder with fins around it, from its lower end.
pub fn finned(core: f64, fin: f64, height: f64, fins: usize) -> Profile {
    let step = height / fins as f64;
    let mut points = vec![(0.0, 0.0), (core, 0.0)];
    for i in 0..fins {
        let y = i as f64 * step;
        points.extend([(core, y + 0.3 * step), (fin, y + 0.42 * step), (fin, y + 0.62 * step)]);
        points.push((core, y + 0.74 * step));
    }
    points.extend([(core, height), (0.0, height)]);
    turned(&points, 0.1 * step)
}

/// Adds an opening, with a flange around it.
pub(super) fn port(assembly: &mut Assembly, point: DVec3, direction: DVec3, radius: f64) {
    pipe_flange(assembly, point, direction, radius);
    assembly.ports.push(Port {
        at: assembly.frame.transform_point3(point),
        direction: assembly.frame.transform_vector3(direction),
        radius,
    });
}
