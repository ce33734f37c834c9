//! Whether copies of a mesh share a structure.

use super::small_meshes::count_unique;
use super::two_level::{Placed, find_uses};
use crate::names::choices;

/// What becomes of meshes that are placed more than once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instances {
    /// What is best for the scene.
    #[default]
    Auto,
    /// All are flattened into one structure, copy by copy.
    Flat,
    /// Each has a structure of its own, and the copies another one.
    TwoLevel,
}

choices!(Instances, "way with copies", [Auto => "auto", Flat => "flat", TwoLevel => "two-level"]);

/// Fewer placed triangles than this are flattened: they are faster, and take some 30 MB.
const FEW: u64 = 300_000;

impl Instances {
    /// Whether a scene is to be built in two levels.
    pub(super) fn choose(self, placed: &Placed) -> bool {
        match self {
            Self::Flat => false,
            Self::TwoLevel => true,
            Self::Auto => {
                let meshes = find_uses(placed.get());
                pays(count_unique(&meshes), placed.len() as u64)
            }
        }
    }
}

/// Whether a structure of its own for each mesh pays.
pub fn pays(unique: u64, placed: u64) -> bool {
    placed >= FEW && placed >= 2 * unique
}
