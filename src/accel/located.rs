//! From running numbers to placements.
//!
//! A structure that knows triangles by a running number alone finds hits that have it; callers get
//! hits that name placement and triangle. Both are ordered alike, so the winner is the same.

use std::sync::Arc;

use fearless_simd::Level;

use super::{
    Accel, AnyHit, Batch, BuildReport, ClosestHit, Counts, HitFilter, MemoryReport, Regions, Tracer,
};
use crate::geom::TriangleSource;
use crate::math::PrimId;

/// A structure whose hits are made to name placements.
pub struct Located {
    /// The structure.
    pub accel: Box<dyn Accel>,
    /// What it was built over.
    pub source: Arc<dyn TriangleSource>,
}

impl Located {
    fn wrap<'a>(&'a self, tracer: Box<dyn Tracer + 'a>) -> Box<dyn Tracer + 'a> {
        Box::new(LocatedTracer { tracer, source: &*self.source })
    }
}

impl Accel for Located {
    fn tracer(&self) -> Box<dyn Tracer + '_> {
        self.wrap(self.accel.tracer())
    }

    fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
        self.wrap(self.accel.counting_tracer())
    }

    fn level(&self) -> Level {
        self.accel.level()
    }

    fn memory(&self) -> MemoryReport {
        self.accel.memory()
    }

    fn report(&self) -> &BuildReport {
        self.accel.report()
    }
}

struct LocatedTracer<'a> {
    tracer: Box<dyn Tracer + 'a>,
    source: &'a dyn TriangleSource,
}

impl Tracer for LocatedTracer<'_> {
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        let source = self.source;
        let filter = batch.filter().map(|filter| LocatedFilter { filter, source });
        let filter = filter.as_ref().map(|filter| filter as &dyn HitFilter);
        self.tracer.closest_hits(&batch.with_filter(filter), hits);
        for hit in hits.iter_mut().filter(|hit| hit.is_hit()) {
            hit.triangle = source.locate(PrimId(hit.triangle.index));
        }
    }

    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        let source = self.source;
        let filter = batch.filter().map(|filter| LocatedFilter { filter, source });
        let filter = filter.as_ref().map(|filter| filter as &dyn HitFilter);
        self.tracer.any_hits(&batch.with_filter(filter), hits);
    }

    fn regions(&mut self) -> Option<Box<dyn Regions + '_>> {
        self.tracer.regions()
    }

    fn counts(&self) -> Counts {
        self.tracer.counts()
    }
}

/// A caller's filter, which is asked about placements.
struct LocatedFilter<'a> {
    filter: &'a dyn HitFilter,
    source: &'a dyn TriangleSource,
}

impl HitFilter for LocatedFilter<'_> {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        let triangle = self.source.locate(PrimId(hit.triangle.index));
        self.filter.accepts(ray, &ClosestHit { triangle, ..*hit })
    }
}
