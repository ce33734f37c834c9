//! Closest hit or any hit: what is asked of a ray, and which hits count.

use std::ops::ControlFlow;

use super::{AnyHit, Batch, ClosestHit, HitFilter, Verdict};
use crate::geom::{ShearRay, SlabRay};
use crate::math::Ray;

/// A ray of a batch with all that its tests need.
#[derive(Clone, Copy)]
pub struct PreparedRay<'a> {
    /// The ray, in the structure's own space.
    pub ray: Ray,
    /// For boxes.
    pub slab: SlabRay,
    /// For the exact test.
    pub shear: ShearRay,
    /// Its place in the batch.
    pub index: usize,
    /// The batch's filter.
    pub filter: Option<&'a dyn HitFilter>,
}

impl<'a> PreparedRay<'a> {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: &Ray, index: usize, filter: Option<&'a dyn HitFilter>) -> Self {
        let (slab, shear) = (SlabRay::new(ray), ShearRay::new(ray));
        Self { ray: *ray, slab, shear, index, filter }
    }

    /// Prepares a ray of a batch.
    #[inline(always)]
    pub fn of_batch(batch: &Batch<'a>, index: usize) -> Self {
        Self::new(&batch.rays()[index], index, batch.filter())
    }

    /// What tests of boxes take of it, and where it begins.
    #[inline(always)]
    pub fn for_boxes(&self) -> (&SlabRay, f32) {
        (&self.slab, self.ray.t_min())
    }

    /// What its hits must meet.
    #[inline(always)]
    pub fn criteria(&self) -> HitCriteria<'a> {
        HitCriteria::new(self.ray.t_min(), self.index, self.filter)
    }
}

/// What is asked of a ray whose hits `verdict` says.
#[inline(always)]
pub(super) fn ask<Q: Query>(ray: &Ray, verdict: Option<&dyn Verdict>) -> Q {
    match verdict {
        None => Q::new(ray),
        Some(verdict) => Q::within(limit_of(*ray, verdict), ray.t_max()),
    }
}

/// The greatest `t` that counts for a ray. Handed a copy, so that no ray under way need lie in
/// memory for it: that alone took rays without a verdict a twelfth of their time.
#[cold]
#[inline(never)]
fn limit_of(ray: Ray, verdict: &dyn Verdict) -> f32 {
    verdict.t_max(&ray)
}

/// What is asked of a ray of a batch.
#[inline(always)]
pub(super) fn ask_of<Q: Query>(batch: &Batch<'_>, index: usize) -> Q {
    ask(&batch.rays()[index], batch.verdict())
}

/// What a ray's hits must meet, apart from what was found already.
#[derive(Clone, Copy)]
pub struct HitCriteria<'a> {
    /// They lie beyond this.
    pub t_min: f32,
    /// The ray's place in the batch.
    pub index: usize,
    /// The batch's filter.
    pub filter: Option<&'a dyn HitFilter>,
}

impl<'a> HitCriteria<'a> {
    /// Of a ray of a batch.
    #[inline(always)]
    pub fn new(t_min: f32, index: usize, filter: Option<&'a dyn HitFilter>) -> Self {
        Self { t_min, index, filter }
    }

    /// Whether a hit counts.
    #[inline(always)]
    pub fn accepts(&self, hit: &ClosestHit) -> bool {
        hit.t > self.t_min && self.filter.is_none_or(|filter| filter.accepts(self.index, hit))
    }
}

/// A question to a ray, with the best answer so far.
pub trait Query: Copy {
    /// What the caller gets.
    type Answer: Copy + Send;

    /// Whether any hit will do, so that order does not matter.
    const ANY: bool;

    /// Nothing found yet at or before `t`; boxes that are entered beyond `limit` do not matter.
    fn within(t: f32, limit: f32) -> Self;

    /// Nothing found yet.
    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self::within(ray.t_max(), ray.t_max())
    }

    /// Boxes that are entered beyond this can't change the answer; equal ones can.
    fn t_max(&self) -> f32;

    /// The same, while the structure's measure of distance is another.
    fn set_limit(&mut self, limit: f32);

    /// Considers a hit; `Break` if the answer is final.
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()>;

    /// The best hit so far, or none with the greatest `t` that counts.
    fn nearest(&self) -> ClosestHit;

    /// Takes a better hit that counts.
    fn take(&mut self, hit: ClosestHit, limit: f32) -> ControlFlow<()>;

    /// The answer.
    fn answer(&self) -> Self::Answer;
}

/// The smallest `(t, id)`.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// The best so far; until there is one its `t` is the ray's limit.
    best: ClosestHit,
    limit: f32,
}

impl Query for Closest {
    type Answer = ClosestHit;
    const ANY: bool = false;

    #[inline(always)]
    fn within(t: f32, limit: f32) -> Self {
        Self { best: ClosestHit { t, ..ClosestHit::MISS }, limit }
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn set_limit(&mut self, limit: f32) {
        self.limit = limit;
    }

    #[inline(always)]
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()> {
        if hit.is_before(&self.best) && criteria.accepts(&hit) {
            return self.take(hit, hit.t);
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn nearest(&self) -> ClosestHit {
        self.best
    }

    #[inline(always)]
    fn take(&mut self, hit: ClosestHit, limit: f32) -> ControlFlow<()> {
        (self.best, self.limit) = (hit, limit);
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn answer(&self) -> ClosestHit {
        if self.best.is_hit() { self.best } else { ClosestHit::MISS }
    }
}

/// Whether there is a hit at all.
#[derive(Clone, Copy, Debug)]
pub struct Any {
    /// Hits lie at or before this.
    farthest: f32,
    limit: f32,
    found: bool,
}

impl Query for Any {
    type Answer = AnyHit;
    const ANY: bool = true;

    #[inline(always)]
    fn within(t: f32, limit: f32) -> Self {
        Self { farthest: t, limit, found: false }
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.limit
    }

    #[inline(always)]
    fn set_limit(&mut self, limit: f32) {
        self.limit = limit;
    }

    #[inline(always)]
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()> {
        if hit.t <= self.farthest && criteria.accepts(&hit) {
            return self.take(hit, hit.t);
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn nearest(&self) -> ClosestHit {
        ClosestHit { t: self.farthest, ..ClosestHit::MISS }
    }

    #[inline(always)]
    fn take(&mut self, _: ClosestHit, _: f32) -> ControlFlow<()> {
        self.found = true;
        ControlFlow::Break(())
    }

    #[inline(always)]
    fn answer(&self) -> AnyHit {
        AnyHit(self.found)
    }
}
