//! From a traversal written once to the object that callers see.

use fearless_simd::{Level, Simd};

use super::{
    Accel, Any, AnyHit, Batch, BuildReport, Closest, ClosestHit, Counters, Counts, MemoryReport,
    NotCounted, Query, RayContext, Regions, SliceContext, Tracer,
};

/// What every structure says of itself, and the memory that a thread needs to trace through it.
pub trait Structure: Send + Sync {
    /// What a thread needs to trace: stacks, caches.
    type Scratch: Send;

    /// Makes scratch for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// What was settled when the structure was built.
    fn built(&self) -> &Built;

    /// See [`Accel::memory`].
    fn memory(&self) -> MemoryReport;
}

/// What is settled when a structure is built, whatever the structure.
#[derive(Clone, Debug)]
pub struct Built {
    /// The instruction set to walk with.
    pub level: Level,
    /// How it was built.
    pub report: BuildReport,
}

/// A structure that slices of rays are traced through.
///
/// Generic over instruction set, question and counters; [`Accel`] follows for every implementor.
/// Everything from [`Traverse::trace`] down to the vector instructions must be `#[inline(always)]`,
/// or each of them becomes a call.
pub trait Traverse: Structure {
    /// Finds the answers for a slice of rays.
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Self::Scratch,
    );

    /// See [`Tracer::regions`].
    fn regions<'a, C: Counters>(
        &'a self,
        _: &'a mut Self::Scratch,
        _: &'a mut C,
    ) -> Option<Box<dyn Regions + 'a>> {
        None
    }
}

/// A structure that rays walk through one by one; [`Traverse`] follows for every implementor.
pub trait WalkRay: Structure {
    /// Finds the answer for one ray; to be `#[inline(always)]`, see [`Traverse`].
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        scratch: &mut Self::Scratch,
    );
}

impl<T: WalkRay> Traverse for T {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Self::Scratch,
    ) {
        slice.answer_each(
            #[inline(always)]
            |context| self.walk(context, scratch),
        );
    }
}

impl<T: Traverse> Accel for T {
    fn tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(Worker { structure: self, scratch: self.scratch(), counters: NotCounted })
    }

    fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(Worker { structure: self, scratch: self.scratch(), counters: Counts::default() })
    }

    fn level(&self) -> Level {
        self.built().level
    }

    fn memory(&self) -> MemoryReport {
        Structure::memory(self)
    }

    fn report(&self) -> &BuildReport {
        &self.built().report
    }
}

struct Worker<'a, T: Traverse, C> {
    structure: &'a T,
    scratch: T::Scratch,
    counters: C,
}

/// How a worker gets from its level to code; counted traversals exist at one instruction set only.
trait TraceSlice {
    fn trace_slice<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]);
}

impl<T: Traverse> TraceSlice for Worker<'_, T, NotCounted> {
    fn trace_slice<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]) {
        assert_eq!(batch.rays().len(), answers.len(), "one answer a ray");
        let Self { structure, scratch, counters } = self;
        crate::simd::vectorized!(structure.built().level, simd => {
            let slice = &mut SliceContext::<_, Q, _> { simd, batch: *batch, answers, counters };
            structure.trace(slice, scratch);
        });
    }
}

impl<T: Traverse> TraceSlice for Worker<'_, T, Counts> {
    fn trace_slice<Q: Query>(&mut self, batch: &Batch<'_>, answers: &mut [Q::Answer]) {
        assert_eq!(batch.rays().len(), answers.len(), "one answer a ray");
        let (simd, counters) = (crate::simd::baseline(), &mut self.counters);
        let slice = &mut SliceContext::<_, Q, _> { simd, batch: *batch, answers, counters };
        self.structure.trace(slice, &mut self.scratch);
    }
}

impl<T: Traverse, C: Counters> Tracer for Worker<'_, T, C>
where
    Self: TraceSlice,
{
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        self.trace_slice::<Closest>(batch, hits);
    }

    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        self.trace_slice::<Any>(batch, hits);
    }

    fn regions(&mut self) -> Option<Box<dyn Regions + '_>> {
        self.structure.regions(&mut self.scratch, &mut self.counters)
    }

    fn counts(&self) -> Counts {
        self.counters.counts()
    }
}
