//! The exact sweep: every plane where a triangle's box begins or ends is a candidate.
//!
//! - I. Wald, V. Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log
//!   N)", 2006. The events of all three axes are sorted once, in one list; a split takes the list
//!   apart in its order. Triangles on both sides are clipped to each ("perfect splits"); their new
//!   events, few, are sorted and merged.
//!
//! Planar triangles, which Wald and Havran put on the cheaper side, do not occur: the slack gives
//! all boxes thickness. A triangle is below a plane if it begins before it, and above if it ends
//! behind it. Parts are clipped to the cell grown by the slack, and grown themselves afterwards.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::arena::Arena;
use super::input::{Reference, TreeInput};
use super::limits::{Limits, forks};
use super::sah::Plane;
use crate::accel::kd::tree::split_cell;
use crate::math::Aabb;

/// Where a box begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Event {
    at: f32,
    /// The place of the triangle in the node's list.
    place: u32,
    axis: u8,
    begins: bool,
}

impl Event {
    /// By coordinate, axis, ends before beginnings; zeros have one sign.
    #[inline]
    fn order(&self, other: &Self) -> Ordering {
        let tie = || (self.axis, self.begins).cmp(&(other.axis, other.begins));
        self.at.total_cmp(&other.at).then_with(tie)
    }

    /// Both events of a box along all axes.
    fn of(place: u32, bounds: &Aabb) -> [Self; 6] {
        let event = |axis: usize, begins: bool| Self {
            at: if begins { bounds.min[axis] } else { bounds.max[axis] } + 0.0,
            place,
            axis: axis as u8,
            begins,
        };
        [
            event(0, true),
            event(0, false),
            event(1, true),
            event(1, false),
            event(2, true),
            event(2, false),
        ]
    }
}

/// The triangles of a node, and their events in order.
struct Part {
    references: Vec<Reference>,
    events: Vec<Event>,
}

/// Builds the tree.
pub fn build(input: &TreeInput<'_>) -> Arena {
    let references = input.references();
    let mut events: Vec<_> = references
        .par_iter()
        .enumerate()
        .flat_map_iter(|(place, reference)| Event::of(place as u32, &reference.bounds))
        .collect();
    // Stable: equal events stay in the order of the triangles.
    events.par_sort_by(Event::order);
    let mut arena = Arena::default();
    Builder(input).divide(Part { references, events }, &input.bounds, 0, 0, &mut arena);
    arena
}

struct Builder<'a>(&'a TreeInput<'a>);

/// The plane of the lowest cost.
fn find_best(part: &Part, cell: &Aabb, limits: &Limits) -> Option<Plane> {
    let mut below = [0; 3];
    let mut above = [part.references.len(); 3];
    let costs = limits.costs.in_cell(cell);
    let mut best = None;
    let mut rest = &part.events[..];
    while let Some(&Event { at, axis, .. }) = rest.first() {
        let of_group = |event: &&Event| event.at == at && event.axis == axis;
        let group = rest.iter().take_while(of_group);
        let (mut ends, mut count) = (0, 0);
        for event in group {
            count += 1;
            ends += usize::from(!event.begins);
        }
        let axis = axis as usize;
        above[axis] -= ends;
        if let Some(plane) = costs.weigh(axis, at, below[axis], above[axis]) {
            best = Some(Plane::choose_cheaper(best, plane));
        }
        below[axis] += count - ends;
        rest = &rest[count..];
    }
    best
}

