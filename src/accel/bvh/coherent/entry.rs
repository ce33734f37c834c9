//! Entry points: the deepest node that holds everything a shaft meets.
//!
//! A. Reshetov, A. Soupikov and J. Hurley, "Multi-level ray tracing algorithm", 2005: go down to a
//! leaf that the shaft meets, and remember those nodes on the way of which it meets both children;
//! the highest of them with a leaf on the other side too is where rays must enter. C. Fowler, S.
//! Collins and M. Manzke, "Accelerated entry point search algorithm for real time ray tracing",
//! 2009, look at them from the top down, so that the first with a leaf ends the search. J. Barczak
//! stops at nodes whose boxes the shaft encloses: all below them is met sooner or later.

use super::place::{Place, Places};
use crate::accel::bvh::sah;
use crate::accel::{Counters, Event};
use crate::geom::Shaft;
use crate::simd::baseline;

/// Where the rays of a shaft may enter what is below a place; `None` if they meet no leaf there.
pub fn entry_point<C: Counters>(
    places: Places<'_>,
    from: Place,
    shaft: &Shaft,
    counters: &mut C,
) -> Option<Place> {
    let mut search = Search { places, shaft, counters };
    if !search.is_met(from) {
        return None;
    }
    // Nodes of which both children are met, from the top down, each with the child not gone to.
    let mut forks: Vec<(Place, Place)> = Vec::with_capacity(sah::MAX_DEPTH);
    let mut at = from;
    while !search.is_end(at) {
        match search.met_below(at) {
            [Some(left), Some(right)] => {
                forks.push((at, right));
                at = left;
            }
            [Some(one), None] | [None, Some(one)] => at = one,
            // Nothing here: then the last fork was none.
            [None, None] => at = forks.pop()?.1,
        }
    }
    let fork = forks.into_iter().find(|&(_, other)| search.has_leaf(other));
    Some(fork.map_or(at, |(node, _)| node))
}

struct Search<'a, C> {
    places: Places<'a>,
    shaft: &'a Shaft,
    counters: &'a mut C,
}

impl<C: Counters> Search<'_, C> {
    fn is_met(&mut self, place: Place) -> bool {
        self.counters.count(Event::Search);
        !self.shaft.misses(baseline(), &self.places.bounds(place))
    }

    /// Whether a place that is met is as good as a leaf that is.
    fn is_end(&self, place: Place) -> bool {
        self.places.link(place).is_leaf()
            || self.shaft.encloses(baseline(), &self.places.bounds(place))
    }

    fn met_below(&mut self, node: Place) -> [Option<Place>; 2] {
        let children = Place::below(self.places.link(node).place());
        children.map(|child| self.is_met(child).then_some(child))
    }

    /// Whether a leaf is met below a place that is.
    fn has_leaf(&mut self, place: Place) -> bool {
        let mut waiting = vec![place];
        while let Some(at) = waiting.pop() {
            if self.is_end(at) {
                return true;
            }
            waiting.extend(self.met_below(at).into_iter().rev().flatten());
        }
        false
    }
}
