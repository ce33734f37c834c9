//! The recursion over lists of boxes, for planes that are found by looking at all of them.
//!
//! Triangles on both sides of a plane are clipped to each, as [`super::sweep`] does. Whether a
//! split pays is judged by the lists that it makes, not by what its finder thought they would be.

use super::arena::Arena;
use super::input::{Reference, TreeInput};
use super::limits::forks;
use super::sah::{Costs, Plane};
use crate::accel::kd::tree::split_cell;
use crate::math::Aabb;

/// Finds the best plane for a list of boxes in a cell.
pub type FindBest = fn(&[Reference], &Aabb, &Costs) -> Option<Plane>;

/// Builds the tree.
pub fn build(input: &TreeInput<'_>, find_best: FindBest) -> Arena {
    let mut arena = Arena::default();
    Builder { input, find_best }.divide(input.references(), &input.bounds, 0, 0, &mut arena);
    arena
}

struct Builder<'a> {
    input: &'a TreeInput<'a>,
    find_best: FindBest,
}

impl Builder<'_> {
    fn divide(
        &self,
        references: Vec<Reference>,
        cell: &Aabb,
        depth: usize,
        mut failed: u32,
        arena: &mut Arena,
    ) {
        let (limits, count) = (&self.input.limits, references.len());
        let plane = if count <= limits.leaf || depth >= limits.depth {
            None
        } else {
            (self.find_best)(&references, cell, &limits.costs)
        };
        let parts = plane.and_then(|plane| {
            let cells = split_cell(cell, plane.axis, plane.split);
            let parts = [0, 1].map(|side| self.take_side(&references, &plane, side, &cells[side]));
            let [below, above] = [parts[0].len(), parts[1].len()];
            let judged = limits.costs.in_cell(cell);
            let judged = judged.weigh(plane.axis, plane.split, below, above);
            let stops = limits.stops(count, judged.as_ref(), &mut failed);
            // Where all are on both sides, nothing is gained further down either.
            (!stops && (below < count || above < count)).then_some((plane, cells, parts))
        });
        let Some((plane, cells, [below, above])) = parts else {
            arena.add_leaf(references.iter().map(|reference| reference.id));
            return;
        };
        drop(references);
        let fork = forks(depth, count);
        arena.add_inner(
            plane.axis,
            plane.split,
            fork,
            |arena| self.divide_part(below, &cells[0], (depth, failed, fork), arena),
            |arena| self.divide_part(above, &cells[1], (depth, failed, fork), arena),
        );
    }

    /// A child of a node at `depth`, which is told of if it is the root of what one thread builds.
    fn divide_part(
        &self,
        references: Vec<Reference>,
        cell: &Aabb,
        (depth, failed, is_forked): (usize, u32, bool),
        arena: &mut Arena,
    ) {
        let count = references.len();
        self.divide(references, cell, depth + 1, failed, arena);
        if is_forked && !forks(depth + 1, count) {
            self.input.steps.place(count);
        }
    }

    /// Those that reach below the plane (0) or above it (1), where they cross it clipped to that
    /// side's cell.
    fn take_side(
        &self,
        references: &[Reference],
        plane: &Plane,
        side: usize,
        cell: &Aabb,
    ) -> Vec<Reference> {
        let grown = self.input.slack.grow(cell);
        let on_side = |reference: &Reference| {
            let below = reference.bounds.min[plane.axis] < plane.split;
            let above = reference.bounds.max[plane.axis] > plane.split;
            if !(if side == 0 { below } else { above }) {
                return None;
            }
            if !(below && above) {
                return Some(*reference);
            }
            let bounds = self.input.source.clip(reference.id, &grown)?;
            Some(Reference { bounds: self.input.slack.grow(&bounds), ..*reference })
        };
        references.iter().filter_map(on_side).collect()
    }
}
