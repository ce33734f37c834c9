//! The walk for rays that are not tame: correct from anywhere, at the price of more nodes.
//!
//! It takes each plane's distance from both ends of its rounding error, as the slab test does, and
//! visits a child whenever the ray might be in it: below a plane up to the larger distance, above
//! it from the smaller one (for a ray that goes up). See [`crate::accel::kd`] for why nothing is
//! missed.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::super::layout::{Layout, View};
use super::super::tree::Base;
use super::stack::LEVELS;
use crate::accel::{Counters, Event, Query, Shot, test_triangle};
use crate::geom::own_box;
use crate::math::{NodeId, TriangleId};

/// Nodes for later, with the spans to cross them.
#[derive(Debug)]
pub struct Todo([(NodeId, f32, f32); LEVELS]);

impl Default for Todo {
    fn default() -> Self {
        Self([(NodeId::NONE, 0.0, 0.0); LEVELS])
    }
}

/// Offers everything that could be the nearest hit.
#[inline(always)]
pub fn walk<S: Simd, L: Layout, Q: Query, C: Counters>(
    simd: S,
    base: &Base,
    layout: &L,
    shot: &Shot<'_>,
    query: &mut Q,
    todo: &mut Todo,
    counters: &mut C,
) {
    if base.clipped && !base.slack.is_placed(&shot.ray) {
        // Break and end mean the same here.
        let _ = all(base, shot, query, counters);
        return;
    }
    let slab = &shot.slab;
    let (enter, exit) = slab.interval(&base.bounds);
    let (mut at, mut enter, mut exit) =
        (layout.root(), enter.max(0.0), exit.min(query.t_max() * (1.0 + 4.0 * f32::EPSILON)));
    if enter > exit {
        return;
    }
    let mut pending = 0;
    loop {
        while let View::Inner { axis, split, children } = layout.view(at) {
            counters.count(Event::InnerNode);
            let distance = split - slab.origin[axis];
            let (first, last) = (distance * slab.inv_near[axis], distance * slab.inv_far[axis]);
            let near = slab.negative[axis];
            let into_near = enter <= last;
            let into_far = first <= exit;
            if into_far && into_near {
                todo.0[pending & (LEVELS - 1)] = (children[1 - near], enter.max(first), exit);
                pending += 1;
                counters.count(Event::Push);
            }
            if into_near {
                (at, exit) = (children[near], exit.min(last));
            } else {
                (at, enter) = (children[1 - near], enter.max(first));
            }
        }
        if let View::Leaf(leaf) = layout.view(at)
            && base.leaves.test(simd, leaf, shot, query, counters).is_break()
        {
            return;
        }
        loop {
            if pending == 0 {
                return;
            }
            pending -= 1;
            (at, enter, exit) = todo.0[pending & (LEVELS - 1)];
            if enter <= query.t_max() {
                break;
            }
        }
    }
}

/// Tests all triangles: for rays from so far away that even in double precision a hit point can't
/// be told from its neighbours. Their own boxes stand before the verdict.
#[inline(never)]
fn all<Q: Query, C: Counters>(
    base: &Base,
    shot: &Shot<'_>,
    query: &mut Q,
    counters: &mut C,
) -> ControlFlow<()> {
    for i in 0..base.source.len() {
        let id = TriangleId::from_index(i);
        let triangle = base.source.triangle(id);
        counters.count(Event::BoxTest);
        let (enter, exit) = shot.slab.interval(&own_box(&triangle));
        if enter <= exit && enter <= query.t_max() {
            test_triangle(shot, id, &triangle, query, counters)?;
        }
    }
    ControlFlow::Continue(())
}
