//! Planes from bins: equal intervals along each axis.
//!
//! - W. Hunt, W. Mark, G. Stoll, "Fast kd-tree construction with an adaptive error-bounded
//!   heuristic", 2006; S. Popov et al., "Experiences with streaming construction of SAH kd-trees",
//!   2006: here, triangles are counted by their centroids, as the review tells it (section 2).
//!
//! Ours looks at all three axes, spans the bins over the triangles rather than the cell, and adds
//! the planes that cut off the empty space beside them.

use super::bins::{BINS, Candidates};
use super::input::Reference;
use super::sah::{Costs, Plane};
use crate::math::Aabb;

/// The best plane of all bins' bounds.
pub fn find_best(references: &[Reference], cell: &Aabb, costs: &Costs) -> Option<Plane> {
    let mut candidates = Candidates::new(references, cell, costs);
    for axis in 0..3 {
        let Some(planes) = candidates.planes(axis) else { continue };
        let mut bins = [0; BINS];
        for Reference { bounds, .. } in references {
            bins[planes.count_near(bounds.min[axis] * 0.5 + bounds.max[axis] * 0.5)] += 1;
        }
        let mut below = 0;
        for (bin, here) in bins[..BINS - 1].iter().enumerate() {
            below += here;
            // No centroid beyond a plane does not make it empty there.
            if below > 0 && below < references.len() {
                candidates.offer(axis, planes.plane(bin), below, references.len() - below);
            }
        }
    }
    candidates.best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{PrimId, Vec3};

    fn reference(id: u32, min: f32, max: f32) -> Reference {
        let bounds = Aabb { min: Vec3::new(min, 0.0, 0.0), max: Vec3::new(max, 1.0, 1.0) };
        Reference { bounds, id: PrimId(id) }
    }

    #[test]
    fn empty_space_is_cut_off_first_and_clusters_are_parted() {
        let cell = Aabb { min: Vec3::ZERO, max: Vec3::new(10.0, 1.0, 1.0) };
        let costs = Costs { traversal_cost: 1.0, intersection_cost: 10.0, empty_bonus: 0.0 };
        let right: Vec<_> = (0..8).map(|i| reference(i, 8.0, 9.0)).collect();
        let plane = find_best(&right, &cell, &costs).expect("there is room to the left");
        assert_eq!((plane.axis, plane.split), (0, 8.0));

        let both: Vec<_> = (0..8).map(|i| reference(i, 0.0, 1.0)).chain(right).collect();
        let plane = find_best(&both, &cell, &costs).expect("there is room in the middle");
        // Wherever between the centroids: the heuristic is linear there.
        assert!(plane.axis == 0 && plane.split > 0.5 && plane.split < 8.5, "{plane:?}");
    }

    #[test]
    fn equal_boxes_that_fill_the_cell_give_no_plane() {
        let cell = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        let same: Vec<_> = (0..100).map(|i| reference(i, 0.0, 1.0)).collect();
        let costs = Costs { traversal_cost: 1.0, intersection_cost: 1.5, empty_bonus: 0.2 };
        assert_eq!(find_best(&same, &cell, &costs), None);
    }
}
