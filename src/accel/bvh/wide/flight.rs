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

use super::arena::Rows;
use super::stack::{Sorting, Stack};
use super::{Scratch, Wide, node};
use crate::accel::bvh::leaves::Fetched;
use crate::accel::bvh::link::Link;
use crate::accel::{Batch, Counters, PreparedRay, Query};
use crate::math::Ray;
use crate::simd::order::key_limit;
use crate::simd::{Lanes, Vectors};

/// Rays in flight; 12 to 32 are equal.
pub const RAYS: usize = 16;
/// Slices of fewer are walked ray by ray.
const FEW: usize = 4;

/// Whether a slice is worth it: rays that run alike find their nodes in the cache anyway.
#[inline]
pub fn pays(rays: &[Ray]) -> bool {
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
    prepared: PreparedRay<'a>,
    query: Q,
    /// Taken off the stack for its next turn.
    key: u32,
    link: Link,
    top: usize,
    /// Which of the tracer's stacks is its own.
    stack: usize,
}

impl<const W: usize> Wide<W>
where
    Lanes: Vectors<W>,
{
    /// Shoots a slice.
    #[inline(always)]
    pub(super) fn fly<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Scratch<W>,
        counters: &mut C,
    ) {
        let Some(root) = self.root else {
            return batch.rays().iter().zip(answers).for_each(|(r, a)| *a = Q::new(r).answer());
        };
        let (rays, rows) = (batch.rays(), self.arena.rows());
        let start = |index: usize, stack: usize| Flight {
            prepared: PreparedRay::new(&rays[index], index, batch.filter()),
            query: Q::new(&rays[index]),
            key: 1,
            link: root,
            top: 1,
            stack,
        };
        let Scratch { stacks, fetched } = scratch;
        let mut next = rays.len().min(RAYS);
        let mut flights: Vec<Flight<'_, Q>> = (0..next).map(|index| start(index, index)).collect();
        while !flights.is_empty() {
            let mut turn = 0;
            while turn < flights.len() {
                let Flight { prepared, query, key, link, top, stack } = &mut flights[turn];
                let own = *stack;
                let stack = &mut stacks[own];
                let limit = key_limit(query.t_max());
                while *key > limit {
                    (*key, *link) = stack.pop(top);
                }
                let ended = *key == 0 || {
                    let step = (simd, rows, &mut *fetched, &mut *counters);
                    self.step(step, prepared, query, *link, (stack, top)).is_break()
                };
                if !ended {
                    (*key, *link) = stack.pop(top);
                    rows.prefetch(*link);
                    turn += 1;
                    continue;
                }
                answers[prepared.index] = query.answer();
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
        (simd, rows, fetched, counters): (S, Rows<'_, W>, &mut Fetched<W>, &mut C),
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        link: Link,
        (stack, top): (&mut Stack<W>, &mut usize),
    ) -> ControlFlow<()> {
        if link.is_leaf() {
            return self.test_leaf(simd, rows, prepared, query, link, fetched, counters);
        }
        let (planes, links) = rows.node(link);
        let (keys, hits) = node::enter(simd, planes, prepared, query.t_max());
        let sorting = if Q::ANY { Sorting::None } else { self.sorting(rows, link, prepared) };
        stack.push(simd, sorting, keys, hits, links, top);
        ControlFlow::Continue(())
    }
}
