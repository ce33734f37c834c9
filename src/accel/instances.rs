//! Whether copies of a mesh share a structure.

use super::two_level::Placed;
use crate::geom::Placements;
use crate::math::{InstanceId, MeshId};
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
                let (unique, placed) = (count_unique(placed.get()), placed.len() as u64);
                placed >= FEW && placed >= 2 * unique
            }
        }
    }
}

/// The triangles of all meshes that are placed.
fn count_unique(placements: &dyn Placements) -> u64 {
    let mut is_used = vec![false; placements.meshes()];
    for placement in 0..placements.len() {
        is_used[placements.mesh(InstanceId::from_index(placement)).index()] = true;
    }
    let used = is_used.iter().enumerate().filter(|(_, used)| **used);
    used.map(|(mesh, _)| placements.mesh_len(MeshId::from_index(mesh)) as u64).sum()
}
