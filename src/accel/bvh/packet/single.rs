//! Rays one by one over a tree of branches: J. Barczak expects of single rays what he measured of
//! partitioned packets ("An improved multi-level raytracing algorithm", section 4.4).
//!
//! Below the branches the walk is that of `bvh2`.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::packet_bvh::PacketBvh;
use super::place::{Place, Places};
use crate::accel::bvh::binary::{self, Node};
use crate::accel::narrowing::{Branches, Hierarchy, Step, Within};
use crate::accel::packet::RayLists;
use crate::accel::{Counters, Event, Query, RayContext, SliceContext};
use crate::geom::RayBundle;
use crate::math::{Ray, larger};

/// Where the rays of a slice start.
pub struct EachFrom<'a> {
    pub places: Places<'a>,
    pub branches: Branches<'a, Place>,
    /// `None` if they meet no leaf.
    pub from: Option<Step<Place>>,
    /// For which rays; others start at the root.
    pub within: Within,
}

/// Steps put aside, and where the ray enters them.
type Aside = Vec<(Step<Place>, f32)>;

impl EachFrom<'_> {
    /// Where eight rays start, or fewer.
    #[inline(always)]
    fn find_start<S: Simd>(&self, simd: S, rays: &[Ray]) -> Option<Step<Place>> {
        if self.within.is_all() {
            return self.from;
        }
        let mut bundle = RayBundle::EMPTY;
        for (lane, ray) in rays.iter().enumerate() {
            bundle.put(lane, ray);
        }
        if self.within.holds_bundle(simd, &bundle) {
            self.from
        } else {
            Some(Step::to(Place::ROOT))
        }
    }
}

impl PacketBvh {
    /// Walks all rays of a slice, each by itself; leaves a list of those that boxes are not good
    /// for.
    #[inline(always)]
    pub fn trace_each<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        each: &EachFrom<'_>,
        (single, steps, lists): (&mut binary::Scratch, &mut Aside, &mut RayLists),
    ) {
        let (rays, mut from) = (slice.batch.rays(), None);
        for (index, ray) in rays.iter().enumerate() {
            if index % RayBundle::LANES == 0 {
                let end = rays.len().min(index + RayBundle::LANES);
                from = each.find_start(slice.simd, &rays[index..end]);
            }
            if !self.accepts(ray) {
                lists.leave(index);
                continue;
            }
            slice.answer(
                index,
                #[inline(always)]
                |context| {
                    if let Some(from) = from {
                        let scratch = (&mut *single, &mut *steps);
                        let _final = self.walk_branches(context, (each, from), scratch);
                    }
                },
            );
        }
    }

    /// Walks one ray; `Break` if its answer is final.
    #[inline(always)]
    fn walk_branches<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        (&EachFrom { places, branches, .. }, from): (&EachFrom<'_>, Step<Place>),
        (single, steps): (&mut binary::Scratch, &mut Aside),
    ) -> ControlFlow<()> {
        steps.clear();
        steps.push((from, f32::NEG_INFINITY));
        while let Some((mut at, enter)) = steps.pop() {
            if enter > context.query.t_max() {
                continue;
            }
            while !at.is_plain() {
                let [a, b] = branches.sides(at);
                context.counters.count(Event::InnerNode);
                context.counters.count(Event::BoxTest);
                let boxes = Node::of([places.bounds(a.place), places.bounds(b.place)]);
                let t_max = context.query.t_max();
                let [in0, in1, out0, out1] = boxes.intervals(context.simd, context.ray, t_max);
                match (in0 <= -out0, in1 <= -out1) {
                    (true, true) => {
                        let (near, far) = if in1 < in0 { (b, a) } else { (a, b) };
                        steps.push((far, larger(in0, in1)));
                        context.counters.count(Event::Push);
                        at = near;
                    }
                    (true, false) => at = a,
                    (false, true) => at = b,
                    (false, false) => break,
                }
            }
            if at.is_plain() {
                self.bvh.walk_below(context, places.link(at.place), single)?;
            }
        }
        ControlFlow::Continue(())
    }
}
