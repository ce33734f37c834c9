//! Several rays in flight: one step each in turn, so that one ray's cache misses pass while others
//! compute.
//!
//! - C. Benthin et al., "Ray tracing on the Cell processor", 2006 ("software hyperthreading");
//!   J. Bittner et al., "Adaptive global visibility sampling", 2009; section 6.4 of the review.
//!
//! Ours needs no instruction to prefetch: at the end of a step the next node is read into the
//! ray's state and not looked at before its next turn. The processor goes on with other rays while
//! the read is under way. A leaf with triangles takes four turns: its node, the place of its list,
//! the first id, and that triangle's vertices.

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use super::super::layout::{Compact, Layout, Nodes, Packed, View};
use super::super::ray::{Crossing, KdRay, Span};
use super::super::tree::{Base, KdTree, LeafId, Slot};
use super::todo::{Full, Todo};
use super::{LeafTest, Visit, With, robust};
use crate::accel::{
    Batch, BuildError, BuildReport, Counters, Event, MemoryReport, Query, Shot, Traverse,
};
use crate::math::NodeId;

/// Walks with rays in flight.
pub struct Prefetch {
    base: Arc<Base>,
    layout: Compact,
    rays: usize,
    level: Level,
    report: BuildReport,
}

impl Prefetch {
    /// Lays a tree out to walk it with that many rays at a time.
    ///
    /// # Errors
    /// If the tree is too deep for the stack.
    pub fn new(tree: &KdTree, rays: usize, level: Level) -> Result<Self, BuildError> {
        if tree.depth() > Full::CAPACITY {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: Full::CAPACITY });
        }
        Ok(Self {
            base: Arc::clone(&tree.base),
            layout: Compact::new(tree),
            rays,
            level,
            report: tree.report.clone(),
        })
    }

    /// Shoots a slice; compiled once, whatever the instruction set of `leaf_test`.
    #[inline(never)]
    fn shoot_all<Q: Query, C: Counters>(
        &self,
        leaf_test: &dyn LeafTest<Q, C>,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        robust: &mut robust::Todo,
        counters: &mut C,
    ) {
        let mut next = 0;
        let mut flights: Vec<Flight<'_, Q>> = Vec::with_capacity(self.rays);
        while next < batch.rays().len() || !flights.is_empty() {
            while flights.len() < self.rays
                && let Some(ray) = batch.rays().get(next)
            {
                let shot = Shot::new(ray, next, batch.filter());
                next += 1;
                let mut flight = Flight::new(self, shot);
                let mut visit = flight.visit(&self.base, leaf_test, counters);
                if !self.base.slack.is_tame(ray) {
                    robust::walk(&self.layout, &mut visit, robust);
                    answers[flight.shot.index] = flight.query.answer();
                } else if let Some(span) = visit.span() {
                    flight.span = span;
                    flights.push(flight);
                } else {
                    answers[flight.shot.index] = flight.query.answer();
                }
            }
            let mut turn = 0;
            while turn < flights.len() {
                if flights[turn].step(self, leaf_test, counters) {
                    let done = flights.swap_remove(turn);
                    answers[done.shot.index] = done.query.answer();
                } else {
                    turn += 1;
                }
            }
        }
    }
}

/// What a ray does in its next turn.
#[derive(Clone, Copy)]
enum Turn {
    /// Looks at the node that was read.
    Node(Packed),
    /// Looks at where the list of a leaf was found to be.
    List(LeafId, (u32, u32)),
    /// Looks at its first id.
    First(LeafId, Slot),
    /// Tests all; what was read of the first is of no use but to have been read.
    Test(LeafId, f32),
}

/// A ray under way.
struct Flight<'a, Q> {
    shot: Shot<'a>,
    ray: KdRay,
    query: Q,
    span: Span,
    at: NodeId,
    turn: Turn,
    todo: Full,
}

