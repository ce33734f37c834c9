//! A box of honeycombs with cartridges behind.

use super::finish::Finish;
use super::fittings::{bolt_row, cylinder, port, ring};
use super::machine::Assembly;
use crate::generate::model::{at, facing};
use crate::generate::shape::{Bore, Honeycomb, Plate, Profile, RoundedBox};
use crate::math::{DVec2, DVec3};

pub fn build(a: &mut Assembly) {
    let paint = a.random.one_of(&[Finish::Grey, Finish::Yellow, Finish::Blue]);
    let rectangle = Profile::rectangle(DVec2::new(0.23, 0.26), 0.02);
    let casing = Plate { outline: rectangle, bore: Bore::Same(0.9), height: 0.34, twist: 0.0 };
    a.put("casing", paint, facing(DVec3::new(0.0, 0.0, -0.17), DVec3::Z), casing);
    for z in [-0.16, 0.165] {
        let half = DVec2::new(0.235, 0.21);
        let comb = facing(DVec3::new(0.0, 0.0, z), DVec3::Z);
        let front = z > 0.0;
        let finish = if front { Finish::Aluminium } else { Finish::Brass };
        a.put("honeycomb", finish, comb, Honeycomb { half, thickness: 0.03 });
    }
    let frame = Profile::rectangle(DVec2::new(0.25, 0.28), 0.015);
    for z in [-0.19, 0.15] {
        let rim =
            Plate { outline: frame.clone(), bore: Bore::Same(0.86), height: 0.014, twist: 0.0 };
        a.put("rim", Finish::Steel, facing(DVec3::new(0.0, 0.0, z), DVec3::Z), rim);
    }
    for y in [-0.233, 0.233] {
        let [from, to] = [-0.26, 0.26].map(|x| DVec3::new(x, y, 0.164));
        bolt_row(a, from, to, DVec3::Z, 9, 0.005);
    }
    for x in [-0.26, 0.26] {
        let [from, to] = [-0.17, 0.17].map(|y| DVec3::new(x, y, 0.164));
        bolt_row(a, from, to, DVec3::Z, 6, 0.005);
    }
    for (x, y) in
        [(-0.13, -0.11), (0.0, -0.11), (0.13, -0.11), (-0.13, 0.11), (0.0, 0.11), (0.13, 0.11)]
    {
        cartridge(a, facing(DVec3::new(x, y, -0.14), DVec3::Z));
    }
    let half = DVec3::new(0.012, 0.05, 0.012);
    a.put("handle", Finish::Rubber, at(0.2, 0.0, 0.2), RoundedBox { half, fillet: 0.01 });
    port(a, DVec3::new(0.27, 0.1, -0.05), DVec3::X, 0.026);
    port(a, DVec3::new(-0.1, 0.27, 0.0), DVec3::Y, 0.024);
    port(a, DVec3::new(-0.27, -0.1, 0.05), DVec3::NEG_X, 0.02);
}

/// A pleated filter between two discs.
fn cartridge(a: &mut Assembly, place: crate::math::DAffine3) {
    let pleats = Profile::teeth(30, 0.038, 0.054);
    let body = Plate { outline: pleats, bore: Bore::Round(0.025), height: 0.27, twist: 0.0 };
    a.put("pleats", Finish::Yellow, place, body);
    for y in [-0.008, 0.265] {
        ring(a, "disc", Finish::Steel, place * at(0.0, y, 0.0), [0.012, 0.058], 0.01);
    }
    cylinder(a, "rod", Finish::Chrome, place * at(0.0, -0.02, 0.0), 0.006, 0.31);
}