impl Builder<'_> {
    fn divide(&self, part: Part, cell: &Aabb, depth: usize, mut failed: u32, arena: &mut Arena) {
        let (limits, count) = (&self.0.limits, part.references.len());
        let best = if count <= limits.leaf || depth >= limits.depth {
            None
        } else {
            find_best(&part, cell, limits)
        };
        let plane = best.filter(|plane| !limits.stops(count, Some(plane), &mut failed));
        let Some(plane) = plane else {
            arena.add_leaf(part.references.iter().map(|reference| reference.id));
            return;
        };
        let cells = split_cell(cell, plane.axis, plane.split);
        let [below, above] = self.split(&part, &plane, &cells);
        drop(part);
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
        part: Part,
        cell: &Aabb,
        (depth, failed, is_forked): (usize, u32, bool),
        arena: &mut Arena,
    ) {
        let count = part.references.len();
        self.divide(part, cell, depth + 1, failed, arena);
        if is_forked && !forks(depth + 1, count) {
            self.0.steps.place(count);
        }
    }

    /// What is on either side of a plane.
    fn split(&self, part: &Part, plane: &Plane, cells: &[Aabb; 2]) -> [Part; 2] {
        /// Not on this side, or there with new events.
        const GONE: u32 = u32::MAX;
        let grown = cells.map(|cell| self.0.slack.grow(&cell));
        let mut sides = [(); 2].map(|()| Side::new(part.references.len() / 2));
        for reference in &part.references {
            let is_below = reference.bounds.min[plane.axis] < plane.split;
            let is_above = reference.bounds.max[plane.axis] > plane.split;
            let straddles = is_below && is_above;
            for (side, (is_here, grown)) in
                sides.iter_mut().zip([is_below, is_above].into_iter().zip(&grown))
            {
                let place = side.references.len() as u32;
                side.places.push(if is_here && !straddles { place } else { GONE });
                if !is_here {
                    continue;
                }
                let mut reference = *reference;
                if straddles {
                    let clipped = self.0.source.clip(reference.id, grown);
                    let Some(bounds) = clipped else { continue };
                    reference.bounds = self.0.slack.grow(&bounds);
                    side.new_events.extend(Event::of(place, &reference.bounds));
                }
                side.references.push(reference);
            }
        }
        sides.map(|side| {
            let Side { references, places, mut new_events } = side;
            new_events.sort_by(Event::order);
            let old = part.events.iter().filter_map(|event| {
                let place = places[event.place as usize];
                (place != GONE).then_some(Event { place, ..*event })
            });
            let mut events = Vec::with_capacity(references.len() * 6);
            let mut new = new_events.into_iter().peekable();
            for event in old {
                while let Some(earlier) = new.next_if(|new| new.order(&event).is_lt()) {
                    events.push(earlier);
                }
                events.push(event);
            }
            events.extend(new);
            Part { references, events }
        })
    }
}

/// One side of a split in the making.
struct Side {
    references: Vec<Reference>,
    /// Where each triangle of the node went.
    places: Vec<u32>,
    new_events: Vec<Event>,
}

impl Side {
    fn new(capacity: usize) -> Self {
        Self {
            references: Vec::with_capacity(capacity),
            places: Vec::with_capacity(2 * capacity + 1),
            new_events: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::kd::build::sah::Costs;
    use crate::math::{PrimId, Vec3};

    #[test]
    fn the_sweep_finds_what_trying_all_planes_finds() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Few values, so that many events coincide.
            ((state >> 24) % 16) as f32
        };
        for count in 1..40 {
            let references: Vec<_> = (0..count)
                .map(|i| {
                    let min = Vec3::new(random(), random(), random());
                    let max = min + Vec3::new(random(), random(), random()) + 0.5;
                    Reference { bounds: Aabb { min, max }, id: PrimId(i) }
                })
                .collect();
            let cell = Aabb { min: Vec3::splat(1.0), max: Vec3::splat(24.0) };
            let mut events: Vec<_> = references
                .iter()
                .enumerate()
                .flat_map(|(i, reference)| Event::of(i as u32, &reference.bounds))
                .collect();
            events.sort_by(Event::order);
            let limits = Limits {
                costs: Costs { traversal_cost: 1.0, intersection_cost: 1.5, empty_bonus: 0.2 },
                depth: 9,
                leaf: 1,
            };
            let all = events.iter().filter_map(|event| {
                let axis = event.axis as usize;
                let below = references.iter().filter(|r| r.bounds.min[axis] < event.at).count();
                let above = references.iter().filter(|r| r.bounds.max[axis] > event.at).count();
                limits.costs.in_cell(&cell).weigh(axis, event.at, below, above)
            });
            let expected = all.fold(None, |best, plane| Some(Plane::choose_cheaper(best, plane)));
            assert_eq!(
                find_best(&Part { references, events: events.clone() }, &cell, &limits),
                expected
            );
        }
    }
}
