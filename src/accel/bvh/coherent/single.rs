//! Rays one by one over a tree of branches: J. Barczak expects of single rays what he measured of
//! partitioned packets ("An improved multi-level raytracing algorithm", section 4.4).
//!
//! Below the branches the walk is that of `bvh2`.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::super::binary::Node;
use super::Coherent;
use super::place::{Place, Places};
use crate::accel::bvh::binary;
use crate::accel::coherent::{Branches, Hierarchy, Pool, Step, Within};
use crate::accel::{Batch, Counters, Event, PreparedRay, Query};
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
    fn start<S: Simd>(&self, simd: S, rays: &[Ray]) -> Option<Step<Place>> {
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

impl Coherent {
    /// Walks all rays of a slice, each by itself; leaves a list of those that boxes are not good for.
    #[inline(always)]
    pub(super) fn shoot_each<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        each: &EachFrom<'_>,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        (single, steps, pool): (&mut binary::Scratch, &mut Aside, &mut Pool),
        counters: &mut C,
    ) {
        let mut from = None;
        for (index, (ray, answer)) in batch.rays().iter().zip(answers).enumerate() {
            if index % RayBundle::LANES == 0 {
                let end = batch.rays().len().min(index + RayBundle::LANES);
                from = each.start(simd, &batch.rays()[index..end]);
            }
            if !self.knows(ray) {
                pool.leave(index);
                continue;
            }
            let mut query = Q::new(ray);
            if let Some(from) = from {
                let prepared = PreparedRay::new(ray, index, batch.filter());
                let (start, scratch) = ((each, from), (&mut *single, &mut *steps));
                let _final =
                    self.walk_branches(simd, start, &prepared, &mut query, scratch, counters);
            }
            *answer = query.answer();
        }
    }

    /// Walks one ray; `Break` if its answer is final.
    #[inline(always)]
    fn walk_branches<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        (&EachFrom { places, branches, .. }, from): (&EachFrom<'_>, Step<Place>),
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        (single, steps): (&mut binary::Scratch, &mut Aside),
        counters: &mut C,
    ) -> ControlFlow<()> {
        steps.clear();
        steps.push((from, f32::NEG_INFINITY));
        while let Some((mut at, enter)) = steps.pop() {
            if enter > query.t_max() {
                continue;
            }
            while !at.is_plain() {
                let [a, b] = branches.sides(at);
                counters.count(Event::InnerNode);
                counters.count(Event::BoxTest);
                let boxes = Node::of([places.bounds(a.place), places.bounds(b.place)]);
                let [in0, in1, out0, out1] = boxes.intervals(simd, prepared, query.t_max());
                match (in0 <= -out0, in1 <= -out1) {
                    (true, true) => {
                        let (near, far) = if in1 < in0 { (b, a) } else { (a, b) };
                        steps.push((far, larger(in0, in1)));
                        counters.count(Event::Push);
                        at = near;
                    }
                    (true, false) => at = a,
                    (false, true) => at = b,
                    (false, false) => break,
                }
            }
            if at.is_plain() {
                let link = places.link(at.place);
                self.bvh.walk_below(simd, link, prepared, query, single, counters)?;
            }
        }
        ControlFlow::Continue(())
    }
}
