//! Walks: which nodes a ray visits, in which order. They know nothing of builds.

pub mod backtrack;
pub mod branchless;
pub mod front_to_back;
pub mod leaf_by_leaf;
pub mod plane_points;
pub mod prefetch;
mod robust;
pub mod todo;
mod visit;
pub mod wide;

pub use visit::{LeafTest, Visit, With};

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use super::layout::Nodes;
use super::ray::{KdRay, Span};
use super::tree::{Base, KdTree};
use crate::accel::{BuildReport, Counters, MemoryReport, PreparedRay, Query, Traverse};

/// A way through a tree.
///
/// Given a tame ray and the part of it inside the root's box, a walk tests the leaves that the
/// span crosses, front to back, until a hit is strictly before what is left. Rays that are not
/// tame never come here.
pub trait Walk: Send + Sync {
    /// What a thread needs.
    type Scratch: Send;

    /// The nodes.
    fn nodes(&self) -> &dyn Nodes;

    /// Fresh scratch for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Walks.
    fn walk<Q: Query, C: Counters>(
        &self,
        visit: &mut Visit<'_, Q, C>,
        span: Span,
        scratch: &mut Self::Scratch,
    );

    /// Bytes of what it derived from the tree, the nodes aside.
    fn memory(&self) -> Vec<(&'static str, usize)> {
        Vec::new()
    }
}

/// A tree with a way through it: what the table's rows build.
pub struct Walked<W> {
    base: Arc<Base>,
    walk: W,
    level: Level,
    report: BuildReport,
}

impl<W: Walk> Walked<W> {
    /// Joins them.
    pub fn new(tree: &KdTree, walk: W, level: Level) -> Self {
        Self { base: Arc::clone(&tree.base), walk, level, report: tree.report.clone() }
    }

    /// The way.
    pub fn way(&self) -> &W {
        &self.walk
    }

    /// What all walks through the tree share.
    pub fn base(&self) -> &Base {
        &self.base
    }
}

impl<W: Walk> Traverse for Walked<W> {
    type Scratch = (W::Scratch, robust::Todo);

    fn scratch(&self) -> Self::Scratch {
        (self.walk.scratch(), robust::Todo::default())
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        (scratch, todo): &mut Self::Scratch,
        counters: &mut C,
    ) {
        let (base, ray) = (&*self.base, KdRay::new(&prepared.ray));
        let leaf_test = &With(simd);
        let mut visit = Visit { base, prepared, ray, leaf_test, query, counters };
        if !base.slack.is_tame(&prepared.ray) {
            robust::walk(self.walk.nodes(), &mut visit, todo);
        } else if let Some(span) = visit.span() {
            self.walk.walk(&mut visit, span, scratch);
        }
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.walk.nodes().bytes())];
        parts.extend(self.base.leaves.memory());
        parts.extend(self.walk.memory());
        MemoryReport::new(parts)
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}
