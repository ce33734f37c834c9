//! A slice of rays, sixteen of them in flight.
//!
//! An incoherent ray waits for memory at almost every node. So each ray takes one step in turn and
//! asks for the node or leaf of its next one, which arrives while the others take theirs.
//!
//! What a step decides late, it must not branch on: a branch that is guessed wrong at the end of a
//! step's chain of operations throws away the other rays' work that was begun. So a turn ends with
//! taking a link off the stack and asking for what it leads to, whatever it is; whether it is a
//! leaf, or behind a hit, or the stack's end, is asked at the ray's next turn, when it is long
//! known.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::arena::Stripes;
use super::node;
use super::stack::{Sorting, Stack};
use super::wide_bvh::{RAYS, Scratch, WideBvh};
use crate::accel::bvh::leaves::Fetched;
use crate::accel::bvh::link::Link;
use crate::accel::{Counters, PreparedRay, Query, RayContext, SliceContext, Traverse};
use crate::math::Ray;
use crate::simd::order::key_limit;
use crate::simd::{Vectors, Width, is_wide};

/// Slices of fewer are walked ray by ray.
const FEW: usize = 4;

/// Whether a slice is worth it: rays that run alike find their nodes in the cache anyway.
#[inline]
fn pays(rays: &[Ray]) -> bool {
    if rays.len() < FEW {
        return false;
    }
    const PAIRS: usize = 16;
    let stride = (rays.len() / PAIRS).max(1);
    let (mut alike, mut all) = (0, 0);
    for pair in rays.windows(2).step_by(stride) {
        all += 1;
        alike += usize::from(run_alike(&pair[0], &pair[1]));
    }
    alike * 4 < all * 3
}

/// Same origin, and directions within some two degrees.
fn run_alike(a: &Ray, b: &Ray) -> bool {
    let (da, db) = (a.direction(), b.direction());
    let dot = da.dot(db);
    a.origin() == b.origin()
        && dot > 0.0
        && dot * dot > 0.999 * da.length_squared() * db.length_squared()
}

/// A ray under way.
struct Flight<'a, Q> {
    ray: PreparedRay<'a>,
    query: Q,
    /// Taken off the stack for its next turn.
    key: u32,
    link: Link,
    top: usize,
    /// Which of the tracer's stacks is its own.
    stack: usize,
}

impl<const W: usize> WideBvh<W>
where
    Width: Vectors<W>,
{
    /// Traces a slice whose hits the exact test says.
    #[inline(always)]
    fn fly<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch<W>,
    ) {
        let Some(root) = self.root else { return slice.answer_nothing() };
        let (simd, rays, stripes) = (slice.simd, slice.batch.rays(), self.arena.stripes());
        let batch = slice.batch;
        let start = |index: usize, stack: usize| {
            let ray = PreparedRay::of_batch(&batch, index);
            Flight { query: Q::new(&ray.ray), ray, key: 1, link: root, top: 1, stack }
        };
        let Scratch { stacks, fetched, .. } = scratch;
        let mut next = rays.len().min(RAYS);
        let mut flights: Vec<Flight<'_, Q>> = (0..next).map(|index| start(index, index)).collect();
        while !flights.is_empty() {
            let mut turn = 0;
            while turn < flights.len() {
                let Flight { ray, query, key, link, top, stack } = &mut flights[turn];
                let own = *stack;
                let stack = &mut stacks[own];
                let limit = key_limit(query.t_max());
                while *key > limit {
                    (*key, *link) = stack.pop(top);
                }
                let ended = *key == 0 || {
                    let counters = &mut *slice.counters;
                    let context = &mut RayContext { simd, ray, verdict: None, query, counters };
                    self.step(context, (stripes, fetched), *link, (stack, top)).is_break()
                };
                if !ended {
                    (*key, *link) = stack.pop(top);
                    stripes.prefetch(*link);
                    turn += 1;
                    continue;
                }
                slice.answers[ray.index] = query.answer();
                if next < rays.len() {
                    flights[turn] = start(next, own);
                    next += 1;
                    turn += 1;
                } else {
                    flights.swap_remove(turn);
                }
            }
        }
    }

    /// Goes one step from `link`: tests a leaf's triangles, or puts the children that the ray
    /// enters on the stack, the nearest on top.
    #[inline(always)]
    fn step<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        (stripes, fetched): (Stripes<'_, W>, &mut Fetched<W>),
        link: Link,
        (stack, top): (&mut Stack<W>, &mut usize),
    ) -> ControlFlow<()> {
        if link.is_leaf() {
            return self.test_leaf(context, stripes, link, fetched);
        }
        let (planes, links) = stripes.node(link);
        let (simd, ray) = (context.simd, context.ray);
        let (keys, hits) =
            node::intersect_children(simd, planes, ray.for_boxes(), context.query.t_max());
        let sorting = if Q::ANY { Sorting::None } else { self.sorting(stripes, link, ray) };
        stack.push(simd, sorting, keys, hits, links, top);
        ControlFlow::Continue(())
    }
}

impl<const W: usize> Traverse for WideBvh<W>
where
    Width: Vectors<W>,
{
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch<W>,
    ) {
        let rays = slice.batch.rays();
        let covered = |ray| self.parts.is_none_or(|parts| parts.covers(ray));
        let in_lanes = is_wide(slice.simd) && !C::COUNTS;
        // Sixteen rays in a row spread too far for dense scenes: half the rate of single rays.
        let is_raster = slice.batch.grid().is_some();
        let is_judged = slice.batch.verdict().is_some();
        if in_lanes && !is_judged && pays(rays) && rays.iter().all(covered) {
            self.fly(slice, scratch);
        } else if in_lanes && self.side_by_side && is_raster && rays.len() >= FEW {
            self.trace_packets(slice, scratch);
        } else {
            slice.answer_each(
                #[inline(always)]
                |context| self.walk(context, scratch),
            );
        }
    }
}
