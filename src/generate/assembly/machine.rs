//! A machine under construction.

use super::finish::Finish;
use crate::generate::model::{Model, Part};
use crate::generate::random::Random;
use crate::generate::shape::Shape;
use crate::math::{DAffine3, DVec3};

/// An opening that a pipe can start from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Port {
    pub at: DVec3,
    /// Along an axis.
    pub direction: DVec3,
    /// Of the pipe.
    pub radius: f64,
}

/// A machine under construction.
pub(super) struct Assembly {
    pub model: Model,
    pub random: Random,
    /// Where the current unit stands.
    pub frame: DAffine3,
    /// The current unit's name.
    pub unit: String,
    pub ports: Vec<Port>,
}

impl Assembly {
    /// Adds a part at a place of the current unit.
    pub fn put(
        &mut self,
        name: &str,
        finish: Finish,
        place: DAffine3,
        shape: impl Shape + 'static,
    ) {
        self.model.parts.push(Part {
            name: format!("{}/{name}", self.unit),
            material: finish.index(),
            place: self.frame * place,
            shape: Box::new(shape),
        });
    }
}
