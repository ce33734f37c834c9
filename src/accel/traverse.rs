//! From a walk written once to the object that callers see.

use fearless_simd::{Level, Simd};

use super::{
    Accel, Any, AnyHit, Batch, BuildReport, Closest, ClosestHit, Counters, Counts, MemoryReport,
    NotCounted, PoolUse, PreparedRay, Query, Tracer,
};
use crate::geom::Shaft;

/// A structure that rays walk through.
///
/// Generic over instruction set, question and counters; [`Accel`] follows for every implementor.
/// Everything below [`Traverse::shoot`] down to the vector instructions must be
/// `#[inline(always)]`, or each of them becomes a call.
pub trait Traverse: Send + Sync {
    /// What a thread needs to walk: stacks, caches.
    type Scratch: Send;

    /// Fresh scratch for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Finds the answer for one ray.
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        prepared: &PreparedRay<'_>,
        query: &mut Q,
        scratch: &mut Self::Scratch,
        counters: &mut C,
    );

    /// Finds the answers for a slice of rays; ray by ray unless a structure knows better.
    #[inline(always)]
    fn shoot<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Self::Scratch,
        counters: &mut C,
    ) {
        self.walk_each::<S, Q, C>(simd, batch, answers, scratch, counters);
    }

    /// Finds the answers for a slice of rays one after the other.
    #[inline(always)]
    fn walk_each<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Self::Scratch,
        counters: &mut C,
    ) {
        for (index, (ray, answer)) in batch.rays().iter().zip(answers).enumerate() {
            let mut query = Q::new(ray);
            let prepared = PreparedRay::new(ray, index, batch.filter());
            self.walk(simd, &prepared, &mut query, scratch, counters);
            *answer = query.answer();
        }
    }

    /// See [`Tracer::enter`].
    fn enter<C: Counters>(&self, _: &Shaft, _: &mut Self::Scratch, _: &mut C) {}

    /// See [`Tracer::leave`].
    fn leave(&self, _: &mut Self::Scratch) {}

    /// See [`Tracer::pool`].
    fn pool(&self, _: &mut Self::Scratch) -> PoolUse {
        PoolUse::default()
    }

    /// See [`Accel::view`].
    fn view(&self, _: &Shaft) -> Option<Box<dyn Accel + '_>> {
        None
    }

    /// The instruction set to walk with, settled when it was built.
    fn level(&self) -> Level;

    /// See [`Accel::memory`].
    fn memory(&self) -> MemoryReport;

    /// See [`Accel::report`].
    fn report(&self) -> &BuildReport;
}

impl<T: Traverse> Accel for T {
    fn tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(Worker { structure: self, scratch: self.scratch(), counters: NotCounted })
    }

    fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(Worker { structure: self, scratch: self.scratch(), counters: Counts::default() })
    }

    fn level(&self) -> Level {
        Traverse::level(self)
    }

    fn view(&self, shaft: &Shaft) -> Option<Box<dyn Accel + '_>> {
        Traverse::view(self, shaft)
    }

    fn memory(&self) -> MemoryReport {
        Traverse::memory(self)
    }

    fn report(&self) -> &BuildReport {
        Traverse::report(self)
    }
}

struct Worker<'a, T: Traverse, C> {
    structure: &'a T,
    scratch: T::Scratch,
    counters: C,
}

/// How a worker gets from its level to code; counted walks exist at one instruction set only.
trait Shoot {
    fn shoot<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]);
}

impl<T: Traverse> Shoot for Worker<'_, T, NotCounted> {
    fn shoot<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]) {
        assert_eq!(batch.rays().len(), answers.len(), "one answer a ray");
        crate::simd::vectorized!(self.structure.level(), simd => self.structure.shoot::<_, Q, _>(
            simd,
            batch,
            answers,
            &mut self.scratch,
            &mut self.counters,
        ));
    }
}

impl<T: Traverse> Shoot for Worker<'_, T, Counts> {
    fn shoot<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]) {
        assert_eq!(batch.rays().len(), answers.len(), "one answer a ray");
        let simd = crate::simd::baseline();
        self.structure.shoot::<_, Q, _>(
            simd,
            batch,
            answers,
            &mut self.scratch,
            &mut self.counters,
        );
    }
}

impl<T: Traverse, C: Counters> Tracer for Worker<'_, T, C>
where
    Self: Shoot,
{
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        self.shoot::<Closest>(batch, hits);
    }

    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        self.shoot::<Any>(batch, hits);
    }

    fn enter(&mut self, region: &Shaft) {
        self.structure.enter(region, &mut self.scratch, &mut self.counters);
    }

    fn leave(&mut self) {
        self.structure.leave(&mut self.scratch);
    }

    fn pool(&mut self) -> PoolUse {
        self.structure.pool(&mut self.scratch)
    }

    fn counts(&self) -> Counts {
        self.counters.counts()
    }
}
