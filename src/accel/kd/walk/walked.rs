//! A tree with a walk through it.

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use super::interface::Walk;
use super::robust;
use super::visit::{Visit, With};
use crate::accel::kd::tree::{Base, KdTree};
use crate::accel::{Built, Counters, MemoryReport, Query, RayContext, Structure, WalkRay};

/// A tree with a way through it: what the table's rows build.
pub struct Walked<W> {
    base: Arc<Base>,
    walk: W,
    built: Built,
}

impl<W: Walk> Walked<W> {
    /// Joins a tree and a walk.
    pub fn new(tree: &KdTree, walk: W, level: Level) -> Self {
        Self {
            base: Arc::clone(&tree.base),
            walk,
            built: Built { level, report: tree.report.clone() },
        }
    }

    /// How its rays walk.
    pub fn way(&self) -> &W {
        &self.walk
    }

    /// What all walks through the tree share.
    pub fn base(&self) -> &Base {
        &self.base
    }
}

impl<W: Walk> Structure for Walked<W> {
    type Scratch = (W::Scratch, robust::Todo);

    fn scratch(&self) -> Self::Scratch {
        (self.walk.scratch(), robust::Todo::default())
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.walk.nodes().bytes())];
        parts.extend(self.base.leaves.memory());
        parts.extend(self.walk.memory());
        MemoryReport::new(parts)
    }
}

impl<W: Walk> WalkRay for Walked<W> {
    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        (scratch, todo): &mut Self::Scratch,
    ) {
        let leaf_test = &With(context.simd);
        let mut visit = Visit::new(&self.base, context, leaf_test);
        if !self.base.slack.is_tame(&visit.ray.ray) {
            robust::walk(self.walk.nodes(), &mut visit, todo);
        } else if let Some(span) = visit.span() {
            self.walk.walk(&mut visit, span, scratch);
        }
    }
}
