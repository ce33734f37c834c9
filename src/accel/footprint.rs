//! About how much memory a structure will take, before it is built.

use super::instances::pays;
use super::small_meshes::{MeshUse, count_unique, find_small};

/// Bytes of the default structure for a triangle of a mesh: `auto` takes 55 to 60
/// (`dapple trace --json`), and more while it is built.
const BYTES_A_TRIANGLE: u64 = 100;

/// Bytes of the upper level for a placed mesh.
const BYTES_A_PLACEMENT: u64 = 75;

/// About how many bytes a structure will take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Over triangles: of all meshes, each once, and of copies that are flattened.
    pub triangles: u64,
    /// Over the placed meshes that keep a structure of their own.
    pub placements: u64,
}

impl Footprint {
    /// The estimate for meshes that are placed, as `instances=auto` has them.
    pub fn estimate(meshes: &[MeshUse]) -> Self {
        let placed = meshes.iter().fold(0_u64, |sum, mesh| sum.saturating_add(mesh.placed()));
        let copies = pays(count_unique(meshes), placed);
        let (mut triangles, mut placements) = (0_u64, 0_u64);
        for (mesh, is_small) in meshes.iter().zip(find_small(meshes)) {
            let is_apart = mesh.moves || (copies && !is_small && mesh.uses > 1);
            if !is_apart {
                triangles = triangles.saturating_add(mesh.placed());
            } else {
                triangles = triangles.saturating_add(mesh.triangles);
                placements += u64::from(mesh.uses);
            }
        }
        Self {
            triangles: triangles.saturating_mul(BYTES_A_TRIANGLE),
            placements: placements.saturating_mul(BYTES_A_PLACEMENT),
        }
    }

    /// Both.
    pub fn total(self) -> u64 {
        self.triangles.saturating_add(self.placements)
    }
}