impl<'a, Q: Query> Flight<'a, Q> {
    fn new(walk: &Prefetch, shot: Shot<'a>) -> Self {
        let root = walk.layout.root();
        Self {
            ray: KdRay::new(&shot.ray),
            query: Q::new(&shot.ray),
            shot,
            span: Span { enter: 0.0, exit: 0.0 },
            at: root,
            turn: Turn::Node(walk.layout.packed(root)),
            todo: Full::new(0),
        }
    }

    #[inline(always)]
    fn visit<'b, C>(
        &'b mut self,
        base: &'b Base,
        leaf_test: &'b dyn LeafTest<Q, C>,
        counters: &'b mut C,
    ) -> Visit<'b, Q, C> {
        let Self { shot, ray, query, .. } = self;
        Visit { base, shot, ray: *ray, leaf_test, query, counters }
    }

    /// Takes a step; true if the ray is done.
    #[inline(always)]
    fn step<C: Counters>(
        &mut self,
        walk: &Prefetch,
        leaf_test: &dyn LeafTest<Q, C>,
        counters: &mut C,
    ) -> bool {
        match self.turn {
            Turn::Node(packed) => match packed.view(self.at) {
                View::Leaf(leaf) if leaf.is_empty() => {
                    counters.count(Event::Leaf);
                    return self.ends(walk);
                }
                View::Leaf(leaf) => {
                    self.turn = Turn::List(leaf, walk.base.leaves.range(leaf));
                }
                View::Inner { axis, split, children } => {
                    counters.count(Event::InnerNode);
                    let t_split = self.ray.t_split(axis, split);
                    let near = self.ray.near(axis);
                    let far = children[1 - near];
                    self.at = match Crossing::of(t_split, self.span) {
                        Crossing::Far => far,
                        Crossing::Near => children[near],
                        Crossing::Both => {
                            counters.count(Event::Push);
                            self.todo.push(far, self.span.exit);
                            self.span.exit = t_split;
                            children[near]
                        }
                    };
                    self.turn = Turn::Node(walk.layout.packed(self.at));
                }
            },
            Turn::List(leaf, (start, _)) => {
                self.turn = Turn::First(leaf, walk.base.leaves.slot(start));
            }
            Turn::First(leaf, first) => {
                self.turn = Turn::Test(leaf, walk.base.leaves.corners(first)[0][0]);
            }
            Turn::Test(leaf, read) => {
                std::hint::black_box(read);
                let exit = self.span.exit;
                return self.visit(&walk.base, leaf_test, counters).leaf_ends(leaf, exit)
                    || self.ends(walk);
            }
        }
        false
    }

    /// Goes on with what was put aside last; true if there is nothing, or nothing that matters.
    #[inline(always)]
    fn ends(&mut self, walk: &Prefetch) -> bool {
        let Some((far, exit)) = self.todo.pop() else { return true };
        (self.at, self.span) = (far, Span { enter: self.span.exit, exit });
        self.turn = Turn::Node(walk.layout.packed(far));
        self.query.t_max() < self.span.enter
    }
}

impl Traverse for Prefetch {
    type Scratch = robust::Todo;

    fn scratch(&self) -> robust::Todo {
        robust::Todo::default()
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        shot: &Shot<'_>,
        query: &mut Q,
        scratch: &mut robust::Todo,
        counters: &mut C,
    ) {
        // A ray by itself: what a slice of one would do, into the caller's query.
        let (base, ray) = (&*self.base, KdRay::new(&shot.ray));
        let visit = &mut Visit { base, shot, ray, leaf_test: &With(simd), query, counters };
        robust::walk(&self.layout, visit, scratch);
    }

    #[inline(always)]
    fn shoot<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut robust::Todo,
        counters: &mut C,
    ) {
        self.shoot_all::<Q, C>(&With(simd), batch, answers, scratch, counters);
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.layout.bytes())];
        parts.extend(self.base.leaves.memory());
        MemoryReport::new(parts)
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}
