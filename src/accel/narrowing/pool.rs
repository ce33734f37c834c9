//! The branches that a thread has derived, for the regions that it has entered and the slice at
//! hand.

use super::hierarchy::{Branch, Branches, Step};
use crate::accel::PoolUse;
use crate::geom::Shaft;

/// A region that a thread has entered.
pub struct Region<P> {
    /// The region.
    pub shaft: Shaft,
    /// Where its rays start; `None` if it meets no leaf.
    pub from: Option<Step<P>>,
    /// So many branches were in the pool before.
    before: usize,
}

/// Trees of branches, each on top of the last: of the regions that were entered, from the outermost
/// on, then of the slice and of the packet at hand.
pub struct BranchPool<P> {
    branches: Vec<Branch<P>>,
    regions: Vec<Region<P>>,
    /// The most branches in use since this was asked last.
    peak: usize,
}

impl<P> Default for BranchPool<P> {
    fn default() -> Self {
        Self { branches: Vec::new(), regions: Vec::new(), peak: 0 }
    }
}

impl<P> BranchPool<P> {
    /// The branches.
    #[inline(always)]
    pub fn branches(&self) -> Branches<'_, P> {
        Branches(&self.branches)
    }

    /// The branches, for new ones to be put on top.
    pub fn branches_mut(&mut self) -> &mut Vec<Branch<P>> {
        &mut self.branches
    }

    /// How many branches there are.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.branches.len()
    }

    /// Drops all branches but the first few.
    #[inline(always)]
    pub fn truncate(&mut self, count: usize) {
        self.note_peak();
        self.branches.truncate(count);
    }

    /// The regions that were entered, from the outermost on.
    pub fn regions(&self) -> &[Region<P>] {
        &self.regions
    }

    /// Enters a region, whose branches are all those from number `before` on.
    pub fn enter(&mut self, shaft: Shaft, from: Option<Step<P>>, before: usize) {
        self.note_peak();
        self.regions.push(Region { shaft, from, before });
    }

    /// Leaves the region that was entered last: its branches go.
    pub fn leave(&mut self) {
        if let Some(region) = self.regions.pop() {
            self.branches.truncate(region.before);
        }
    }

    /// Notes how many branches are in use.
    pub fn note_peak(&mut self) {
        self.peak = self.peak.max(self.branches.len());
    }

    /// Bytes in use at most since this was asked last, and bytes taken.
    pub fn take_pool_use(&mut self) -> PoolUse {
        let in_use = self.branches.len();
        let peak = std::mem::replace(&mut self.peak, in_use).max(in_use);
        let bytes = size_of::<Branch<P>>();
        PoolUse { peak: peak * bytes, size: self.branches.capacity() * bytes }
    }
}
