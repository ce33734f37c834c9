//! Brute force: every ray against every triangle. The oracle of all other structures.
//!
//! It has no tree and no filter of edges. All that precedes the exact test is the slab test of each
//! triangle's own box, which the exact test makes anyway: here for eight boxes at once, by the same
//! operations in the same order.
//!
//! A slice is shared out among all threads. Within a thread, a group of rays meets a group of boxes
//! that fits the cache before the next group comes.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};
use rayon::prelude::*;

use super::query::ask_of;
use super::{
    Batch, BuildInput, BuildReport, Built, Counters, Event, MemoryReport, PreparedRay, Query,
    RayContext, SliceContext, Structure, Traverse, Variant,
};
use crate::geom::TriangleSource;
use crate::math::PrimId;

/// Its row of the table.
pub const VARIANT: Variant = Variant {
    id: "brute",
    summary: "every ray against every triangle: the oracle",
    paper: "-",
    options: &[],
    build: |input| Ok(Box::new(Brute::build(input))),
};

/// Rays that meet a group of boxes together.
const RAYS: usize = 64;
/// Blocks of boxes in a group: 96 KiB.
const BLOCKS: usize = 512;

/// Eight boxes, planes by axis: three lower ones, then three upper ones.
#[derive(Clone, Copy)]
#[repr(C, align(32))]
struct Boxes([[f32; 8]; 6]);

/// All triangles' boxes in order.
pub struct Brute {
    source: Arc<dyn TriangleSource>,
    boxes: Vec<Boxes>,
    built: Built,
}

impl Brute {
    fn build(input: &BuildInput<'_>) -> Self {
        let start = Instant::now();
        let count = input.source.len();
        let boxes =
            (0..count.div_ceil(8)).into_par_iter().map(|i| pack(&*input.source, i)).collect();
        let report = BuildReport {
            phases: vec![("boxes", start.elapsed().as_secs_f64())],
            triangles: count,
            leaves: 1,
            mean_leaf: count as f64,
            sah_cost: count as f64,
            ..BuildReport::default()
        };
        Self {
            source: Arc::clone(&input.source),
            boxes,
            built: Built { level: input.level, report },
        }
    }

    /// Tests blocks `first..first + blocks.len()` of boxes.
    #[inline(always)]
    fn test_blocks<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        first: usize,
        blocks: &[Boxes],
    ) -> ControlFlow<()> {
        for (i, boxes) in blocks.iter().enumerate() {
            context.counters.count(Event::BoxTest);
            let mut lanes = boxes.enter(context.simd, context.ray, context.query.t_max());
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize;
                lanes &= lanes - 1;
                let id = PrimId::from_index((first + i) * 8 + lane);
                context.counters.count(Event::TriangleTest);
                context.test_triangle(id, &self.source.triangle(id))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Answers rays, the first of which is number `from` of the batch.
    #[inline(always)]
    fn trace_group<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        from: usize,
    ) {
        let (simd, verdict) = (slice.simd, slice.batch.verdict());
        let prepare = |i| {
            let prepared = PreparedRay::of_batch(&slice.batch, i);
            PreparedRay { index: from + i, ..prepared }
        };
        let count = slice.batch.rays().len();
        let rays: Vec<PreparedRay<'_>> = (0..count).map(prepare).collect();
        let mut queries: Vec<(Q, bool)> =
            (0..count).map(|i| (ask_of(&slice.batch, i), false)).collect();
        for (group, blocks) in self.boxes.chunks(BLOCKS).enumerate() {
            for (ray, (query, done)) in rays.iter().zip(&mut queries) {
                if !*done {
                    let counters = &mut *slice.counters;
                    let context = &mut RayContext { simd, ray, verdict, query, counters };
                    *done = self.test_blocks(context, group * BLOCKS, blocks).is_break();
                }
            }
        }
        for ((query, _), answer) in queries.iter().zip(&mut *slice.answers) {
            *answer = query.answer();
        }
    }
}

fn pack(source: &dyn TriangleSource, block: usize) -> Boxes {
    // Unused places hold a box that no interval enters.
    let mut planes = [[f32::INFINITY; 8]; 6];
    planes[3..].fill([f32::NEG_INFINITY; 8]);
    let first = block * 8;
    for lane in 0..8.min(source.len() - first) {
        let bounds = source.own_box(PrimId::from_index(first + lane));
        for axis in 0..3 {
            planes[axis][lane] = bounds.min[axis];
            planes[3 + axis][lane] = bounds.max[axis];
        }
    }
    Boxes(planes)
}

impl Boxes {
    /// Bit `i` is set if the ray enters box `i` at or before `t_max`.
    #[inline(always)]
    fn enter<S: Simd>(&self, simd: S, prepared: &PreparedRay<'_>, t_max: f32) -> u32 {
        let slab = &prepared.slab;
        let plane = |axis: usize, upper: usize, inverse: f32| {
            let planes = f32x8::load_array_ref(simd, &self.0[upper * 3 + axis]);
            (planes - slab.origin[axis]) * inverse
        };
        let near = |axis| plane(axis, slab.negative[axis], slab.inv_near[axis]);
        let far = |axis| plane(axis, 1 - slab.negative[axis], slab.inv_far[axis]);
        let enter = near(0).max(near(1)).max(near(2));
        let exit = far(0).min(far(1)).min(far(2)).min(t_max);
        enter.simd_le(exit).to_bitmask() as u32
    }
}

impl Structure for Brute {
    type Scratch = ();

    fn scratch(&self) {}

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        MemoryReport::new([("boxes", size_of_val(&*self.boxes))])
    }
}

impl Traverse for Brute {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        (): &mut (),
    ) {
        if slice.batch.verdict().is_some() {
            return self.trace_group(slice, 0);
        }
        // A closure that rayon runs elsewhere is not compiled for this instruction set, so each
        // group finds its way to it anew.
        let (rays, filter) = (slice.batch.rays(), slice.batch.filter());
        let groups = rays.par_chunks(RAYS).zip(slice.answers.par_chunks_mut(RAYS)).enumerate();
        let counts: Vec<C> = groups
            .map(|(group, (rays, answers))| {
                let mut counters = C::default();
                let batch = Batch::new(rays).with_filter(filter);
                crate::simd::vectorized!(self.built.level, simd => {
                    let counters = &mut counters;
                    let slice = &mut SliceContext::<_, Q, _> { simd, batch, answers, counters };
                    self.trace_group(slice, group * RAYS);
                });
                counters
            })
            .collect();
        for counted in counts {
            let counted = counted.counts();
            for event in Event::ALL {
                slice.counters.add(event, counted[event]);
            }
        }
    }
}
