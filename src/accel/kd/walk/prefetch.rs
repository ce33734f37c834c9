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

use super::robust;
use super::todo::{Full, Todo};
use super::visit::{LeafTest, Visit, With};
use crate::accel::kd::layout::{Compact, Layout, Nodes, View};
use crate::accel::kd::ray::{Crossing, KdRay, Span};
use crate::accel::kd::tree::{Base, KdTree, LeafId};
use crate::accel::query::{ask, ask_of};
use crate::accel::{
    BuildError, Built, Counters, Event, MemoryReport, PreparedRay, Query, SliceContext, Structure,
    Traverse, Verdict,
};
use crate::math::NodeId;

/// Walks with rays in flight.
pub struct Prefetch {
    base: Arc<Base>,
    layout: Compact,
    rays: usize,
    built: Built,
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
            built: Built { level, report: tree.report.clone() },
        })
    }

    /// Traces a slice; compiled once, whatever the instruction set of `leaf_test`.
    #[inline(never)]
    fn trace_slice<Q: Query, C: Counters>(
        &self,
        leaf_test: &dyn LeafTest<Q, C>,
        slice: &mut SliceContext<'_, impl Simd, Q, C>,
        robust: &mut robust::Todo,
    ) {
        let mut waiting = Waiting { walk: self, leaf_test, robust, next: 0 };
        let mut flights: Vec<Flight<'_, Q>> = Vec::with_capacity(self.rays);
        while flights.len() < self.rays
            && let Some(start) = waiting.take(slice)
        {
            flights.push(Flight::new(self, start));
        }
        while !flights.is_empty() {
            let mut turn = 0;
            while let Some(flight) = flights.get_mut(turn) {
                if !flight.step(self, leaf_test, slice.counters) {
                    turn += 1;
                    continue;
                }
                slice.answers[flight.ray.index] = flight.query.answer();
                match waiting.take(slice) {
                    Some(start) => flight.restart(self, start),
                    None => drop(flights.swap_remove(turn)),
                }
            }
        }
    }
}

/// A ray that crosses the tree, who says what it hits, and where it crosses.
type Start<'a> = (PreparedRay<'a>, Option<&'a dyn Verdict>, KdRay, Span);

/// The rays of a slice that are not under way yet.
struct Waiting<'a, Q, C> {
    walk: &'a Prefetch,
    leaf_test: &'a dyn LeafTest<Q, C>,
    robust: &'a mut robust::Todo,
    next: usize,
}

impl<Q: Query, C: Counters> Waiting<'_, Q, C> {
    /// Takes the next ray that crosses the tree; those before it are answered.
    #[inline(always)]
    fn take<'a>(&mut self, slice: &mut SliceContext<'a, impl Simd, Q, C>) -> Option<Start<'a>> {
        let (base, leaf_test) = (&*self.walk.base, self.leaf_test);
        loop {
            let index = self.next;
            let world = slice.batch.rays().get(index)?;
            self.next += 1;
            let prepared = PreparedRay::of_batch(&slice.batch, index);
            let kd_ray = KdRay::new(world);
            let (ray, verdict) = (&prepared, slice.batch.verdict());
            let (query, counters) = (&mut ask_of::<Q>(&slice.batch, index), &mut *slice.counters);
            let mut visit = Visit { base, ray, kd_ray, leaf_test, verdict, query, counters };
            if !base.slack.is_tame(world) {
                robust::walk(&self.walk.layout, &mut visit, self.robust);
            } else if let Some(span) = visit.span() {
                return Some((prepared, verdict, kd_ray, span));
            }
            slice.answers[index] = visit.query.answer();
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
    ray: PreparedRay<'a>,
    kd_ray: KdRay,
    verdict: Option<&'a dyn Verdict>,
    query: Q,
    span: Span,
    at: NodeId,
    turn: Turn,
    todo: Full,
}

impl<'a, Q: Query> Flight<'a, Q> {
    fn new(walk: &Prefetch, (ray, verdict, kd_ray, span): Start<'a>) -> Self {
        Self {
            query: ask(&ray.ray, verdict),
            ray,
            verdict,
            kd_ray,
            span,
            at: walk.layout.root(),
            turn: Turn::Node,
            todo: Full::new(0),
        }
    }

    /// Takes another ray in place of one that is done.
    #[inline(always)]
    fn restart(&mut self, walk: &Prefetch, (ray, verdict, kd_ray, span): Start<'a>) {
        (self.query, self.verdict) = (ask(&ray.ray, verdict), verdict);
        (self.ray, self.kd_ray, self.span, self.at) = (ray, kd_ray, span, walk.layout.root());
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
                leaves.prefetch_list(leaf);
                self.turn = Turn::Ids(leaf);
            }
            Turn::Ids(leaf) => {
                leaves.prefetch_triangles(leaf);
                self.turn = Turn::Test(leaf);
            }
            Turn::Test(leaf) => {
                let Self { ray, kd_ray, verdict, query, .. } = self;
                let (base, kd_ray, verdict) = (&*walk.base, *kd_ray, *verdict);
                let mut visit = Visit { base, ray, kd_ray, leaf_test, verdict, query, counters };
                if visit.ends_in_leaf(leaf, self.span.exit) || self.ends() {
                    return true;
                }
                walk.layout.prefetch(self.at);
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
                    walk.base.leaves.prefetch_range(leaf);
                    self.turn = Turn::List(leaf);
                    return false;
                }
                View::Inner { axis, split, children } => {
                    counters.count(Event::InnerNode);
                    let t_split = self.kd_ray.t_split(axis, split);
                    let near = self.kd_ray.near(axis);
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
                walk.layout.prefetch(self.at);
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

impl Structure for Prefetch {
    type Scratch = robust::Todo;

    fn scratch(&self) -> robust::Todo {
        robust::Todo::default()
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let mut parts = vec![("nodes", self.layout.bytes())];
        parts.extend(self.base.leaves.memory());
        MemoryReport::new(parts)
    }
}

impl Traverse for Prefetch {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut robust::Todo,
    ) {
        let leaf_test = &With(slice.simd);
        self.trace_slice(leaf_test, &mut slice.reborrow(), scratch);
    }
}
