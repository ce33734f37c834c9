//! What things in the kitchen are made of.

use serde_json::Value;

use crate::generate::material::{plain, shining};

/// A material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stuff {
    /// Painted plaster.
    Wall,
    /// Dark floor tiles.
    Slate,
    /// Light floor tiles.
    Cream,
    /// Paint of doors and frames.
    White,
    /// Of table, chairs and shelves.
    Oak,
    /// Of the worktop.
    Granite,
    /// Cupboards.
    Sage,
    /// Sink, pans, appliances.
    Steel,
    /// The stove, handles.
    Iron,
    /// Curtain rail, handles.
    Brass,
    /// Pans.
    Copper,
    /// Plates and cups.
    Porcelain,
    /// Some of them.
    Blue,
    /// Lampshade, kettle, apples.
    Red,
    /// Lemons.
    Yellow,
    /// Bottles.
    Green,
    /// Curtains and towels.
    Cloth,
    /// Beyond the window.
    Sky,
    /// What shines.
    Lamp,
}

use Stuff::{
    Blue, Brass, Cloth, Copper, Cream, Granite, Green, Iron, Lamp, Oak, Porcelain, Red, Sage, Sky,
    Slate, Steel, Wall, White, Yellow,
};

const ALL: [Stuff; 19] = [
    Wall, Slate, Cream, White, Oak, Granite, Sage, Steel, Iron, Brass, Copper, Porcelain, Blue,
    Red, Yellow, Green, Cloth, Sky, Lamp,
];

impl Stuff {
    /// Its place among the materials of the file.
    pub fn index(self) -> usize {
        self as usize
    }

    fn json(self) -> Value {
        let (color, metallic, roughness) = match self {
            Wall => ([0.7, 0.66, 0.56], 0.0, 0.9),
            Slate => ([0.06, 0.065, 0.07], 0.0, 0.35),
            Cream => ([0.62, 0.57, 0.46], 0.0, 0.35),
            White => ([0.78, 0.78, 0.76], 0.0, 0.5),
            Oak => ([0.36, 0.2, 0.09], 0.0, 0.55),
            Granite => ([0.13, 0.12, 0.12], 0.0, 0.2),
            Sage => ([0.25, 0.34, 0.26], 0.0, 0.5),
            Steel => ([0.6, 0.6, 0.6], 1.0, 0.28),
            Iron => ([0.05, 0.05, 0.055], 0.0, 0.4),
            Brass => ([0.85, 0.64, 0.3], 1.0, 0.25),
            Copper => ([0.9, 0.5, 0.34], 1.0, 0.22),
            Porcelain => ([0.8, 0.79, 0.76], 0.0, 0.15),
            Blue => ([0.07, 0.14, 0.36], 0.0, 0.15),
            Red => ([0.5, 0.05, 0.04], 0.0, 0.25),
            Yellow => ([0.78, 0.6, 0.06], 0.0, 0.4),
            Green => ([0.04, 0.2, 0.08], 0.0, 0.1),
            Cloth => ([0.55, 0.25, 0.18], 0.0, 0.95),
            Sky => return shining("sky", [0.75, 0.88, 1.0], 9.0),
            Lamp => return shining("lamp", [1.0, 0.93, 0.8], 14.0),
        };
        plain(&format!("{self:?}").to_lowercase(), color, metallic, roughness)
    }
}

/// glTF's objects, in the order of [`Stuff::index`].
pub fn materials() -> Vec<Value> {
    ALL.map(Stuff::json).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_places_in_the_list() {
        for (i, stuff) in ALL.into_iter().enumerate() {
            assert_eq!(stuff.index(), i, "{stuff:?}");
        }
    }
}
