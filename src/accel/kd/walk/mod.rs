//! Walks: which nodes a ray visits, in which order. They know nothing of builds.

pub mod front_to_back;
pub mod neighbours;
mod robust;
pub mod stack;

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use super::layout::Layout;
use super::ray::{KdRay, Span};
use super::tree::Base;
use crate::accel::{BuildReport, Counters, MemoryReport, Query, Shot, Traverse};
use crate::math::Aabb;

/// A way through a tree.
///
/// Given a tame ray and the part of it inside the root's box, a walk tests the leaves that the
/// span crosses, front to back, until a hit is strictly before what is left. Rays that are not
/// tame never come here.
pub trait Walk: Send + Sync {
    /// How nodes lie in memory.
    type Layout: Layout;
    /// What a thread needs.
    type Scratch: Send;

    /// The nodes.
    fn layout(&self) -> &Self::Layout;

    /// Fresh scratch for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Walks.
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        base: &Base,
        ray: &KdRay,
        span: Span,
        shot: &Shot<'_>,
        query: &mut Q,
        scratch: &mut Self::Scratch,
        counters: &mut C,
    );

    /// Bytes of what it derived from the tree, the layout's aside.
    fn memory(&self) -> Vec<(&'static str, usize)>;
}

/// A tree with a way through it: what the table's rows build.
#[derive(Debug)]
pub struct Walked<W> {
    base: Arc<Base>,
    walk: W,
    level: Level,
    report: BuildReport,
}

impl<W: Walk> Walked<W> {
    /// Joins them.
    pub fn new(base: Arc<Base>, walk: W, level: Level, report: BuildReport) -> Self {
        Self { base, walk, level, report }
    }
}

/// The part of a tame ray inside the root's box, if any.
#[inline(always)]
fn enter_root(bounds: &Aabb, shot: &Shot<'_>, t_max: f32) -> Option<Span> {
    let (enter, exit) = shot.slab.interval(bounds);
    let span = Span { enter: enter.max(shot.ray.t_min()), exit: exit.min(t_max) };
    (span.enter <= span.exit).then_some(span)
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
        shot: &Shot<'_>,
        query: &mut Q,
        (scratch, todo): &mut Self::Scratch,
        counters: &mut C,
    ) {
        let base = &*self.base;
        if !base.slack.is_tame(&shot.ray) {
            robust::walk(simd, base, self.walk.layout(), shot, query, todo, counters);
        } else if let Some(span) = enter_root(&base.bounds, shot, query.t_max()) {
            let ray = KdRay::new(&shot.ray);
            self.walk.walk(simd, base, &ray, span, shot, query, scratch, counters);
        }
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.walk.layout().bytes())];
        parts.extend(self.base.leaves.memory());
        parts.extend(self.walk.memory());
        MemoryReport::new(parts)
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}
