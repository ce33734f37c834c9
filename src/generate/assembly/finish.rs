//! What parts are made of.

use serde_json::Value;

use crate::generate::material::{plain, shining};

/// A material of the assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// Turned or ground.
    Steel,
    /// As cast or blackened.
    DarkSteel,
    /// Cast.
    Aluminium,
    /// Polished.
    Chrome,
    /// Of fittings.
    Brass,
    /// Of pipes.
    Copper,
    /// Paint of housings.
    Green,
    /// Paint of housings.
    Blue,
    /// Paint of springs and handwheels.
    Red,
    /// Paint of pipes and cables.
    Yellow,
    /// Paint of frames and covers.
    Grey,
    /// Of hoses.
    Rubber,
    /// What the machine stands on.
    Floor,
    /// What shines.
    Lamp,
}

use Finish::{
    Aluminium, Blue, Brass, Chrome, Copper, DarkSteel, Floor, Green, Grey, Lamp, Red, Rubber,
    Steel, Yellow,
};

/// All of them, in the order of their numbers.
const ALL: [Finish; 14] = [
    Steel, DarkSteel, Aluminium, Chrome, Brass, Copper, Green, Blue, Red, Yellow, Grey, Rubber,
    Floor, Lamp,
];

impl Finish {
    /// Its place among the materials of the file.
    pub fn index(self) -> usize {
        self as usize
    }

    fn json(self) -> Value {
        let (color, metallic, roughness) = match self {
            Steel => ([0.58, 0.57, 0.55], 1.0, 0.32),
            DarkSteel => ([0.20, 0.20, 0.21], 1.0, 0.45),
            Aluminium => ([0.82, 0.83, 0.84], 1.0, 0.5),
            Chrome => ([0.75, 0.76, 0.77], 1.0, 0.12),
            Brass => ([0.86, 0.66, 0.32], 1.0, 0.28),
            Copper => ([0.90, 0.52, 0.36], 1.0, 0.3),
            Green => ([0.06, 0.24, 0.14], 0.0, 0.4),
            Blue => ([0.04, 0.14, 0.38], 0.0, 0.35),
            Red => ([0.55, 0.04, 0.03], 0.0, 0.35),
            Yellow => ([0.75, 0.42, 0.03], 0.0, 0.4),
            Grey => ([0.45, 0.46, 0.47], 0.0, 0.5),
            Rubber => ([0.03, 0.03, 0.03], 0.0, 0.75),
            Floor => ([0.34, 0.33, 0.32], 0.0, 0.8),
            Lamp => return shining(&self.name(), [1.0, 0.97, 0.92], LAMP_RADIANCE),
        };
        plain(&self.name(), color, metallic, roughness)
    }

    fn name(self) -> String {
        format!("{self:?}").to_lowercase()
    }
}

/// Of the lamps, before their tint.
const LAMP_RADIANCE: f64 = 16.0;

/// glTF's objects, in the order of [`Finish::index`].
pub fn materials() -> Vec<Value> {
    ALL.map(Finish::json).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_places_in_the_list() {
        for (i, finish) in ALL.into_iter().enumerate() {
            assert_eq!(finish.index(), i, "{finish:?}");
        }
    }
}
