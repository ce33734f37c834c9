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
    fn children(&self, place: Self::Place) -> Option<[Self::Place; 2]>;

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
}

/// Branches: trees that were built one on top of the other, and are dropped in the reverse order.
/// Branches point at one another by distances.
#[derive(Clone, Copy)]
pub struct Branches<'a, P>(pub &'a [Branch<P>]);

impl<P: Copy> Branches<'_, P> {
    /// The children of a step; `None` for a leaf.
    #[inline(always)]
    pub fn children<H: Hierarchy<Place = P>>(
        &self,
        tree: H,
        step: Step<P>,
    ) -> Option<[Step<P>; 2]> {
        if step.branch == 0 {
            return tree.children(step.place).map(|children| children.map(Step::to));
        }
        Some(self.sides(step))
    }

    /// What lies on either side of a branch.
    #[inline(always)]
    pub fn sides(&self, step: Step<P>) -> [Step<P>; 2] {
        let Branch { sides, back } = self.0[step.branch as usize - 1];
        let side = |side: usize| Step {
            place: sides[side],
            branch: if back[side] == 0 { 0 } else { step.branch - back[side] },
        };
        [side(0), side(1)]
    }
}
