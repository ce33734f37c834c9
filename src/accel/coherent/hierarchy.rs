//! Trees of boxes, and trees of those of their nodes alone that matter to a shaft.

use std::fmt::Debug;

use crate::math::Aabb;

/// A tree of boxes, each inside its parent's.
pub trait Hierarchy: Copy {
    /// A node or leaf, with all that its box is told by.
    type Place: Copy + PartialEq + Debug;

    /// Its box.
    fn bounds(&self, place: Self::Place) -> Aabb;

    /// Its children; `None` if it is a leaf.
    fn below(&self, place: Self::Place) -> Option<[Self::Place; 2]>;

    /// Whether it is known to hold no triangles.
    fn is_empty(&self, place: Self::Place) -> bool;
}

/// A node with something on either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Branch<P> {
    pub(super) sides: [P; 2],
    /// So many branches before this one lies that of each side; 0 if there is none, and the
    /// hierarchy goes on.
    pub(super) back: [u32; 2],
}

/// A place to walk from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step<P> {
    /// The place.
    pub place: P,
    /// The number of its branch, from 1 on; 0 in the hierarchy itself.
    pub(super) branch: u32,
}

impl<P> Step<P> {
    /// A place in the hierarchy itself.
    #[inline(always)]
    pub const fn to(place: P) -> Self {
        Self { place, branch: 0 }
    }

    /// Whether it is in the hierarchy itself.
    #[inline(always)]
    pub const fn is_plain(&self) -> bool {
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
pub struct Branches<'a, P> {
    /// Those of a view.
    pub view: &'a [Branch<P>],
    /// Those of the thread.
    pub own: &'a [Branch<P>],
}

impl<P: Copy> Branches<'_, P> {
    /// The children of a step: `None` in a leaf.
    #[inline(always)]
    pub fn below<H: Hierarchy<Place = P>>(&self, tree: H, step: Step<P>) -> Option<[Step<P>; 2]> {
        if step.branch == 0 {
            return tree.below(step.place).map(|below| below.map(Step::to));
        }
        Some(self.sides(step))
    }

    /// What lies on either side of a branch.
    #[inline(always)]
    pub fn sides(&self, step: Step<P>) -> [Step<P>; 2] {
        let at = step.branch as usize - 1;
        let Branch { sides, back } =
            if at < self.view.len() { self.view[at] } else { self.own[at - self.view.len()] };
        let side = |side: usize| Step {
            place: sides[side],
            branch: if back[side] == 0 { 0 } else { step.branch - back[side] },
        };
        [side(0), side(1)]
    }
}
