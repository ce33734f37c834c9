//! A ray's visit of a tree: what all walks carry along.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use crate::accel::kd::ray::{KdRay, Span};
use crate::accel::kd::tree::{Base, LANES, LeafId, Slot};
use crate::accel::{Counters, Event, PreparedRay, Query, RayContext, Verdict};
use crate::math::{larger, smaller};

/// Tests the triangles of a leaf with some instruction set.
///
/// Walks are scalar and compiled once; only this exists for each instruction set. It costs an
/// indirect call for each leaf that is not empty.
pub trait LeafTest<Q, C>: Sync {
    /// Tests some triangles; true if the answer is final.
    fn test(&self, visit: &mut Visit<'_, Q, C>, slots: &[Slot]) -> bool;
}

/// An instruction set.
pub struct With<S>(pub S);

impl<S: Simd, Q: Query, C: Counters> LeafTest<Q, C> for With<S> {
    fn test(&self, visit: &mut Visit<'_, Q, C>, slots: &[Slot]) -> bool {
        self.0.vectorize(
            #[inline(always)]
            || test_slots(self.0, visit, slots).is_break(),
        )
    }
}

#[inline(always)]
fn test_slots<S: Simd, Q: Query, C: Counters>(
    simd: S,
    Visit { base, ray, verdict, query, counters, .. }: &mut Visit<'_, Q, C>,
    slots: &[Slot],
) -> ControlFlow<()> {
    let (verdict, query, counters) = (*verdict, &mut **query, &mut **counters);
    let context = &mut RayContext { simd, ray, verdict, query, counters };
    for slots in slots.chunks(LANES) {
        let block = base.leaves.block(simd, slots);
        context.test_block(block.parts())?;
    }
    ControlFlow::Continue(())
}

/// A ray in a tree, what is asked of it, and what was found so far.
pub struct Visit<'a, Q, C> {
    /// What all walks share.
    pub base: &'a Base,
    /// The ray.
    pub ray: &'a PreparedRay<'a>,
    /// The ray, prepared for planes.
    pub kd_ray: KdRay,
    /// How leaves are tested.
    pub leaf_test: &'a dyn LeafTest<Q, C>,
    /// Who says what is hit, if not the exact test.
    pub verdict: Option<&'a dyn Verdict>,
    /// The question.
    pub query: &'a mut Q,
    /// What is counted.
    pub counters: &'a mut C,
}

impl<'a, Q: Query, C: Counters> Visit<'a, Q, C> {
    /// Begins a visit; leaves are tested with the instruction set of the context.
    #[inline(always)]
    pub fn new<S: Simd>(
        base: &'a Base,
        context: &'a mut RayContext<'_, S, Q, C>,
        leaf_test: &'a With<S>,
    ) -> Self {
        let RayContext { ray, verdict, query, counters, .. } = context;
        let kd_ray = KdRay::new(&ray.ray);
        Self { base, ray, kd_ray, leaf_test, verdict: *verdict, query, counters }
    }

    /// See `find_span`.
    #[inline(always)]
    pub fn span(&self) -> Option<Span> {
        find_span(self.base, self.ray, self.query.t_max())
    }

    /// Tests a leaf; true if nothing beyond `exit` can change the answer any more.
    #[inline(always)]
    pub fn ends_in_leaf(&mut self, leaf: LeafId, exit: f32) -> bool {
        self.test_leaf(leaf) || self.query.t_max() < exit
    }

    /// Tests a leaf; true if the answer is final.
    #[inline(always)]
    pub fn test_leaf(&mut self, leaf: LeafId) -> bool {
        self.counters.count(Event::Leaf);
        if leaf.is_empty() {
            return false;
        }
        let (base, leaf_test) = (self.base, self.leaf_test);
        leaf_test.test(self, base.leaves.triangles(leaf))
    }
}

/// Finds the part of a tame ray inside the root's box, if any.
#[inline(always)]
pub fn find_span(base: &Base, ray: &PreparedRay<'_>, t_max: f32) -> Option<Span> {
    let (enter, exit) = ray.slab.interval(&base.bounds);
    let (enter, exit) = (larger(enter, ray.ray.t_min()), smaller(exit, t_max));
    (enter <= exit).then_some(Span { enter, exit })
}
