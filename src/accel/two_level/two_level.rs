//! A structure over placements, and one of each mesh that is placed.

use std::cell::RefCell;
use std::sync::Arc;

use fearless_simd::{Level, Simd};
use rayon::prelude::*;

use super::levels::Levels;
use super::moving_triangles::MovingTriangles;
use super::outline::{LANES, Outline};
use super::sources::{FlatTriangles, Placed};
use super::verdict::Above;
use super::wide_levels::WideLevels;
use crate::accel::bvh::wide::build_auto_tree;
use crate::accel::bvh::wide::wide_bvh::WideBvh;
use crate::accel::located::Located;
use crate::accel::{
    Accel, AnyHit, Batch, BuildError, BuildInput, BuildReport, ClosestHit, Counts, HitFilter,
    MemoryReport, Options, Phases, Steps, Tracer, Variant,
};
use crate::files::Meter;
use crate::geom::{SlabRay, TriangleSource};
use crate::math::{MeshId, Ray};
use crate::simd::vectorized;

/// A row of the table with its options.
pub type Row<'a> = (&'static Variant, &'a Options);

/// Two levels of any two rows of the table.
pub struct TwoLevel {
    levels: Arc<Levels>,
    flat: Option<Located>,
    /// `None` without placements that are kept apart.
    above: Option<Box<dyn Accel>>,
    /// What holds all of these, if anything moves.
    outline: Option<Outline>,
    /// Of each mesh, or of a piece of its time; nothing if those are a part of `above`.
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
        (level, meter): (Level, &Meter),
    ) -> Result<Box<dyn Accel>, BuildError> {
        let mut phases = Phases::start();
        let levels = Levels::new(placed, copies, &mut phases);
        Steps::expect(meter, levels.count_primitives());
        let is_split = !levels.placements.is_empty();
        let eight = eight_children(below.0.id).filter(|_| is_split && below.0.id == above.0.id);
        let (levels, wide) = match eight {
            Some(eight) => build_together(levels, below.1, eight, (level, meter, &mut phases))?,
            None => (Arc::new(levels), None),
        };
        let wide = match wide {
            // All is in it.
            Some(wide) if !levels.are_moving() => return Ok(Box::new(wide)),
            wide => wide.map(|wide| Box::new(wide) as Box<dyn Accel>),
        };
        let row = |row| move |source| build_row(row, source, (level, meter));
        let flat = (!levels.flat.is_empty()).then(|| {
            let source: Arc<dyn TriangleSource> = Arc::new(levels.flat.clone());
            BuildError::check_count(source.len())?;
            let accel = row(below)(Arc::clone(&source))?;
            Ok(Located { accel, source })
        });
        let flat = flat.transpose()?;
        phases.end("flat meshes");
        let (above, below) = match wide {
            Some(wide) => (Some(wide), Vec::new()),
            None if is_split => {
                let below = build_meshes(&levels, |_| true, row(below))?;
                phases.end("meshes");
                let above = row(above)(Arc::new(levels.boxes()))?;
                phases.end("tree of placements");
                (Some(above), below)
            }
            None => (None, Vec::new()),
        };
        let (outline, report) = (levels.outline(), BuildReport::default());
        let mut two_level = Self { levels, flat, above, outline, below, level, report };
        two_level.report = two_level.sum_up(phases);
        Ok(Box::new(two_level))
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
            numbers: Vec::new(),
            times: Vec::new(),
            hits: Vec::new(),
        }
    }
}

fn build_row(
    (variant, options): Row<'_>,
    source: Arc<dyn TriangleSource>,
    (level, meter): (Level, &Meter),
) -> Result<Box<dyn Accel>, BuildError> {
    let steps = &Steps::new(meter, source.len());
    (variant.build)(&BuildInput { source, options, level, steps })
}

