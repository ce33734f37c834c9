//! Which meshes are flattened however often they are placed.

use glam::{DMat3, DVec3};

use crate::math::{Aabb, Affine3A, Vec3};

/// So many triangles are flattened of meshes that are placed more than once: 150 MB.
const MOST_FLATTENED: u64 = 1 << 21;

/// And so many for each triangle of all meshes.
const LARGEST_SHARE: f64 = 2.0;

/// A mesh: its triangles, and how it is placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshUse {
    /// Its triangles.
    pub triangles: u64,
    /// How often it is placed.
    pub uses: u32,
    /// Whether any of that moves.
    pub moves: bool,
    /// Half the extent of its box, in its own space.
    half_extent: DVec3,
    /// Of the boxes of all its placements in the world, half the area.
    area: f64,
}

impl MeshUse {
    /// A mesh of so many triangles in a box, not placed yet.
    pub fn new(triangles: u64, bounds: Aabb) -> Self {
        let half_extent = bounds.extent().max(Vec3::ZERO).as_dvec3() * 0.5;
        Self { triangles, uses: 0, moves: false, half_extent, area: 0.0 }
    }

    /// Places it once more.
    #[inline]
    pub fn place(&mut self, to_world: &Affine3A) {
        let columns = [0, 1, 2].map(|axis| to_world.matrix3.col(axis).as_dvec3().abs());
        let half = DMat3::from_cols(columns[0], columns[1], columns[2]) * self.half_extent;
        self.area += 4.0 * (half.x * half.y + half.y * half.z + half.z * half.x);
        self.uses = self.uses.saturating_add(1);
    }

    /// Triangles of all its copies.
    pub fn placed(&self) -> u64 {
        self.triangles.saturating_mul(u64::from(self.uses))
    }

    /// The triangles that are flattened to spare rays a placement that they enter, in relative
    /// numbers: as many rays enter a box as it has area.
    fn price(&self) -> f64 {
        self.placed() as f64 / self.area.max(f64::MIN_POSITIVE)
    }
}

/// The triangles of all meshes that are placed, each mesh once.
pub fn count_unique(meshes: &[MeshUse]) -> u64 {
    meshes.iter().filter(|mesh| mesh.uses > 0).map(|mesh| mesh.triangles).sum()
}

/// Which meshes are flattened however often they are placed: from those on that spare rays the most
/// placements for their triangles, while all copies so made have no more than [`LARGEST_SHARE`] of
/// the triangles of all meshes. A ray that enters a placement takes as long as some ten nodes do.
/// In a hall of robots rays enter half as many placements so as without, and a third fewer than if
/// the meshes of the fewest triangles were flattened. What moves is none of them.
pub fn find_small(meshes: &[MeshUse]) -> Vec<bool> {
    let is_copied = |&mesh: &usize| meshes[mesh].uses > 1 && !meshes[mesh].moves;
    let mut copied: Vec<usize> = (0..meshes.len()).filter(is_copied).collect();
    copied.sort_by(|&a, &b| meshes[a].price().total_cmp(&meshes[b].price()));
    let mut room = MOST_FLATTENED.min((count_unique(meshes) as f64 * LARGEST_SHARE) as u64);
    let mut small = vec![false; meshes.len()];
    for mesh in copied {
        if let Some(left) = room.checked_sub(meshes[mesh].placed()) {
            (small[mesh], room) = (true, left);
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mesh in a box of a side's length, placed so often as it is, along a diagonal.
    fn mesh(triangles: u64, uses: u32, side: f32) -> MeshUse {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::splat(side) };
        let mut mesh = MeshUse::new(triangles, bounds);
        for i in 0..uses {
            mesh.place(&Affine3A::from_translation(Vec3::splat(i as f32)));
        }
        mesh
    }

    #[test]
    fn what_spares_most_for_its_triangles_is_flattened_while_there_is_room() {
        let moving = MeshUse { moves: true, ..mesh(10, 3, 9.0) };
        // 100 + 1,000 + 50 + 10 unique triangles leave room for 2,320.
        let meshes = [mesh(100, 20, 1.0), mesh(1_000, 3, 1.0), mesh(50, 1, 1.0), moving];
        assert_eq!(find_small(&meshes), [true, false, false, false]);
        // The larger one spares more, though it has more triangles.
        let meshes = [mesh(100, 10, 1.0), mesh(150, 10, 2.0), mesh(900, 1, 1.0)];
        assert_eq!(find_small(&meshes), [false, true, false]);
        assert_eq!(find_small(&[mesh(100, 3, 1.0), mesh(7, 0, 1.0)]), [false, false]);
    }

    #[test]
    fn areas_are_those_of_boxes_in_the_world() {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 4.0) };
        let mut mesh = MeshUse::new(1, bounds);
        mesh.place(&Affine3A::IDENTITY);
        assert_eq!(mesh.area, bounds.half_area());
        // Mirrored, and twice as large.
        mesh.place(&Affine3A::from_scale(Vec3::new(-2.0, 2.0, 2.0)));
        assert_eq!(mesh.area, 5.0 * bounds.half_area());
    }
}
