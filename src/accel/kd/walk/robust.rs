//! The walk for rays that are not tame: correct from anywhere, at the price of more nodes.
//!
//! It takes each plane's distance from both ends of its rounding error, as the slab test does, and
//! visits a child whenever the ray might be in it: in front of a plane up to the larger distance,
//! behind it from the smaller one on. See [`crate::accel::kd`] for why nothing is missed.

use std::ops::ControlFlow;

use super::todo::LEVELS;
use super::visit::Visit;
use crate::accel::kd::layout::{Nodes, View};
use crate::accel::{Counters, Event, Query, RayContext};
use crate::math::{NodeId, PrimId, larger, smaller};
use crate::simd::baseline;

/// Nodes for later, with the spans to cross them.
#[derive(Debug)]
pub struct Todo([(NodeId, f32, f32); LEVELS]);

impl Default for Todo {
    fn default() -> Self {
        Self([(NodeId::NONE, 0.0, 0.0); LEVELS])
    }
}

/// Offers everything that could be the nearest hit.
#[inline(never)]
pub fn walk<Q: Query, C: Counters>(
    nodes: &dyn Nodes,
    visit: &mut Visit<'_, Q, C>,
    todo: &mut Todo,
) {
    if !visit.base.slack.is_placed(&visit.ray.ray) {
        // Break and end mean the same here.
        let _ = test_all(visit);
        return;
    }
    /// A limit counts from the hit's true distance, before it was rounded.
    const ROUNDING: f32 = 1.0 + 4.0 * f32::EPSILON;
    let slab = &visit.ray.slab;
    let (enter, exit) = slab.interval(&visit.base.bounds);
    let (mut at, mut enter, mut exit) =
        (nodes.root(), larger(enter, 0.0), smaller(exit, visit.query.t_max() * ROUNDING));
    if enter > exit {
        return;
    }
    let mut pending = 0;
    loop {
        let leaf = loop {
            let (axis, split, children) = match nodes.view(at) {
                View::Inner { axis, split, children } => (axis, split, children),
                View::Leaf(leaf) => break leaf,
            };
            visit.counters.count(Event::InnerNode);
            let distance = split - slab.origin[axis];
            let (first, last) = (distance * slab.inv_near[axis], distance * slab.inv_far[axis]);
            let near = slab.negative[axis];
            let (into_near, into_far) = (enter <= last, first <= exit);
            if into_far && into_near {
                todo.0[pending & (LEVELS - 1)] = (children[1 - near], larger(enter, first), exit);
                pending += 1;
                visit.counters.count(Event::Push);
            }
            if into_near {
                (at, exit) = (children[near], smaller(exit, last));
            } else {
                (at, enter) = (children[1 - near], larger(enter, first));
            }
        };
        if visit.test_leaf(leaf) {
            return;
        }
        loop {
            if pending == 0 {
                return;
            }
            pending -= 1;
            (at, enter, exit) = todo.0[pending & (LEVELS - 1)];
            if enter <= visit.query.t_max() {
                break;
            }
        }
    }
}

/// Tests all triangles: for rays from so far away that even in double precision a hit point can't
/// be told from its neighbours. Their own boxes stand before the exact test.
fn test_all<Q: Query, C: Counters>(visit: &mut Visit<'_, Q, C>) -> ControlFlow<()> {
    let source = &*visit.base.source;
    for i in 0..source.len() {
        let id = PrimId::from_index(i);
        let triangle = source.triangle(id);
        visit.counters.count(Event::BoxTest);
        let (enter, exit) = visit.ray.slab.interval(&source.own_box(id));
        if enter <= exit && enter <= visit.query.t_max() {
            let Visit { ray, verdict, query, counters, .. } = visit;
            let (verdict, query, counters) = (*verdict, &mut **query, &mut **counters);
            RayContext { simd: baseline(), ray, verdict, query, counters }
                .test_triangle(id, &triangle)?;
        }
    }
    ControlFlow::Continue(())
}