/// Hierarchies of eight children that are walked together, of all or, where anything moves, of what
/// is kept apart; `None` if they can't be.
fn build_together(
    levels: Levels,
    options: &Options,
    eight: BuildEight,
    (level, meter, phases): (Level, &Meter, &mut Phases),
) -> Result<(Arc<Levels>, Option<WideLevels>), BuildError> {
    let tree = |source: Arc<dyn TriangleSource>| {
        let steps = &Steps::new(meter, source.len());
        eight(&BuildInput { source, options, level, steps })
    };
    let flat = if levels.are_moving() {
        FlatTriangles::new(levels.placed.clone(), Vec::new())
    } else {
        levels.flat.clone()
    };
    let moving = MovingTriangles::choose(&levels);
    let levels = &Arc::new(levels.with_timed_ways(moving.rest()));
    let others = moving.find_meshes_of_others(levels);
    let needed = |mesh: MeshId| others[mesh.index()];
    let below = build_meshes(levels, needed, tree)?;
    // Beyond one tree of what moves there is one for each other part of the time.
    let boxes = moving.len() + moving.rest().len();
    Steps::expect(meter, boxes * levels.timed_boxes.parts());
    let mut own = phases.clone();
    let wide = WideLevels::build(levels, (flat, moving), below, tree, &mut own)?;
    if wide.is_some() {
        *phases = own;
    }
    Ok((Arc::clone(levels), wide))
}

/// The structures of those `needed` of the meshes that are kept apart, as [`Levels::spans`] numbers
/// them, built side by side.
fn build_meshes<T: Send>(
    levels: &Levels,
    needed: impl Fn(MeshId) -> bool + Sync,
    build: impl Fn(Arc<dyn TriangleSource>) -> Result<T, BuildError> + Sync,
) -> Result<Vec<Option<T>>, BuildError> {
    let of_mesh = |number| {
        let mesh = levels.mesh(number).filter(|mesh| needed(mesh.mesh));
        mesh.map(|mesh| build(Arc::new(mesh))).transpose()
    };
    (0..levels.spans.len()).into_par_iter().map(of_mesh).collect()
}

