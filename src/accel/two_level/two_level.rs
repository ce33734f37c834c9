//! A structure over placements, and one of each mesh that is placed.

use std::sync::Arc;

use fearless_simd::Level;
use rayon::prelude::*;

use super::bodies::find_bodies;
use super::body::Body;
use super::few_moving::FewMoving;
use super::levels::Levels;
use super::moving_triangles::MovingTriangles;
use super::outline::Outline;
use super::sources::{FlatTriangles, Placed};
use super::wide_levels::WideLevels;
use crate::accel::bvh::wide::build_auto_tree;
use crate::accel::bvh::wide::wide_bvh::WideBvh;
use crate::accel::located::Located;
use crate::accel::{
    Accel, BuildError, BuildInput, BuildReport, MemoryReport, Options, Phases, Steps, Tracer,
    Variant,
};
use crate::files::Meter;
use crate::geom::TriangleSource;
use crate::math::MeshId;

/// A row of the table with its options.
pub type Row<'a> = (&'static Variant, &'a Options);

/// Two levels of any two rows of the table.
pub struct TwoLevel {
    pub(super) levels: Arc<Levels>,
    pub(super) flat: Option<Located>,
    /// `None` without placements that are kept apart.
    pub(super) above: Option<Box<dyn Accel>>,
    /// In place of that: what moves, if it is all that is kept apart and is little.
    pub(super) few: Option<FewMoving>,
    /// What holds all that is kept apart, if anything of it moves.
    pub(super) outline: Option<Outline>,
    /// Of each mesh, or of a piece of its time; nothing if those are a part of `above`.
    pub(super) below: Vec<Option<Box<dyn Accel>>>,
    pub(super) level: Level,
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
        let (wide, few) = match wide {
            // All is in it.
            Some(Kept::Wide(wide)) if !levels.are_moving() => return Ok(wide),
            Some(Kept::Wide(wide)) => (Some(wide as Box<dyn Accel>), None),
            Some(Kept::Few(few)) => (None, Some(few)),
            None => (None, None),
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
            None if is_split && few.is_none() => {
                levels.keep_ways();
                let below = build_meshes(&levels, |_| true, row(below))?;
                phases.end("meshes");
                let above = row(above)(Arc::new(levels.boxes()))?;
                phases.end("tree of placements");
                (Some(above), below)
            }
            None => (None, Vec::new()),
        };
        let outline = levels.outline().filter(|_| few.is_none());
        let report = BuildReport::default();
        let mut two_level = Self { levels, flat, above, few, outline, below, level, report };
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
}

fn build_row(
    (variant, options): Row<'_>,
    source: Arc<dyn TriangleSource>,
    (level, meter): (Level, &Meter),
) -> Result<Box<dyn Accel>, BuildError> {
    let steps = &Steps::new(meter, source.len());
    (variant.build)(&BuildInput { source, options, level, steps })
}

/// What both levels are built into together.
enum Kept {
    /// Hierarchies.
    Wide(Box<WideLevels>),
    /// What moves, and no hierarchy.
    Few(FewMoving),
}

/// Hierarchies of eight children that are walked together, of all or, where anything moves, of what
/// is kept apart; `None` if they can't be.
fn build_together(
    levels: Levels,
    options: &Options,
    eight: BuildEight,
    (level, meter, phases): (Level, &Meter, &mut Phases),
) -> Result<(Arc<Levels>, Option<Kept>), BuildError> {
    let tree_with_room = |source: Arc<dyn TriangleSource>, room: usize| {
        let steps = &Steps::new(meter, source.len());
        eight(&BuildInput { source, options, level, steps }, room)
    };
    let tree = |source: Arc<dyn TriangleSource>| tree_with_room(source, 0);
    let flat = if levels.are_moving() {
        FlatTriangles::new(levels.placed.clone(), Vec::new())
    } else {
        levels.flat.clone()
    };
    let bodies = find_bodies(&levels);
    let moving = MovingTriangles::choose(&levels, &bodies);
    let levels = &Arc::new(levels.with_timed_ways(moving.rest()));
    if let Some(few) = FewMoving::new(levels, (&moving, &bodies), level) {
        phases.end("triangles that move");
        // Their meshes have no structures.
        drop(Steps::new(meter, levels.count_primitives() - levels.flat.len()));
        return Ok((Arc::clone(levels), Some(Kept::Few(few))));
    }
    let others = moving.find_meshes_of_others(levels);
    let needed = |mesh: MeshId| others[mesh.index()];
    let mut below = build_meshes(levels, needed, tree)?;
    Steps::expect(meter, bodies.iter().map(|body| body.triangles().len()).sum());
    let body = |body: &Body| tree(Arc::new(body.triangles())).map(Some);
    below.extend(bodies.par_iter().map(body).collect::<Result<Vec<_>, BuildError>>()?);
    // Beyond one tree of what moves there is one for each other part of the time.
    let boxes = moving.len() + moving.rest().len() + bodies.len();
    Steps::expect(meter, boxes * levels.timed_boxes.parts());
    let mut own = phases.clone();
    let parts = (flat, moving, bodies);
    let wide = WideLevels::build(levels, parts, below, tree_with_room, &mut own)?;
    if wide.is_some() {
        *phases = own;
    }
    Ok((Arc::clone(levels), wide.map(|wide| Kept::Wide(Box::new(wide)))))
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

/// What builds a hierarchy of eight children, with room to spare.
type BuildEight = fn(&BuildInput<'_>, usize) -> Result<WideBvh<8>, BuildError>;

/// The same for those rows that are such hierarchies: both levels of them are walked together.
fn eight_children(id: &str) -> Option<BuildEight> {
    match id {
        "auto" => Some(build_auto_tree),
        "mbvh8" => Some(WideBvh::<8>::build_with_room),
        _ => None,
    }
}

impl Accel for TwoLevel {
    fn tracer(&self) -> Box<dyn Tracer + '_> {
        self.trace(false, |accel| accel.tracer())
    }

    fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
        self.trace(true, |accel| accel.counting_tracer())
    }

    fn level(&self) -> Level {
        self.level
    }

    fn memory(&self) -> MemoryReport {
        let total = |accel: &dyn Accel| accel.memory().total();
        let mut parts = match &self.above {
            // It has the meshes and the list as well.
            Some(together) if self.below.is_empty() => together.memory().parts,
            None if self.few.is_some() => Vec::new(),
            above => vec![
                ("placements", above.iter().map(|accel| total(&**accel)).sum()),
                ("meshes", self.below.iter().flatten().map(|accel| total(&**accel)).sum()),
                ("list of placements", self.levels.bytes()),
            ],
        };
        parts.extend(self.few.iter().map(|few| ("triangles that move", few.bytes())));
        parts.push(("flat meshes", self.flat.iter().map(|flat| total(flat)).sum()));
        MemoryReport::new(parts)
    }

    fn report(&self) -> &BuildReport {
        &self.report
    }
}
