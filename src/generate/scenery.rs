//! A scene under construction: what city, kitchen and landscape share.

use serde_json::{Value, json};

use super::model::{Lamp, Model, Part, at, facing};
use super::random::Random;
use super::shape::{Path, Profile, Quad, Revolve, RoundedBox, Shape, Tube};
use crate::math::{DAffine3, DVec2, DVec3, Vec3};

/// Parts so far, chance, and what they belong to.
pub struct Scenery {
    /// What is made.
    pub model: Model,
    /// What choices are made by.
    pub random: Random,
    /// The thing that parts belong to at present.
    pub unit: String,
    /// Where that thing stands.
    pub frame: DAffine3,
}

impl Scenery {
    /// Nothing yet.
    pub fn new(seed: u64, materials: Vec<Value>) -> Self {
        Self {
            model: Model { materials, ..Model::default() },
            random: Random::new(seed),
            unit: String::new(),
            frame: DAffine3::IDENTITY,
        }
    }

    /// Begins a thing that stands at a point, turned about the vertical.
    pub fn begin(&mut self, unit: &str, foot: DVec3, turn: f64) {
        unit.clone_into(&mut self.unit);
        self.frame = DAffine3::from_translation(foot) * DAffine3::from_rotation_y(turn);
    }

    /// Adds a part at a place of the current thing.
    pub fn put(
        &mut self,
        name: &str,
        material: usize,
        place: DAffine3,
        shape: impl Shape + 'static,
    ) {
        self.model.parts.push(Part {
            name: format!("{}/{name}", self.unit),
            material,
            place: self.frame * place,
            shape: Box::new(shape),
        });
    }

    /// A box by its middle and half its sides, with fillets a twelfth of the least of these.
    pub fn slab(&mut self, name: &str, material: usize, [x, y, z]: [f64; 3], half: [f64; 3]) {
        let half = DVec3::from(half);
        let shape = RoundedBox { half, fillet: half.min_element() / 12.0 };
        self.put(name, material, at(x, y, z), shape);
    }

    /// A round part by radii and heights from its lower end, each corner rounded alike.
    pub fn turned(
        &mut self,
        name: &str,
        material: usize,
        place: DAffine3,
        points: &[(f64, f64)],
        fillet: f64,
    ) {
        let corner = |&(r, y): &(f64, f64)| (DVec2::new(r, y), if r > 0.0 { fillet } else { 0.0 });
        let profile = Profile::open(&points.iter().map(corner).collect::<Vec<_>>());
        self.put(name, material, place, Revolve(profile));
    }

    /// A cylinder with its lower end at a point.
    pub fn cylinder(
        &mut self,
        name: &str,
        material: usize,
        [x, y, z]: [f64; 3],
        radius: f64,
        height: f64,
    ) {
        let profile = Profile::cylinder(radius, height, 0.1 * radius.min(height));
        self.put(name, material, at(x, y, z), Revolve(profile));
    }

    /// A bent rod.
    pub fn rod(&mut self, name: &str, material: usize, points: &[[f64; 3]], radius: f64) {
        let points = points.iter().copied().map(DVec3::from).collect();
        let path = Path::Bends { points, radius: 2.0 * radius };
        self.put(name, material, at(0.0, 0.0, 0.0), Tube { path, radius, ripples: 0 });
    }

    /// A rectangle that shines, say, from a point along a direction.
    pub fn panel(
        &mut self,
        name: &str,
        material: usize,
        point: DVec3,
        towards: DVec3,
        half: DVec2,
    ) {
        self.put(name, material, facing(point, towards.normalize()), Quad { half });
    }

    /// A light far away, as bright as `lux` where it falls straight; `from` tells whence.
    pub fn sun(&mut self, from: Vec3, lux: f64) {
        let light = json!({ "type": "directional", "intensity": lux });
        self.model.lights.push(Lamp { light, at: from, towards: Vec3::ZERO });
    }
}
