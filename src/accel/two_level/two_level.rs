//! A structure over placements, and one of each mesh that is placed.

use std::cell::RefCell;
use std::sync::Arc;

use fearless_simd::Level;
use rayon::prelude::*;

use super::levels::Levels;
use super::sources::Placed;
use super::verdict::Above;
use super::wide::WideLevels;
use crate::accel::bvh::wide::build_auto_tree;
use crate::accel::bvh::wide::wide_bvh::WideBvh;
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
    levels: Arc<Levels>,
    flat: Option<Located>,
    /// `None` without placements that are kept apart.
    above: Option<Box<dyn Accel>>,
    /// Of each mesh; empty if the structure above has them.
    below: Vec<Option<Box<dyn Accel>>>,
    level: Level,
    report: BuildReport,
}

impl TwoLevel {
    /// Builds all structures, those of meshes side by side: `below` for these and for what is
    /// flattened, `above` for placements. Unless `copies`, only what moves is not flattened.
    pub fn build(
        (placed, copies): (Placed, bool),
        (below, above): (Row<'_>, Row<'_>),
        level: Level,
    ) -> Result<Self, BuildError> {
        let mut phases = Phases::start();
        let levels = Arc::new(Levels::new(placed, copies, &mut phases));
        let flat = match levels.flat() {
            Some(flat) => {
                let source: Arc<dyn TriangleSource> = Arc::new(flat);
                BuildError::check_count(source.len())?;
                let accel = build_row(below, Arc::clone(&source), level)?;
                Some(Located { accel, source })
            }
            None => None,
        };
        phases.end("flat meshes");
        let (above, below) = if levels.placements.is_empty() {
            (None, Vec::new())
        } else {
            let (above, below) = build_placed(&levels, (below, above), level, &mut phases)?;
            (Some(above), below)
        };
        let report = BuildReport::default();
        let mut two_level = Self { levels, flat, above, below, level, report };
        two_level.report = two_level.sum_up(phases);
        Ok(two_level)
    }

    /// All structures, that above first.
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

fn build_row(
    (variant, options): Row<'_>,
    source: Arc<dyn TriangleSource>,
    level: Level,
) -> Result<Box<dyn Accel>, BuildError> {
    (variant.build)(&BuildInput { source, options, level })
}

/// A structure above, and one of each mesh.
type Structures<T> = (T, Vec<Option<T>>);

/// Builds a structure of placements and those of their meshes, the latter side by side.
fn build_structures<T: Send>(
    levels: &Levels,
    phases: &mut Phases,
    below: impl Fn(Arc<dyn TriangleSource>) -> Result<T, BuildError> + Sync,
    above: impl FnOnce(Arc<dyn TriangleSource>) -> Result<T, BuildError>,
) -> Result<Structures<T>, BuildError> {
    let of_mesh = |mesh| levels.mesh(mesh).map(|mesh| below(Arc::new(mesh))).transpose();
    let of_meshes = (0..levels.meshes.len()).into_par_iter().map(of_mesh);
    let of_meshes = of_meshes.collect::<Result<_, _>>()?;
    phases.end("meshes");
    let above = above(Arc::new(levels.boxes()))?;
    phases.end("tree of placements");
    Ok((above, of_meshes))
}

/// Builds what is placed: hierarchies of eight children are walked together, if nothing moves.
fn build_placed(
    levels: &Arc<Levels>,
    (below, above): (Row<'_>, Row<'_>),
    level: Level,
    phases: &mut Phases,
) -> Result<Structures<Box<dyn Accel>>, BuildError> {
    let eight: Option<fn(&BuildInput<'_>) -> _> = match below.0.id {
        _ if below.0.id != above.0.id || levels.are_moving() => None,
        "auto" => Some(build_auto_tree),
        "mbvh8" => Some(WideBvh::<8>::build),
        _ => None,
    };
    let Some(eight) = eight else {
        let row = |row| move |source| build_row(row, source, level);
        return build_structures(levels, phases, row(below), row(above));
    };
    let options = below.1;
    let tree = |source| eight(&BuildInput { source, options, level });
    let (above, below) = build_structures(levels, phases, tree, tree)?;
    Ok(match WideLevels::new(Arc::clone(levels), above, below) {
        Ok(both) => (Box::new(both), Vec::new()),
        Err(trees) => {
            let (above, below) = *trees;
            let boxed = |tree| Box::new(tree) as Box<dyn Accel>;
            (boxed(above), below.into_iter().map(|tree| tree.map(boxed)).collect())
        }
    })
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
        let mut report = match (&self.above, self.below.is_empty()) {
            (Some(both), true) => both.memory(),
            (above, _) => {
                let above = above.iter().map(|accel| total(&**accel)).sum();
                let below = self.below.iter().flatten().map(|accel| total(&**accel)).sum();
                MemoryReport::new([("placements", above), ("meshes", below)])
            }
        };
        let list = size_of_val(&*self.levels.placements);
        let flat = self.flat.iter().map(|flat| total(flat)).sum();
        report.parts.extend([("list of placements", list), ("flat meshes", flat)]);
        report
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
        if two_level.below.is_empty() {
            return ask(&mut **tracer, &batch.with_rays(rays));
        }
        let two_level: &'a TwoLevel = two_level;
        let make =
            |mesh: usize| make(two_level.below[mesh].as_deref().expect("its mesh is kept apart"));
        let verdict = Above {
            levels: &two_level.levels,
            tracers: below,
            make: &make,
            rays,
            filter: batch.filter(),
            times: batch.times(),
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
