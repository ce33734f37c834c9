//! Scenes made by rule from a seed, of exactly as many triangles as asked for.
//!
//! A generator is one module that makes a `Model`: shapes at their places, materials, cameras and
//! lights, nothing of which depends on how finely it will be tessellated but for the parts there
//! are (`Generator::model`). What follows is the same for all: each part is given its share of
//! the triangles (`budget`), and the file is written (`glb`).
//!
//! A [`Forest`] goes its own way: its kinds are placed many times.
//!
//! Arithmetic is +, -, ×, ÷, √ and `libm`, in one order: the same file on every machine.

mod assembly;
mod budget;
mod city;
mod container;
mod document;
mod forest;
mod glb;
mod ground;
mod kitchen;
mod landscape;
mod material;
mod model;
mod random;
mod scenery;
mod shape;
mod tessellation;

use std::io::{self, Write};
use std::ops::RangeInclusive;

use crate::camera::flight::{self, Pose};
pub(crate) use container::write_head;
pub use document::{Document, perspective, rounded};
pub use forest::{FOREST_COPIES, FOREST_TRIANGLES, Forest, WrittenForest};
pub use glb::Written;
use model::Model;

/// How many triangles a scene may have.
pub const TRIANGLES: RangeInclusive<u64> = 1..=20_000_000;

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Generator {
    /// A machine, dense and finely tessellated.
    Assembly,
    /// A town of few, large triangles.
    City,
    /// A closed room with furniture, crockery and appliances.
    Kitchen,
    /// Hills around a lake, woods and rocks.
    Landscape,
}

/// Cameras of a flight.
pub const FLIGHT: usize = 64;

impl Generator {
    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Assembly => "assembly",
            Self::City => "city",
            Self::Kitchen => "kitchen",
            Self::Landscape => "landscape",
        }
    }

    /// A flight of [`FLIGHT`] cameras through the scene of such triangles.
    pub fn flight(self, triangles: u64, seed: u64) -> Vec<Pose> {
        flight::through(&self.model(triangles, seed).flight, FLIGHT)
    }

    /// The parts of the scene for a number of triangles.
    fn model(self, triangles: u64, seed: u64) -> Model {
        match self {
            Self::Assembly => assembly::model(triangles, seed),
            Self::City => city::model(triangles, seed),
            Self::Kitchen => kitchen::model(triangles, seed),
            Self::Landscape => landscape::model(triangles, seed),
        }
    }

    /// Writes a scene of exactly `triangles` as .glb. The same arguments give the same bytes.
    ///
    /// # Errors
    /// Those of `out`.
    ///
    /// # Panics
    /// If `triangles` is not within [`TRIANGLES`].
    pub fn write(self, triangles: u64, seed: u64, out: &mut dyn Write) -> io::Result<Written> {
        assert!(TRIANGLES.contains(&triangles), "{triangles} triangles");
        let mut model = self.model(triangles, seed);
        let plan = budget::share(&mut model, triangles);
        let written = glb::write(out, &model, &plan)?;
        assert_eq!(written.triangles, triangles, "the plan is exact");
        Ok(written)
    }
}

#[cfg(test)]
mod tests;
