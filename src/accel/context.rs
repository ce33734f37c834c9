//! What a traversal carries along: for one ray, and for a slice of rays.
//!
//! Both are taken apart by the optimiser where all that takes them is `#[inline(always)]`: then
//! each part is in a register, as if it stood in the signature by itself. What is not inlined is
//! handed a context of its own ([`RayContext::reborrow`]), so that the caller's need not lie in
//! memory.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::query::ask_of;
use super::{Batch, BlockFilter, ClosestHit, Counters, Event, PreparedRay, Query, Verdict};
use crate::geom::{BlockRef, Corners, Triangle, intersect_triangle};
use crate::math::{PrimId, TriangleId, Vec3};
use crate::simd::{Vectors, Width, baseline};

/// A ray on its way through a structure.
pub struct RayContext<'a, S, Q, C> {
    /// The instruction set to walk with.
    pub simd: S,
    /// The ray.
    pub ray: &'a PreparedRay<'a>,
    /// Who says what is hit, if not the exact test of the ray itself. Not a part of the ray: a walk
    /// that has none is compiled without it.
    pub verdict: Option<&'a dyn Verdict>,
    /// The question, with the best answer so far.
    pub query: &'a mut Q,
    /// What is counted.
    pub counters: &'a mut C,
}

impl<S: Simd, Q: Query, C: Counters> RayContext<'_, S, Q, C> {
    /// The same context, for a function that is not inlined, at the baseline instruction set.
    #[inline(always)]
    pub fn reborrow(&mut self) -> RayContext<'_, impl Simd, Q, C> {
        let (query, counters) = (&mut *self.query, &mut *self.counters);
        RayContext { simd: baseline(), ray: self.ray, verdict: self.verdict, query, counters }
    }

    /// Asks the exact test about one triangle and offers the hit it finds; `Break` if the answer is
    /// final.
    #[inline(always)]
    pub fn test_triangle(&mut self, id: PrimId, triangle: &impl Corners) -> ControlFlow<()> {
        self.counters.count(Event::ExactTest);
        if let Some(verdict) = self.verdict {
            return self.reborrow().judge(verdict, (id, triangle));
        }
        match intersect_triangle(self.simd, &self.ray.slab, &self.ray.shear, triangle) {
            Some([t, u, v]) => {
                let triangle = TriangleId::unplaced(id);
                self.query.offer(&self.ray.criteria(), ClosestHit { t, u, v, triangle })
            }
            None => ControlFlow::Continue(()),
        }
    }

    /// Asks another than the exact test about one primitive. Kept out of the walks: with it in
    /// them, rays that have no verdict take a tenth longer.
    #[cold]
    #[inline(never)]
    fn judge(
        &mut self,
        verdict: &dyn Verdict,
        (id, triangle): (PrimId, &impl Corners),
    ) -> ControlFlow<()> {
        let [x, y, z] = [0, 1, 2].map(|axis| triangle.along(axis));
        let at = |i: usize| Vec3::new(x[i], y[i], z[i]);
        let corners = Triangle { a: at(0), b: at(1), c: at(2) };
        match verdict.judge(self.ray.index, (id, &corners), &self.query.nearest(), Q::ANY) {
            Some(hit) => self.query.take(hit, verdict.limit(hit.t)),
            None => ControlFlow::Continue(()),
        }
    }

    /// Tests a block: filters all its triangles at once, then asks the exact test about those that
    /// are left.
    #[inline(always)]
    pub fn test_block<const W: usize>(&mut self, block: BlockRef<'_, W>) -> ControlFlow<()>
    where
        Width: Vectors<W>,
    {
        self.counters.count(Event::TriangleTest);
        if C::COUNTS {
            self.counters.add(Event::TriangleLane, block.len() as u64);
        }
        if let Some(verdict) = self.verdict {
            return self.reborrow().judge_block(verdict, block);
        }
        let (simd, ray, t_max) = (self.simd, &self.ray.ray, self.query.t_max());
        let mut lanes =
            block.find_candidates::<S, <Width as Vectors<W>>::Floats<S>>(simd, ray, t_max);
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let id = block.ids[lane];
            if id != PrimId::NONE {
                self.test_triangle(id, &block.lane(lane))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Filters a block as a verdict says, then asks it; at the baseline instruction set, since it
    /// is kept out of the walks as [`Self::judge`] is.
    #[cold]
    #[inline(never)]
    fn judge_block<const W: usize>(
        &mut self,
        verdict: &dyn Verdict,
        block: BlockRef<'_, W>,
    ) -> ControlFlow<()>
    where
        Width: Vectors<W>,
    {
        let mut lanes =
            find_by_verdict(baseline(), &block, (self.ray, self.query.t_max()), verdict.filter());
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let id = block.ids[lane];
            if id != PrimId::NONE {
                self.counters.count(Event::ExactTest);
                self.judge(verdict, (id, &block.lane(lane)))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Asks the exact test about all triangles of a block, unfiltered: small, for rays that are
    /// hardly ever met.
    pub fn test_each<const W: usize>(&mut self, block: BlockRef<'_, W>) -> ControlFlow<()> {
        self.counters.count(Event::TriangleTest);
        for (lane, &id) in block.ids.iter().enumerate().filter(|(_, id)| **id != PrimId::NONE) {
            self.test_triangle(id, &block.lane(lane))?;
        }
        ControlFlow::Continue(())
    }
}

/// The triangles of a block that a verdict is to be asked about.
fn find_by_verdict<S: Simd, const W: usize>(
    simd: S,
    block: &BlockRef<'_, W>,
    (ray, t_max): (&PreparedRay<'_>, f32),
    filter: BlockFilter,
) -> u32
where
    Width: Vectors<W>,
{
    type Floats<S, const W: usize> = <Width as Vectors<W>>::Floats<S>;
    match filter {
        BlockFilter::Near(slack) => {
            block.find_near::<S, Floats<S, W>>(simd, &ray.ray, t_max, slack)
        }
        BlockFilter::Boxes => block.find_boxes::<S, Floats<S, W>>(simd, &ray.slab, t_max),
    }
}

/// A slice of rays on its way through a structure, and the place of its answers.
pub struct SliceContext<'a, S, Q: Query, C> {
    /// The instruction set to walk with.
    pub simd: S,
    /// The rays.
    pub batch: Batch<'a>,
    /// An answer for each ray.
    pub answers: &'a mut [Q::Answer],
    /// What is counted.
    pub counters: &'a mut C,
}

impl<'a, S: Simd, Q: Query, C: Counters> SliceContext<'a, S, Q, C> {
    /// The same context, for a function that is not inlined, at the baseline instruction set.
    #[inline(always)]
    pub fn reborrow(&mut self) -> SliceContext<'_, impl Simd, Q, C> {
        let (answers, counters) = (&mut *self.answers, &mut *self.counters);
        SliceContext { simd: baseline(), batch: self.batch, answers, counters }
    }

    /// Prepares a ray, and asks nothing of it yet.
    #[inline(always)]
    fn begin(&self, index: usize) -> (PreparedRay<'a>, Q) {
        (PreparedRay::of_batch(&self.batch, index), ask_of(&self.batch, index))
    }

    /// Answers one ray by a walk.
    ///
    /// The walk is a closure that stands in the call itself and is `#[inline(always)]`: one that is
    /// handed on by reference would not be compiled for the instruction set.
    #[inline(always)]
    pub fn answer(&mut self, index: usize, walk: impl FnOnce(&mut RayContext<'_, S, Q, C>)) {
        let (ray, mut query) = self.begin(index);
        let (simd, verdict, counters) = (self.simd, self.batch.verdict(), &mut *self.counters);
        walk(&mut RayContext { simd, ray: &ray, verdict, query: &mut query, counters });
        self.answers[index] = query.answer();
    }

    /// Answers all rays by a walk, one after the other; see [`SliceContext::answer`].
    #[inline(always)]
    pub fn answer_each(&mut self, mut walk: impl FnMut(&mut RayContext<'_, S, Q, C>)) {
        for index in 0..self.batch.rays().len() {
            let (ray, mut query) = self.begin(index);
            let (simd, verdict, counters) = (self.simd, self.batch.verdict(), &mut *self.counters);
            walk(&mut RayContext { simd, ray: &ray, verdict, query: &mut query, counters });
            self.answers[index] = query.answer();
        }
    }

    /// Answers all rays as if there were nothing to hit.
    #[inline(always)]
    pub fn answer_nothing(&mut self) {
        for (answer, ray) in self.answers.iter_mut().zip(self.batch.rays()) {
            *answer = Q::new(ray).answer();
        }
    }
}
