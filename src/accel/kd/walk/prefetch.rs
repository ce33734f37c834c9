//! Several rays in flight: one step each in turn, so that one ray's cache misses pass while others
//! compute.
//!
//! - C. Benthin et al., "Ray tracing on the Cell processor", 2006 ("software hyperthreading");
//!   J. Bittner et al., "Adaptive global visibility sampling", 2009; section 6.4 of the review.
//!
//! A turn goes on as long as the next node lies beside the last: half of them do, since the child
//! below a plane follows its parent. Then memory is asked for the node that is next, and the others
//! have their turns. A leaf with triangles takes four: its node, the place of its list, the list,
//! and the triangles' vertices. To read ahead into the ray's state, without an instruction that
//! asks, is no substitute: a read that waits holds back all that comes after it.

use std::sync::Arc;

use fearless_simd::{Level, Simd};

use super::super::layout::{Compact, Layout, Nodes, View};
use super::super::ray::{Crossing, KdRay, Span};
use super::super::tree::{Base, KdTree, LeafId};
use super::todo::{Full, Todo};
use super::{LeafTest, Visit, With, robust};
use crate::accel::{
    Batch, BuildError, BuildReport, Counters, Event, MemoryReport, PreparedRay, Query, Traverse,
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
        let mut waiting = Waiting { walk: self, batch, next: 0 };
        let mut flights: Vec<Flight<'_, Q>> = Vec::with_capacity(self.rays);
        while flights.len() < self.rays
            && let Some(prepared) = waiting.take(leaf_test, answers, robust, counters)
        {
            flights.push(Flight::new(self, prepared));
        }
        while !flights.is_empty() {
            let mut turn = 0;
            while let Some(flight) = flights.get_mut(turn) {
                if !flight.step(self, leaf_test, counters) {
                    turn += 1;
                    continue;
                }
                answers[flight.prepared.index] = flight.query.answer();
                match waiting.take(leaf_test, answers, robust, counters) {
                    Some(prepared) => flight.restart(self, prepared),
                    None => drop(flights.swap_remove(turn)),
                }
            }
        }
    }
}

/// The rays of a slice that are not under way yet.
struct Waiting<'a> {
    walk: &'a Prefetch,
    batch: &'a Batch<'a>,
    next: usize,
}

impl<'a> Waiting<'a> {
    /// The next ray that crosses the tree, and where; those before it are answered.
    #[inline(always)]
    fn take<Q: Query, C: Counters>(
        &mut self,
        leaf_test: &dyn LeafTest<Q, C>,
        answers: &mut [Q::Answer],
        robust: &mut robust::Todo,
        counters: &mut C,
    ) -> Option<(PreparedRay<'a>, KdRay, Span)> {
        let base = &*self.walk.base;
        loop {
            let index = self.next;
            let ray = self.batch.rays().get(index)?;
            self.next += 1;
            let prepared = PreparedRay::new(ray, index, self.batch.filter());
            let (mut query, kd_ray) = (Q::new(ray), KdRay::new(ray));
            let mut visit = Visit {
                base,
                prepared: &prepared,
                ray: kd_ray,
                leaf_test,
                query: &mut query,
                counters,
            };
            if !base.slack.is_tame(ray) {
                robust::walk(&self.walk.layout, &mut visit, robust);
            } else if let Some(span) = visit.span() {
                return Some((prepared, kd_ray, span));
            }
            answers[index] = query.answer();
        }
    }
}

/// What a ray does in its next turn, with memory that was asked for.
#[derive(Clone, Copy)]
enum Turn {
    /// Looks at its node.
    Node,
    /// Looks at where the list of a leaf is.
    List(LeafId),
    /// Looks at the list.
    Ids(LeafId),
    /// Tests all.
    Test(LeafId),
}

/// A ray under way.
struct Flight<'a, Q> {
    prepared: PreparedRay<'a>,
    ray: KdRay,
    query: Q,
    span: Span,
    at: NodeId,
    turn: Turn,
    todo: Full,
}

impl<'a, Q: Query> Flight<'a, Q> {
    fn new(walk: &Prefetch, (prepared, ray, span): (PreparedRay<'a>, KdRay, Span)) -> Self {
        Self {
            query: Q::new(&prepared.ray),
            prepared,
            ray,
            span,
            at: walk.layout.root(),
            turn: Turn::Node,
            todo: Full::new(0),
        }
    }

    /// Takes another ray in place of one that is done.
    #[inline(always)]
    fn restart(&mut self, walk: &Prefetch, (prepared, ray, span): (PreparedRay<'a>, KdRay, Span)) {
        self.query = Q::new(&prepared.ray);
        (self.prepared, self.ray, self.span, self.at) = (prepared, ray, span, walk.layout.root());
        self.turn = Turn::Node;
        self.todo.clear();
    }

    /// Takes a turn; true if the ray is done.
    #[inline(always)]
    fn step<C: Counters>(
        &mut self,
        walk: &Prefetch,
        leaf_test: &dyn LeafTest<Q, C>,
        counters: &mut C,
    ) -> bool {
        let leaves = &walk.base.leaves;
        match self.turn {
            Turn::Node => return self.descend(walk, counters),
            Turn::List(leaf) => {
                leaves.ask_for_list(leaf);
                self.turn = Turn::Ids(leaf);
            }
            Turn::Ids(leaf) => {
                leaves.ask_for_triangles(leaf);
                self.turn = Turn::Test(leaf);
            }
            Turn::Test(leaf) => {
                let Self { prepared, ray, query, .. } = self;
                let base = &*walk.base;
                let mut visit = Visit { base, prepared, ray: *ray, leaf_test, query, counters };
                if visit.leaf_ends(leaf, self.span.exit) || self.ends() {
                    return true;
                }
                walk.layout.ask_for(self.at);
                self.turn = Turn::Node;
            }
        }
        false
    }

    /// Goes down and across as far as memory is at hand; true if the ray is done.
    #[inline(always)]
    fn descend<C: Counters>(&mut self, walk: &Prefetch, counters: &mut C) -> bool {
        loop {
            let from = self.at;
            match walk.layout.view(from) {
                View::Leaf(leaf) if leaf.is_empty() => {
                    counters.count(Event::Leaf);
                    if self.ends() {
                        return true;
                    }
                }
                View::Leaf(leaf) => {
                    walk.base.leaves.ask_for_range(leaf);
                    self.turn = Turn::List(leaf);
                    return false;
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
                }
            }
            if !walk.layout.are_close(from, self.at) {
                walk.layout.ask_for(self.at);
                return false;
            }
        }
    }

    /// Goes on with what was put aside last; true if there is nothing, or nothing that matters.
    #[inline(always)]
    fn ends(&mut self) -> bool {
        let Some((far, exit)) = self.todo.pop() else { return true };
        (self.at, self.span) = (far, Span { enter: self.span.exit, exit });
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
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        scratch: &mut robust::Todo,
        counters: &mut C,
    ) {
        // A ray by itself: what a slice of one would do, into the caller's query.
        let (base, ray) = (&*self.base, KdRay::new(&prepared.ray));
        let visit = &mut Visit { base, prepared, ray, leaf_test: &With(simd), query, counters };
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