/// What builds a hierarchy of eight children.
type BuildEight = fn(&BuildInput<'_>) -> Result<WideBvh<8>, BuildError>;

/// The same for those rows that are such hierarchies: both levels of them are walked together.
fn eight_children(id: &str) -> Option<BuildEight> {
    match id {
        "auto" => Some(build_auto_tree),
        "mbvh8" => Some(WideBvh::<8>::build),
        _ => None,
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
        let mut parts = match &self.above {
            // It has the meshes and the list as well.
            Some(together) if self.below.is_empty() => together.memory().parts,
            above => vec![
                ("placements", above.iter().map(|accel| total(&**accel)).sum()),
                ("meshes", self.below.iter().flatten().map(|accel| total(&**accel)).sum()),
                ("list of placements", self.levels.bytes()),
            ],
        };
        parts.push(("flat meshes", self.flat.iter().map(|flat| total(flat)).sum()));
        MemoryReport::new(parts)
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
    /// Those that may meet what is placed.
    rays: Vec<Ray>,
    /// Their numbers in the batch.
    numbers: Vec<u32>,
    /// Their times.
    times: Vec<f32>,
    hits: Vec<ClosestHit>,
}

impl<'a> LevelsTracer<'a> {
    /// Chooses the rays that may meet what is placed, each up to where that would count.
    fn choose(&mut self, batch: &Batch<'_>, up_to: impl Fn(usize) -> Option<f32>) {
        vectorized!(self.two_level.level, simd => self.choose_by(simd, batch, up_to));
    }

    #[inline(always)]
    fn choose_by<S: Simd>(
        &mut self,
        simd: S,
        batch: &Batch<'_>,
        up_to: impl Fn(usize) -> Option<f32>,
    ) {
        let Self { two_level, rays, numbers, times, .. } = self;
        let (timed_boxes, outline) = (&two_level.levels.timed_boxes, &two_level.outline);
        rays.clear();
        numbers.clear();
        times.clear();
        for (group, some) in batch.rays().chunks(LANES).enumerate() {
            let first = group * LANES;
            // No ray goes backwards.
            let mut t_max = [-1.0; LANES];
            for lane in 0..some.len() {
                t_max[lane] = up_to(first + lane).unwrap_or(-1.0);
            }
            let mut lanes = match outline {
                Some(outline) => outline.may_ever_meet(some, &t_max),
                None => {
                    (0..some.len()).fold(0, |all, lane| all | u32::from(t_max[lane] >= 0.0) << lane)
                }
            };
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize % LANES;
                lanes &= lanes - 1;
                let (ray, number) = (some[lane].up_to(t_max[lane]), first + lane);
                let time = batch.times().map_or(0.0, |times| times[number]);
                let meets = outline.as_ref().is_none_or(|outline| {
                    let slab = (&SlabRay::new(&ray), ray.t_min());
                    outline.may_meet(simd, timed_boxes.part(time), slab, ray.t_max())
                });
                if meets {
                    rays.push(ray);
                    numbers.push(number as u32);
                    times.push(time);
                }
            }
        }
    }

    /// Has the upper structure asked about `self.rays`.
    fn ask(&mut self, batch: &Batch<'_>, ask: impl FnOnce(&mut dyn Tracer, &Batch<'_>)) {
        let Self { two_level, make, above, below, rays, numbers, times, .. } = self;
        let Some(tracer) = above else { return };
        let two_level: &'a TwoLevel = two_level;
        // The hints are about all rays.
        let is_whole = rays.len() == batch.rays().len();
        let chosen = if is_whole { batch.with_rays(rays) } else { Batch::new(rays) };
        if two_level.below.is_empty() {
            let filter = batch.filter().map(|filter| ChosenFilter { filter, numbers });
            let filter = filter.as_ref().map(|filter| filter as &dyn HitFilter);
            return ask(&mut **tracer, &chosen.with_filter(filter).with_times(Some(times)));
        }
        let make =
            |mesh: usize| make(two_level.below[mesh].as_deref().expect("its mesh is kept apart"));
        let verdict = Above {
            levels: &two_level.levels,
            tracers: below,
            make: &make,
            rays,
            numbers,
            filter: batch.filter(),
            times: batch.times(),
        };
        ask(&mut **tracer, &chosen.with_filter(None).with_verdict(&verdict));
    }
}

/// The filter of a batch, for some of its rays.
struct ChosenFilter<'a> {
    filter: &'a dyn HitFilter,
    /// Their numbers in the batch.
    numbers: &'a [u32],
}

impl HitFilter for ChosenFilter<'_> {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        self.filter.accepts(self.numbers[ray] as usize, hit)
    }
}

impl Tracer for LevelsTracer<'_> {
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        match &mut self.flat {
            Some(flat) => flat.closest_hits(batch, hits),
            None => hits.fill(ClosestHit::MISS),
        }
        self.choose(batch, |number| Some(hits[number].t));
        let mut found = std::mem::take(&mut self.hits);
        found.clear();
        found.resize(self.rays.len(), ClosestHit::MISS);
        self.ask(batch, |tracer, batch| tracer.closest_hits(batch, &mut found));
        for (&number, found) in self.numbers.iter().zip(&found) {
            let hit = &mut hits[number as usize];
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
        let rays = batch.rays();
        self.choose(batch, |number| (!hits[number].0).then(|| rays[number].t_max()));
        let mut found = vec![AnyHit(false); self.rays.len()];
        self.ask(batch, |tracer, batch| tracer.any_hits(batch, &mut found));
        for (&number, found) in self.numbers.iter().zip(found) {
            hits[number as usize].0 |= found.0;
        }
    }

    fn counts(&self) -> Counts {
        let below = self.below.borrow();
        let below = below.iter().flatten().map(|tracer| tracer.counts());
        let above = self.above.iter().chain(&self.flat).map(|tracer| tracer.counts());
        above.chain(below).fold(Counts::default(), |sum, counts| sum + counts)
    }
}
