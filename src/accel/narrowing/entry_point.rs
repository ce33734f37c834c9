//! Entry points: the deepest node that holds everything a shaft meets.
//!
//! A. Reshetov, A. Soupikov and J. Hurley, "Multi-level ray tracing algorithm", 2005: go down to a
//! leaf that the shaft meets, and remember those nodes on the way of which it meets both children;
//! the highest of them with a leaf on the other side too is where rays must enter. C. Fowler, S.
//! Collins and M. Manzke, "Accelerated entry point search algorithm for real time ray tracing",
//! 2009, look at them from the top down, so that the first with a leaf ends the search. J. Barczak
//! stops at nodes whose boxes the shaft encloses: all below them is met sooner or later.

use super::hierarchy::Hierarchy;
use crate::accel::{Counters, Event};
use crate::geom::Shaft;
use crate::simd::baseline;

/// Where the rays of a shaft may enter what is below a place, and at how many nodes below that on
/// the way to the first leaf both children are met; `None` if they meet no leaf there.
pub fn find_entry_point<H: Hierarchy, C: Counters>(
    tree: H,
    from: H::Place,
    shaft: &Shaft,
    counters: &mut C,
) -> Option<(H::Place, usize)> {
    let mut search = Search { tree, shaft, counters };
    if !search.is_met(from) {
        return None;
    }
    // Nodes of which both children are met, from the top down, each with the child not gone to.
    let mut forks: Vec<(H::Place, H::Place)> = Vec::with_capacity(LEVELS);
    let mut at = from;
    while !search.is_end(at) {
        match search.find_met_children(at) {
            [Some(left), Some(right)] => {
                forks.push((at, right));
                at = left;
            }
            [Some(one), None] | [None, Some(one)] => at = one,
            // Nothing here: then the last fork was none.
            [None, None] => at = forks.pop()?.1,
        }
    }
    let highest = forks.iter().position(|&(_, other)| search.has_leaf(other));
    Some(highest.map_or((at, 0), |highest| (forks[highest].0, forks.len() - highest)))
}

/// Levels that are expected; deeper trees only cost another allocation.
const LEVELS: usize = 64;

struct Search<'a, H, C> {
    tree: H,
    shaft: &'a Shaft,
    counters: &'a mut C,
}

impl<H: Hierarchy, C: Counters> Search<'_, H, C> {
    fn is_met(&mut self, place: H::Place) -> bool {
        self.counters.count(Event::Search);
        !self.tree.is_empty(place) && !self.shaft.misses(baseline(), &self.tree.bounds(place))
    }

    /// Whether a place that is met is as good as a leaf that is.
    fn is_end(&self, place: H::Place) -> bool {
        self.tree.children(place).is_none()
            || self.shaft.encloses(baseline(), &self.tree.bounds(place))
    }

    fn find_met_children(&mut self, node: H::Place) -> [Option<H::Place>; 2] {
        let Some(children) = self.tree.children(node) else { return [None; 2] };
        children.map(|child| self.is_met(child).then_some(child))
    }

    /// Whether a leaf is met below a place that is.
    fn has_leaf(&mut self, place: H::Place) -> bool {
        let mut waiting = vec![place];
        while let Some(at) = waiting.pop() {
            if self.is_end(at) {
                return true;
            }
            waiting.extend(self.find_met_children(at).into_iter().rev().flatten());
        }
        false
    }
}
