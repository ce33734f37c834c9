//! The recursion over lists of boxes, for planes that are found by looking at all of them.

use rayon::prelude::*;

use super::{Arena, Costs, FORK_COUNT, FORK_LEVELS, Plane, Reference, Settings};
use crate::accel::kd::slack::Slack;
use crate::accel::kd::tree::halves;
use crate::geom::{TriangleSource, own_box};
use crate::math::{Aabb, TriangleId};

/// Finds the best plane for a list of boxes in a cell.
pub type Best = fn(&[Reference], &Aabb, &Costs) -> Option<Plane>;

/// Builds the nodes.
pub fn build(
    source: &dyn TriangleSource,
    bounds: &Aabb,
    slack: &Slack,
    settings: &Settings,
    best: Best,
) -> Arena {
    let references = (0..source.len())
        .into_par_iter()
        .map(|i| {
            let id = TriangleId::from_index(i);
            Reference { bounds: slack.grow(&own_box(&source.triangle(id))), id }
        })
        .collect();
    let mut arena = Arena::default();
    divide(references, bounds, 0, 0, settings, best, &mut arena);
    arena
}

fn divide(
    references: Vec<Reference>,
    cell: &Aabb,
    depth: usize,
    mut failed: u32,
    settings: &Settings,
    best: Best,
    arena: &mut Arena,
) {
    let count = references.len();
    let plane = if count <= settings.leaf || depth >= settings.depth {
        None
    } else {
        best(&references, cell, &settings.costs)
    };
    let plane = plane.filter(|plane| !settings.stops(count, Some(plane), &mut failed));
    let parts = plane.map(|plane| (plane, part(&references, plane.axis, plane.split)));
    // Where all are on both sides, nothing is gained further down either.
    let Some((plane, [below, above])) =
        parts.filter(|(_, [below, above])| below.len() < count || above.len() < count)
    else {
        arena.leaf(references.iter().map(|reference| reference.id));
        return;
    };
    drop(references);
    let [low, high] = halves(cell, plane.axis, plane.split);
    let fork = depth < FORK_LEVELS && count >= FORK_COUNT;
    arena.inner(
        plane.axis,
        plane.split,
        fork,
        |arena| divide(below, &low, depth + 1, failed, settings, best, arena),
        |arena| divide(above, &high, depth + 1, failed, settings, best, arena),
    );
}

/// Those that reach below the plane, and those that reach above it.
fn part(references: &[Reference], axis: usize, split: f32) -> [Vec<Reference>; 2] {
    let below = references.iter().filter(|r| r.bounds.min[axis] < split).copied().collect();
    let above = references.iter().filter(|r| r.bounds.max[axis] > split).copied().collect();
    [below, above]
}
