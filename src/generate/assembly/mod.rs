//! A machine as CAD programs tessellate them: units on a frame, shafts and pipes between them.
//!
//! The scenes of Ernst and Greiner, "Multi Bounding Volume Hierarchies" (2008), are such models:
//! many parts that overlap, of triangles of very different sizes and shapes, hardly any of them
//! along the axes. More triangles make both more units and finer ones.

mod damper;
mod engine;
mod exchanger;
mod filter;
mod finish;
mod fittings;
mod frame;
mod gearbox;
mod motor;
mod piping;
mod studio;
mod tank;
mod valves;

use finish::Finish;

use super::model::{Model, Part, at};
use super::random::Random;
use super::shape::{Ribbon, Shape};
use crate::math::{DAffine3, DVec3};

/// Size of the room that a unit takes, metres.
const CELL: DVec3 = DVec3::new(0.56, 0.53, 0.48);

/// Height of the lowest units over the floor.
const BASE: f64 = 0.1;

/// Units by their number along each axis.
#[derive(Clone, Copy, Debug)]
struct Grid([usize; 3]);

/// The parts of a machine for a number of triangles.
pub fn model(triangles: u64, seed: u64) -> Model {
    let grid = Grid::for_triangles(triangles);
    let mut assembly = Assembly {
        model: Model { materials: finish::materials(), ..Model::default() },
        random: Random::new(seed),
        frame: DAffine3::IDENTITY,
        unit: String::new(),
        ports: Vec::new(),
    };
    studio::light(&mut assembly, grid);
    frame::build(&mut assembly, grid);
    units(&mut assembly, grid);
    piping::build(&mut assembly, grid);
    let size = grid.size();
    assembly.model.rest = Some(Part {
        name: "flat cable".to_owned(),
        material: Finish::Yellow.index(),
        place: at(0.0, 0.03, 0.5 * size.z + 0.08),
        shape: Box::new(Ribbon { length: 0.9 * size.x, width: 0.05 }),
    });
    assembly.model
}

impl Grid {
    /// More units for more triangles, but fewer than in proportion: each also becomes finer.
    fn for_triangles(triangles: u64) -> Self {
        Self(match triangles {
            0..16_000 => [1, 1, 1],
            16_000..50_000 => [2, 1, 1],
            50_000..100_000 => [2, 2, 1],
            100_000..250_000 => [3, 2, 1],
            250_000..500_000 => [3, 2, 2],
            500_000..1_500_000 => [4, 2, 2],
            1_500_000..3_000_000 => [4, 3, 2],
            3_000_000..10_000_000 => [5, 3, 2],
            _ => [5, 3, 3],
        })
    }

    /// The machine's, without what stands out.
    fn size(self) -> DVec3 {
        DVec3::from(self.0.map(|n| n as f64)) * CELL + DVec3::Y * BASE
    }

    /// The middle of a unit's room; the machine stands on height 0, its middle over the origin.
    fn centre(self, x: usize, y: usize, z: usize) -> DVec3 {
        let number = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, z as f64 + 0.5);
        let size = self.size();
        number * CELL + DVec3::new(-0.5 * size.x, BASE, -0.5 * size.z)
    }
}

/// An opening that a pipe can start from.
#[derive(Clone, Copy, Debug)]
struct Port {
    at: DVec3,
    /// Along an axis.
    direction: DVec3,
    /// Of the pipe.
    radius: f64,
}

/// A machine under construction.
struct Assembly {
    model: Model,
    random: Random,
    /// Where the current unit stands.
    frame: DAffine3,
    /// The current unit's name.
    unit: String,
    ports: Vec<Port>,
}

impl Assembly {
    /// Adds a part at a place of the current unit.
    fn put(&mut self, name: &str, finish: Finish, place: DAffine3, shape: impl Shape + 'static) {
        self.model.parts.push(Part {
            name: format!("{}/{name}", self.unit),
            material: finish.index(),
            place: self.frame * place,
            shape: Box::new(shape),
        });
    }

    /// Adds an opening, with a flange around it.
    fn port(&mut self, point: DVec3, direction: DVec3, radius: f64) {
        fittings::pipe_flange(self, point, direction, radius);
        self.ports.push(Port {
            at: self.frame.transform_point3(point),
            direction: self.frame.transform_vector3(direction),
            radius,
        });
    }
}

type Unit = (&'static str, fn(&mut Assembly));

const UNITS: [Unit; 8] = [
    ("engine", engine::build),
    ("gearbox", gearbox::build),
    ("motor", motor::build),
    ("exchanger", exchanger::build),
    ("dampers", damper::build),
    ("tank", tank::build),
    ("filter", filter::build),
    ("valves", valves::build),
];

/// Puts a unit into each room; none comes again before all the others have.
fn units(assembly: &mut Assembly, grid: Grid) {
    let [nx, ny, nz] = grid.0;
    let mut deck: Vec<Unit> = Vec::new();
    let mut number = 0;
    // The front is what one sees: the first of the deck go there.
    for z in (0..nz).rev() {
        for y in 0..ny {
            for x in 0..nx {
                if deck.is_empty() {
                    deck = UNITS.to_vec();
                    assembly.random.shuffle(&mut deck);
                }
                let (name, build) = deck.pop().expect("was filled");
                number += 1;
                assembly.unit = format!("{name} {number}");
                let turn = if assembly.random.chance(0.25) { std::f64::consts::PI } else { 0.0 };
                let turn = if z + 1 == nz { 0.0 } else { turn };
                assembly.frame = DAffine3::from_translation(grid.centre(x, y, z))
                    * DAffine3::from_rotation_y(turn);
                build(assembly);
            }
        }
    }
    assembly.frame = DAffine3::IDENTITY;
}
