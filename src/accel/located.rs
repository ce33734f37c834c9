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
use crate::math::{InstanceId, PrimId, TriangleId};

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
        if source.is_empty() {
            return;
        }
        // Asked by hand where it can be, which takes a third of the time.
        match source.numbering() {
            Some(numbering) => rename(hits, |prim| numbering.locate(prim)),
            None => rename(hits, |prim| source.locate(prim)),
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

/// Has hits name placements in place of running numbers.
fn rename(hits: &mut [ClosestHit], locate: impl Fn(PrimId) -> TriangleId) {
    for hit in hits {
        // A miss keeps all bits set, by a mask: a branch would be guessed wrong too often.
        let miss = u32::from(hit.triangle.index == TriangleId::NONE.index).wrapping_neg();
        let TriangleId { instance, index } = locate(PrimId(hit.triangle.index & !miss));
        hit.triangle = TriangleId { instance: InstanceId(instance.0 | miss), index: index | miss };
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
