//! Which meshes are flattened however often they are placed.

/// So many triangles are flattened of meshes that are placed more than once: 150 MB.
const MOST_FLATTENED: u64 = 1 << 21;

/// A mesh: its triangles, and how often it is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshUse {
    /// Its triangles.
    pub triangles: u64,
    /// How often it is placed.
    pub uses: u32,
    /// Whether any of that moves.
    pub moves: bool,
}

impl MeshUse {
    /// Triangles of all its copies.
    pub fn placed(&self) -> u64 {
        self.triangles.saturating_mul(u64::from(self.uses))
    }
}

/// The triangles of all meshes that are placed, each mesh once.
pub fn count_unique(meshes: &[MeshUse]) -> u64 {
    meshes.iter().filter(|mesh| mesh.uses > 0).map(|mesh| mesh.triangles).sum()
}

/// Which meshes are small enough to be flattened however often they are placed: from the smallest
/// on, while all copies so made have no more than twice the triangles of all meshes. Small parts
/// lie within the boxes of others: a ray enters many, and that takes as long as some ten nodes. In
/// a hall of robots rays entered half as many placements, and took four fifths of the time. What
/// moves is none of them.
pub fn find_small(meshes: &[MeshUse]) -> Vec<bool> {
    let is_copied = |&mesh: &usize| meshes[mesh].uses > 1 && !meshes[mesh].moves;
    let mut copied: Vec<usize> = (0..meshes.len()).filter(is_copied).collect();
    copied.sort_by_key(|&mesh| meshes[mesh].triangles);
    let mut room = MOST_FLATTENED.min(2 * count_unique(meshes));
    let mut small = vec![false; meshes.len()];
    for mesh in copied {
        let Some(left) = room.checked_sub(meshes[mesh].placed()) else { break };
        (small[mesh], room) = (true, left);
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_are_flattened_while_there_is_room() {
        let mesh = |triangles, uses| MeshUse { triangles, uses, moves: false };
        let moving = MeshUse { moves: true, ..mesh(10, 3) };
        // 100 + 1,000 + 50 + 10 unique triangles leave room for 2,320.
        let meshes = [mesh(100, 20), mesh(1_000, 3), mesh(50, 1), moving, mesh(7, 0)];
        assert_eq!(find_small(&meshes), [true, false, false, false, false]);
        assert_eq!(find_small(&[mesh(100, 3)]), [false]);
    }
}
