//! About how much memory a structure will take, before it is built.

/// Bytes of the default structure for a triangle of a mesh: `mbvh8` takes 68 to 71 over a refined
/// tree (`dapple trace --json`), and more while it is built.
const BYTES_A_TRIANGLE: u64 = 100;

/// Bytes of the upper level for a placed mesh.
const BYTES_A_PLACEMENT: u64 = 75;

/// About how many bytes a structure will take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Over the triangles of all meshes, each mesh once.
    pub triangles: u64,
    /// Over the placed meshes.
    pub placements: u64,
}

impl Footprint {
    /// The estimate for so many triangles of meshes, each mesh once, that are placed so many times.
    pub fn estimate(unique_triangles: u64, placements: u64) -> Self {
        Self {
            triangles: unique_triangles.saturating_mul(BYTES_A_TRIANGLE),
            placements: placements.saturating_mul(BYTES_A_PLACEMENT),
        }
    }

    /// Both.
    pub fn total(self) -> u64 {
        self.triangles.saturating_add(self.placements)
    }
}
