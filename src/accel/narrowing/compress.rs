//! Path compression: the part of the hierarchy that a shaft meets, without the detours.
//!
//! J. Barczak, "An improved multi-level raytracing algorithm", sections 3.3 to 3.5 and appendix A.
//! Of the nodes that a shaft meets, most have one child only that it meets too; rays of the shaft
//! need not stop at those. What is left are *branches*, nodes with something on either side, linked
//! to the next branch below. A leaf of the tree of branches is a leaf of the hierarchy, or a node
//! whose box lies in the shaft altogether: from there on rays walk the hierarchy itself.
//!
//! A tree of branches is narrowed to a part of its shaft in the same manner, and so on: the screen,
//! a tile, a packet. Its inner nodes were not enclosed by the shaft before, so they are not by a
//! part of it and are not asked; at its leaves the hierarchy goes on in full.
//!
//! Where we differ: a branch names its children by their places in the hierarchy, and a leaf of the
//! tree takes no room of its own. A tree also ends where boxes become small beside the shaft
//! ([`GRAIN`]): few packets of a tile come by such a node, and to look for what lies below it takes
//! more steps than the tree would spare them. In a bounding volume hierarchy the boxes of places
//! stand in their parents; in a kd-tree a place carries its box (section 5.1 of the paper). Empty
//! leaves of a kd-tree are as good as missed. And where the left of a branch proves empty, appendix
//! A drops the branch at once, which would lose its right; ours goes there first. Both ways of
//! building leave the same bytes.

use super::hierarchy::{Branch, Branches, Hierarchy, Step};
use crate::accel::{Counters, Event};
use crate::geom::Shaft;
use crate::simd::baseline;

/// A tree ends at nodes of which this part would fit across the shaft: at half, boxes up to twice
/// as wide as it. Nodes of a picture, searched and walked, over those of entry points, by 8x8
/// tiles, of a machine of 871,414 triangles from afar (`bench coherent`): 1.46 without such an end,
/// 1.19 at 8, 1.07 at 2, 1.02 at 1 and 0.99 at a half; of a kitchen 0.81 at 4 and 0.73 at a half,
/// of a city 0.80 and 0.72.
pub const GRAIN: f32 = 0.5;

/// Levels that are expected; deeper trees only cost another allocation.
const LEVELS: usize = 64;

/// What a tree is built from and in.
pub struct Compression<'a, H: Hierarchy> {
    /// The tree.
    pub tree: H,
    /// Branches of the thread; new ones are put behind them.
    pub branches: &'a mut Vec<Branch<H::Place>>,
    /// What the tree is for.
    pub shaft: &'a Shaft,
}

/// A branch whose sides are not all known yet.
#[derive(Clone, Copy)]
struct Fork<P> {
    place: P,
    /// Its right as long as only its left was gone to.
    right: Option<Step<P>>,
    /// What its left came to.
    left: Option<Step<P>>,
}

impl<H: Hierarchy> Compression<'_, H> {
    /// What a step leads to.
    fn children(&self, step: Step<H::Place>) -> Option<[Step<H::Place>; 2]> {
        Branches(self.branches).children(self.tree, step)
    }

    fn is_met<C: Counters>(&self, step: Step<H::Place>, counters: &mut C) -> bool {
        counters.count(Event::Search);
        !self.tree.is_empty(step.place)
            && !self.shaft.misses(baseline(), &self.tree.bounds(step.place))
    }

    /// Whether the tree ends here. Branches of the tree that is narrowed are not asked.
    fn is_end(&self, step: Step<H::Place>) -> bool {
        step.branch == 0
            && (self.tree.children(step.place).is_none()
                || self.shaft.encloses(baseline(), &self.tree.bounds(step.place))
                || self.shaft.is_coarser(&self.tree.bounds(step.place), GRAIN))
    }

    /// What both sides of a node come to.
    fn join(
        &mut self,
        place: H::Place,
        left: Option<Step<H::Place>>,
        right: Option<Step<H::Place>>,
    ) -> Option<Step<H::Place>> {
        let (Some(left), Some(right)) = (left, right) else { return left.or(right) };
        let branch = self.branches.len() as u32 + 1;
        let back = |step: Step<H::Place>| if step.branch == 0 { 0 } else { branch - step.branch };
        self.branches
            .push(Branch { sides: [left.place, right.place], back: [back(left), back(right)] });
        Some(Step { place, branch })
    }

    /// Compresses what is below a step: the paper's figure 5. `None` if the shaft meets no leaf.
    pub fn compress_recursively<C: Counters>(
        &mut self,
        step: Step<H::Place>,
        counters: &mut C,
    ) -> Option<Step<H::Place>> {
        if !self.is_met(step, counters) {
            return None;
        }
        if self.is_end(step) {
            return Some(Step::to(step.place));
        }
        let [left, right] = self.children(step)?;
        let left = self.compress_recursively(left, counters);
        let right = self.compress_recursively(right, counters);
        self.join(step.place, left, right)
    }

    /// The same without recursion: appendix A.
    pub fn compress_iteratively<C: Counters>(
        &mut self,
        step: Step<H::Place>,
        counters: &mut C,
    ) -> Option<Step<H::Place>> {
        if !self.is_met(step, counters) {
            return None;
        }
        let mut forks: Vec<Fork<H::Place>> = Vec::with_capacity(LEVELS);
        let mut at = step;
        loop {
            // Down, until there is something to link, or nothing.
            let mut found = loop {
                if self.is_end(at) {
                    break Some(Step::to(at.place));
                }
                let Some([left, right]) = self.children(at) else { break None };
                match (self.is_met(left, counters), self.is_met(right, counters)) {
                    (true, true) => {
                        forks.push(Fork { place: at.place, right: Some(right), left: None });
                        at = left;
                    }
                    (true, false) => at = left,
                    (false, true) => at = right,
                    (false, false) => break None,
                }
            };
            // Up, as long as both sides of a fork are known.
            loop {
                let Some(fork) = forks.last_mut() else { return found };
                if let Some(right) = fork.right.take() {
                    fork.left = found;
                    at = right;
                    break;
                }
                let Fork { place, left, .. } = *fork;
                forks.pop();
                found = self.join(place, left, found);
            }
        }
    }
}
