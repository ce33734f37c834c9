//! Planes from bins, with exact counts.
//!
//! - M. Shevtsov, A. Soupikov, A. Kapustin, "Highly parallel fast KD-tree construction for
//!   interactive ray tracing of dynamic scenes", 2007: one row of bins counts where boxes begin,
//!   another where they end; their sums are the numbers on either side of each bound.
//!
//! As with [`super::binned`], ours looks at all three axes and adds the planes that cut off the
//! empty space beside the triangles.

use super::bins::{BINS, Candidates};
use super::input::Reference;
use super::sah::{Costs, Plane};
use crate::math::Aabb;

/// The best plane of all bins' bounds.
pub fn find_best(references: &[Reference], cell: &Aabb, costs: &Costs) -> Option<Plane> {
    let mut candidates = Candidates::new(references, cell, costs);
    for axis in 0..3 {
        let Some(planes) = candidates.planes(axis) else { continue };
        let (mut begin, mut end) = ([0; BINS], [0; BINS]);
        for reference in references {
            begin[planes.count_at_or_below(reference.bounds.min[axis])] += 1;
            end[planes.count_below(reference.bounds.max[axis])] += 1;
        }
        let (mut below, mut above) = (0, references.len());
        for bin in 0..BINS - 1 {
            below += begin[bin];
            above -= end[bin];
            candidates.offer(axis, planes.plane(bin), below, above);
        }
    }
    candidates.best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{PrimId, Vec3};

    #[test]
    fn counts_at_the_bounds_are_exact() {
        let cell = Aabb { min: Vec3::ZERO, max: Vec3::splat(32.0) };
        // Begin and end on bounds of bins, and between them.
        let spans = [(0.0, 32.0), (0.0, 8.0), (8.0, 9.5), (8.5, 16.0), (16.0, 16.5), (3.0, 30.0)];
        let references: Vec<_> = spans
            .iter()
            .map(|&(min, max)| Reference {
                bounds: Aabb { min: Vec3::new(min, 0.0, 0.0), max: Vec3::new(max, 32.0, 32.0) },
                id: PrimId(0),
            })
            .collect();
        let costs = Costs { traversal_cost: 1.0, intersection_cost: 1.5, empty_bonus: 0.2 };
        let best = find_best(&references, &cell, &costs).expect("there are planes");
        let expected = (1..32)
            .map(|i| i as f32)
            .filter_map(|split| {
                let below = spans.iter().filter(|s| s.0 < split).count();
                let above = spans.iter().filter(|s| s.1 > split).count();
                costs.in_cell(&cell).weigh(0, split, below, above)
            })
            .fold(None, |best, plane| Some(Plane::choose_cheaper(best, plane)));
        assert_eq!(Some(best), expected);
    }
}
