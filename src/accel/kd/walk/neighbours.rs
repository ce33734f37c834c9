//! From leaf to leaf by links between neighbours: no stack, and no way down from the root but once.
//!
//! The distance at which a leaf was left is compared with the distances of planes; no point is
//! located. A plane by which a cell was left is crossed by its link, whatever the rounding. Where
//! planes of several axes have the same distance, the links lead through leaves of no length,
//! which are not tested: so the leaves that are tested are those of every other walk.

use fearless_simd::Simd;

use super::super::layout::{Compact, Layout, View};
use super::super::links::Links;
use super::super::ray::{KdRay, Span};
use super::super::tree::{Base, KdTree, LeafId};
use super::Walk;
use crate::accel::{Counters, Event, Query, Shot};
use crate::math::NodeId;

/// Follows links.
#[derive(Debug)]
pub struct Neighbours<K> {
    layout: Compact,
    links: K,
}

impl<K: Links> Neighbours<K> {
    /// Derives the links from a tree.
    pub fn new(tree: &KdTree) -> Self {
        Self { layout: Compact::new(tree), links: K::new(tree) }
    }
}

impl<K: Links> Walk for Neighbours<K> {
    type Layout = Compact;
    type Scratch = ();

    fn layout(&self) -> &Compact {
        &self.layout
    }

    fn scratch(&self) {}

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        base: &Base,
        ray: &KdRay,
        span: Span,
        shot: &Shot<'_>,
        query: &mut Q,
        (): &mut (),
        counters: &mut C,
    ) {
        let mut enter = span.enter;
        let mut leaf = locate(&self.layout, self.layout.root(), ray, enter, counters);
        loop {
            let (exit, axis) = ray.exit(self.links.cell(leaf));
            if exit > enter {
                let done = base.leaves.test(simd, leaf, shot, query, counters).is_break();
                if done || exit >= span.exit || query.t_max() < exit {
                    return;
                }
                enter = exit;
            }
            let link = self.links.link(leaf, axis, 1 - ray.near(axis));
            if link == NodeId::NONE {
                return;
            }
            leaf = locate(self.links.nodes(&self.layout), link, ray, enter, counters);
        }
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        self.links.memory()
    }
}

/// The leaf at a distance along a ray: below a node, beyond every plane that is met at or before
/// that distance.
#[inline(always)]
pub fn locate<L: Layout, C: Counters>(
    layout: &L,
    mut at: NodeId,
    ray: &KdRay,
    t: f32,
    counters: &mut C,
) -> LeafId {
    loop {
        match layout.view(at) {
            View::Leaf(leaf) => return leaf,
            View::Inner { axis, split, children } => {
                counters.count(Event::InnerNode);
                let near = ray.near(axis);
                at = children[if ray.t_split(axis, split) <= t { 1 - near } else { near }];
            }
        }
    }
}
