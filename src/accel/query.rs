//! Closest hit or any hit: what is asked of a ray, and which hits count.

use std::ops::ControlFlow;

use super::{AnyHit, ClosestHit, HitFilter};
use crate::geom::{ShearRay, SlabRay};
use crate::math::Ray;

/// A ray of a batch with all that its tests need.
#[derive(Clone, Copy)]
pub struct PreparedRay<'a> {
    /// The ray.
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
        Self { ray: *ray, slab: SlabRay::new(ray), shear: ShearRay::new(ray), index, filter }
    }

    /// What its hits must meet.
    #[inline(always)]
    pub fn criteria(&self) -> HitCriteria<'a> {
        HitCriteria { t_min: self.ray.t_min(), index: self.index, filter: self.filter }
    }
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

impl HitCriteria<'_> {
    #[inline(always)]
    fn accepts(&self, hit: &ClosestHit) -> bool {
        self.filter.is_none_or(|filter| filter.accepts(self.index, hit))
    }
}

/// A question to a ray, with the best answer so far.
pub trait Query: Copy {
    /// What the caller gets.
    type Answer: Copy + Send;

    /// Whether any hit will do, so that order does not matter.
    const ANY: bool;

    /// Nothing found yet.
    fn new(ray: &Ray) -> Self;

    /// Hits beyond this can't change the answer; equal ones can.
    fn t_max(&self) -> f32;

    /// Considers a hit; `Break` if the answer is final.
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()>;

    /// The answer.
    fn answer(&self) -> Self::Answer;
}

/// The smallest `(t, id)`.
#[derive(Clone, Copy, Debug)]
pub struct Closest {
    /// The best so far; until there is one its `t` is the ray's limit.
    best: ClosestHit,
}

impl Query for Closest {
    type Answer = ClosestHit;
    const ANY: bool = false;

    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self { best: ClosestHit { t: ray.t_max(), ..ClosestHit::MISS } }
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.best.t
    }

    #[inline(always)]
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()> {
        let best = &self.best;
        let better = hit.t < best.t || (hit.t == best.t && hit.triangle < best.triangle);
        if better && hit.t > criteria.t_min && criteria.accepts(&hit) {
            self.best = hit;
        }
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
    t_max: f32,
    found: bool,
}

impl Query for Any {
    type Answer = AnyHit;
    const ANY: bool = true;

    #[inline(always)]
    fn new(ray: &Ray) -> Self {
        Self { t_max: ray.t_max(), found: false }
    }

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.t_max
    }

    #[inline(always)]
    fn offer(&mut self, criteria: &HitCriteria<'_>, hit: ClosestHit) -> ControlFlow<()> {
        if hit.t > criteria.t_min && hit.t <= self.t_max && criteria.accepts(&hit) {
            self.found = true;
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    #[inline(always)]
    fn answer(&self) -> AnyHit {
        AnyHit(self.found)
    }
}
