//! A ray's visit of a tree: what all walks carry along.

use std::ops::ControlFlow;

use fearless_simd::{Simd, f32x4};

use super::super::ray::{KdRay, Span};
use super::super::tree::{Base, LANES, LeafId, Leaves, Slot};
use crate::accel::{Counters, Event, PreparedRay, Query, test_block};
use crate::math::{larger, smaller};

/// Tests the triangles of a leaf with some instruction set.
///
/// Walks are scalar and compiled once; only this exists for each instruction set. It costs an
/// indirect call for each leaf that is not empty.
pub trait LeafTest<Q, C>: Sync {
    /// Tests some triangles; true if the answer is final.
    fn test(
        &self,
        leaves: &Leaves,
        slots: &[Slot],
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        counters: &mut C,
    ) -> bool;
}

/// An instruction set.
pub struct With<S>(pub S);

impl<S: Simd, Q: Query, C: Counters> LeafTest<Q, C> for With<S> {
    fn test(
        &self,
        leaves: &Leaves,
        slots: &[Slot],
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        counters: &mut C,
    ) -> bool {
        self.0.vectorize(
            #[inline(always)]
            || test_all(self.0, leaves, slots, prepared, query, counters).is_break(),
        )
    }
}

/// Tests the triangles of a leaf.
#[inline(always)]
pub fn test_all<S: Simd, Q: Query, C: Counters>(
    simd: S,
    leaves: &Leaves,
    slots: &[Slot],
    prepared: &PreparedRay<'_>,
    query: &mut Q,
    counters: &mut C,
) -> ControlFlow<()> {
    for slots in slots.chunks(LANES) {
        let block = leaves.block(simd, slots);
        test_block::<S, f32x4<S>, Q, C, LANES>(simd, prepared, block.parts(), query, counters)?;
    }
    ControlFlow::Continue(())
}

/// A ray in a tree, what is asked of it, and what was found so far.
pub struct Visit<'a, Q, C> {
    /// What all walks share.
    pub base: &'a Base,
    /// The ray.
    pub prepared: &'a PreparedRay<'a>,
    /// The ray, prepared for planes.
    pub ray: KdRay,
    /// How leaves are tested.
    pub leaf_test: &'a dyn LeafTest<Q, C>,
    /// The question.
    pub query: &'a mut Q,
    /// What is counted.
    pub counters: &'a mut C,
}

impl<Q: Query, C: Counters> Visit<'_, Q, C> {
    /// The part of a tame ray inside the root's box, if any.
    #[inline(always)]
    pub fn span(&self) -> Option<Span> {
        let (enter, exit) = self.prepared.slab.interval(&self.base.bounds);
        let enter = larger(enter, self.prepared.ray.t_min());
        let exit = smaller(exit, self.query.t_max());
        (enter <= exit).then_some(Span { enter, exit })
    }

    /// Tests a leaf; true if nothing beyond `exit` can change the answer any more.
    #[inline(always)]
    pub fn leaf_ends(&mut self, leaf: LeafId, exit: f32) -> bool {
        self.leaf(leaf) || self.query.t_max() < exit
    }

    /// Tests a leaf; true if the answer is final.
    #[inline(always)]
    pub fn leaf(&mut self, leaf: LeafId) -> bool {
        self.counters.count(Event::Leaf);
        if leaf.is_empty() {
            return false;
        }
        let leaves = &self.base.leaves;
        let slots = leaves.triangles(leaf);
        self.leaf_test.test(leaves, slots, self.prepared, self.query, self.counters)
    }
}
