//! Path compression: the part of the hierarchy that a shaft meets, without the detours.
//!
//! J. Barczak, "An improved multi-level raytracing algorithm", sections 3.3 to 3.5 and appendix A.
//! Of the nodes that a shaft meets, most have one child only that it meets too; rays of the shaft
//! need not stop at those. What is left are *branches*, nodes with something on either side, linked
//! to the next branch below. A leaf of the tree of branches is a leaf of the hierarchy, or a node
//! whose box lies in the shaft altogether: from there on rays walk the hierarchy itself.
//!
//! A tree of branches is narrowed to a part of its shaft in the same manner, and so on: the screen,
//! a tile, a packet. Its inner nodes were not enclosed by the shaft before, so they are not by a part
//! of it and are not asked; at its leaves the hierarchy goes on in full.
//!
//! Where we differ: a tree also ends where boxes become small beside the shaft ([`GRAIN`]). Few
//! packets of a tile come by such a node, and to look for what lies below it takes as many steps as
//! the tree would spare them: of a dense object far away, whose small nodes lie across the borders
//! of tiles in great number, more. A branch names its children by their places in the hierarchy,
//! whose boxes stand in their parents, and a leaf of the tree takes no room of its own. And where
//! the left of a branch proves empty, appendix A drops the branch at once, which would lose its
//! right; ours goes there first. Both ways of building leave the same bytes.

use super::place::{Place, Places};
use crate::accel::bvh::sah;
use crate::accel::{Counters, Event};
use crate::geom::Shaft;
use crate::simd::baseline;

/// A tree ends at nodes of which this part would fit across the shaft: at half, boxes up to twice as
/// wide as it. Nodes of a picture, searched and walked, over those of entry points, by 8x8 tiles, of a
/// machine of 871,414 triangles from afar (`bench coherent`): 1.46 without such an end, 1.19 at 8,
/// 1.07 at 2, 1.02 at 1 and 0.99 at a half; of a kitchen 0.81 at 4 and 0.73 at a half, of a city 0.80
/// and 0.72.
pub const GRAIN: f32 = 0.5;

/// A node with something on either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Branch {
    sides: [Place; 2],
    /// So many branches before this one lies that of each side; 0 if there is none, and the
    /// hierarchy goes on.
    back: [u32; 2],
}

/// A place to walk from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    pub place: Place,
    /// The number of its branch, from 1 on; 0 in the hierarchy itself.
    branch: u32,
}

impl Step {
    /// The root of the hierarchy.
    pub const ROOT: Self = Self::to(Place::ROOT);

    /// A place in the hierarchy itself.
    #[inline(always)]
    pub const fn to(place: Place) -> Self {
        Self { place, branch: 0 }
    }

    /// Whether it lies in the hierarchy itself.
    #[inline(always)]
    pub fn is_plain(self) -> bool {
        self.branch == 0
    }

    /// The same where so many branches before its own are no more.
    pub fn without(self, branches: usize) -> Self {
        Self { branch: self.branch.saturating_sub(branches as u32), ..self }
    }
}

/// Branches: those of a view, which all threads share, and after them the thread's own. Trees are
/// built at the end, one upon the other, and released in the reverse order; branches point at one
/// another by distances, so that it does not matter where they come to lie.
#[derive(Clone, Copy)]
pub struct Branches<'a> {
    pub view: &'a [Branch],
    pub own: &'a [Branch],
}

impl Branches<'_> {
    /// The children of a step: `None` in a leaf.
    #[inline(always)]
    pub fn below(&self, places: Places<'_>, step: Step) -> Option<[Step; 2]> {
        if step.branch == 0 {
            let link = places.link(step.place);
            if link.is_leaf() {
                return None;
            }
            let [left, right] = Place::below(link.place());
            return Some([Step::to(left), Step::to(right)]);
        }
        let at = step.branch as usize - 1;
        let Branch { sides, back } =
            if at < self.view.len() { self.view[at] } else { self.own[at - self.view.len()] };
        let link = |back: u32| if back == 0 { 0 } else { step.branch - back };
        let ([left, right], [to_left, to_right]) = (sides, back);
        Some([
            Step { place: left, branch: link(to_left) },
            Step { place: right, branch: link(to_right) },
        ])
    }
}

/// What a tree is built from and in.
pub struct Compression<'a> {
    pub places: Places<'a>,
    pub view: &'a [Branch],
    pub own: &'a mut Vec<Branch>,
    pub shaft: &'a Shaft,
}

/// A branch whose sides are not all known yet.
#[derive(Clone, Copy)]
struct Fork {
    place: Place,
    /// Its right as long as only its left was gone to.
    right: Option<Step>,
    /// What its left came to.
    left: Option<Step>,
}

impl Compression<'_> {
    /// What a step leads to.
    fn below(&self, step: Step) -> Option<[Step; 2]> {
        Branches { view: self.view, own: self.own }.below(self.places, step)
    }

    fn is_met<C: Counters>(&self, step: Step, counters: &mut C) -> bool {
        counters.count(Event::Search);
        !self.shaft.misses(baseline(), &self.places.bounds(step.place))
    }

    /// Whether the tree ends here. Branches of the tree that is narrowed are not asked.
    fn is_end(&self, step: Step) -> bool {
        step.branch == 0
            && (self.places.link(step.place).is_leaf()
                || self.shaft.encloses(baseline(), &self.places.bounds(step.place))
                || self.shaft.is_coarser(&self.places.bounds(step.place), GRAIN))
    }

    /// What both sides of a node come to.
    fn join(&mut self, place: Place, left: Option<Step>, right: Option<Step>) -> Option<Step> {
        let (Some(left), Some(right)) = (left, right) else { return left.or(right) };
        let branch = (self.view.len() + self.own.len()) as u32 + 1;
        let back = |step: Step| if step.branch == 0 { 0 } else { branch - step.branch };
        self.own.push(Branch { sides: [left.place, right.place], back: [back(left), back(right)] });
        Some(Step { place, branch })
    }

    /// Compresses what is below a step: the paper's figure 5. `None` if the shaft meets no leaf.
    pub fn recursive<C: Counters>(&mut self, step: Step, counters: &mut C) -> Option<Step> {
        if !self.is_met(step, counters) {
            return None;
        }
        if self.is_end(step) {
            return Some(Step::to(step.place));
        }
        let [left, right] = self.below(step)?;
        let left = self.recursive(left, counters);
        let right = self.recursive(right, counters);
        self.join(step.place, left, right)
    }

    /// The same without recursion: appendix A.
    pub fn iterative<C: Counters>(&mut self, step: Step, counters: &mut C) -> Option<Step> {
        if !self.is_met(step, counters) {
            return None;
        }
        let mut forks: Vec<Fork> = Vec::with_capacity(sah::MAX_DEPTH);
        let mut at = step;
        loop {
            // Down, until there is something to link, or nothing.
            let mut found = loop {
                if self.is_end(at) {
                    break Some(Step::to(at.place));
                }
                let Some([left, right]) = self.below(at) else { break None };
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
