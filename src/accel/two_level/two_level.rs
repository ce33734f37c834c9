//! A structure over placements, and one of each mesh that is placed.

use std::cell::RefCell;
use std::sync::Arc;

use fearless_simd::Level;
use rayon::prelude::*;

use super::levels::Levels;
use super::sources::Placed;
use super::verdict::Above;
use crate::accel::located::Located;
use crate::accel::{
    Accel, AnyHit, Batch, BuildError, BuildInput, BuildReport, ClosestHit, Counts, MemoryReport,
    Options, Phases, Tracer, Variant,
};
use crate::geom::TriangleSource;
use crate::math::Ray;

/// A row of the table with its options.
pub type Row<'a> = (&'static Variant, &'a Options);

/// Two levels of any two rows of the table.
pub struct TwoLevel {
    levels: Levels,
    flat: Option<Located>,
    above: Option<Box<dyn Accel>>,
    below: Vec<Option<Box<dyn Accel>>>,
    level: Level,
    report: BuildReport,
}

impl TwoLevel {
    /// Builds all structures, those of meshes side by side: `below` for these and for what is
    /// flattened, `above` for placements.
    pub fn build(
        placed: Placed,
        (below, above): (Row<'_>, Row<'_>),
        level: Level,
    ) -> Result<Self, BuildError> {
        let mut phases = Phases::start();
        let levels = Levels::new(placed, &mut phases);
        let build = |(variant, options): Row<'_>, source: Arc<dyn TriangleSource>| {
            (variant.build)(&BuildInput { source, options, level })
        };
        let of_mesh = |mesh| levels.mesh(mesh).map(|mesh| build(below, Arc::new(mesh))).transpose();
        let of_meshes = (0..levels.meshes.len()).into_par_iter().map(of_mesh);
        let of_meshes: Vec<Option<Box<dyn Accel>>> = of_meshes.collect::<Result<_, _>>()?;
        phases.end("meshes");
        let flat = match levels.flat() {
            Some(flat) => {
                let source: Arc<dyn TriangleSource> = Arc::new(flat);
                BuildError::check_count(source.len())?;
                Some(Located { accel: build(below, Arc::clone(&source))?, source })
            }
            None => None,
        };
        phases.end("flat meshes");
        let boxes = levels.boxes();
        let above = if boxes.is_empty() { None } else { Some(build(above, Arc::new(boxes))?) };
        phases.end("tree of placements");
        let report = BuildReport::default();
        let mut two_level = Self { levels, flat, above, below: of_meshes, level, report };
        two_level.report = two_level.sum_up(phases);
        Ok(two_level)
    }

    fn parts(&self) -> impl Iterator<Item = &dyn Accel> {
        let above = self.above.iter().map(|accel| &**accel);
        let flat = self.flat.iter().map(|located| &*located.accel);
        above.chain(flat).chain(self.below.iter().flatten().map(|accel| &**accel))
    }

    fn sum_up(&self, phases: Phases) -> BuildReport {
        let first = self.parts().next().map(|accel| accel.report().clone()).unwrap_or_default();
        let sum = |of: fn(&BuildReport) -> usize| self.parts().map(|part| of(part.report())).sum();
        BuildReport {
            phases: phases.ended(),
            triangles: self.levels.placed.len(),
            nodes: sum(|report| report.nodes),
            leaves: sum(|report| report.leaves),
            ..first
        }
    }

    fn trace<'a>(&'a self, make: fn(&'a dyn Accel) -> Box<dyn Tracer + 'a>) -> LevelsTracer<'a> {
        LevelsTracer {
            two_level: self,
            make,
            flat: self.flat.as_ref().map(|flat| make(flat)),
            above: self.above.as_deref().map(make),
            below: RefCell::new((0..self.below.len()).map(|_| None).collect()),
            rays: Vec::new(),
            hits: Vec::new(),
        }
    }
}

impl Accel for TwoLevel {
    fn tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(self.trace(|accel| accel.tracer()))
    }

    fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
        Box::new(self.trace(|accel| accel.counting_tracer()))
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let total = |accel: &dyn Accel| accel.memory().total();
        let below = self.below.iter().flatten().map(|accel| total(&**accel)).sum();
        let above = self.above.iter().map(|accel| total(&**accel)).sum::<usize>();
        let flat = self.flat.iter().map(|flat| total(flat)).sum();
        let placements = above + size_of_val(&*self.levels.placements);
        MemoryReport::new([("placements", placements), ("meshes", below), ("flat meshes", flat)])
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}

/// Traces what is flattened first, then what is placed, as far as that can be nearer.
struct LevelsTracer<'a> {
    two_level: &'a TwoLevel,
    make: fn(&'a dyn Accel) -> Box<dyn Tracer + 'a>,
    flat: Option<Box<dyn Tracer + 'a>>,
    above: Option<Box<dyn Tracer + 'a>>,
    below: RefCell<Vec<Option<Box<dyn Tracer + 'a>>>>,
    rays: Vec<Ray>,
    hits: Vec<ClosestHit>,
}

impl<'a> LevelsTracer<'a> {
    /// Has the upper structure asked about `self.rays`.
    fn ask(&mut self, batch: &Batch<'_>, ask: impl FnOnce(&mut dyn Tracer, &Batch<'_>)) {
        let Self { two_level, make, above, below, rays, .. } = self;
        let Some(tracer) = above else { return };
        let two_level: &'a TwoLevel = two_level;
        let make =
            |mesh: usize| make(two_level.below[mesh].as_deref().expect("its mesh is kept apart"));
        let verdict = Above {
            levels: &two_level.levels,
            tracers: below,
            make: &make,
            rays,
            filter: batch.filter(),
        };
        ask(&mut **tracer, &batch.with_rays(rays).with_filter(None).with_verdict(&verdict));
    }
}

impl Tracer for LevelsTracer<'_> {
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        match &mut self.flat {
            Some(flat) => flat.closest_hits(batch, hits),
            None => hits.fill(ClosestHit::MISS),
        }
        self.rays.clear();
        self.rays.extend(batch.rays().iter().zip(&*hits).map(|(ray, hit)| ray.up_to(hit.t)));
        let mut found = std::mem::take(&mut self.hits);
        found.clear();
        found.resize(hits.len(), ClosestHit::MISS);
        self.ask(batch, |tracer, batch| tracer.closest_hits(batch, &mut found));
        for (hit, found) in hits.iter_mut().zip(&found) {
            if found.is_before(hit) {
                *hit = *found;
            }
        }
        self.hits = found;
    }

    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        match &mut self.flat {
            Some(flat) => flat.any_hits(batch, hits),
            None => hits.fill(AnyHit(false)),
        }
        let open = |(ray, hit): (&Ray, &AnyHit)| if hit.0 { Ray::MISS } else { *ray };
        self.rays.clear();
        self.rays.extend(batch.rays().iter().zip(&*hits).map(open));
        let mut found = vec![AnyHit(false); hits.len()];
        self.ask(batch, |tracer, batch| tracer.any_hits(batch, &mut found));
        for (hit, found) in hits.iter_mut().zip(found) {
            hit.0 |= found.0;
        }
    }

    fn counts(&self) -> Counts {
        let below = self.below.borrow();
        let below = below.iter().flatten().map(|tracer| tracer.counts());
        let above = self.above.iter().chain(&self.flat).map(|tracer| tracer.counts());
        above.chain(below).fold(Counts::default(), |sum, counts| sum + counts)
    }
}
