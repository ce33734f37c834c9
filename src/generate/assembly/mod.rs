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
mod grid;
mod machine;
mod motor;
mod piping;
mod studio;
mod tank;
mod valves;

use finish::Finish;
use grid::Grid;
use machine::Assembly;

use super::model::{Model, Part, at};
use super::random::Random;
use super::shape::Ribbon;
use crate::math::DAffine3;

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
