//! Kd-trees side by side: table 3 of Hapala and Havran's review, measured.
//!
//! Walks share a tree, as long as they have the same options of builds. Each is made, held against
//! the first one's answers, timed and dropped, so that the derived data of one at a time is in
//! memory. Then the plain stack, over all builds and layouts.

use std::sync::Arc;

use serde_json::{Value, json};

use super::measure::{Answers, Ask, BenchError, Measured, Shots};
use super::ray_sets::{RaySet, Target};
use super::table::Table;
use crate::accel::kd::build::OPTIONS;
use crate::accel::kd::tree::KdTree;
use crate::accel::kd::{LAYOUT, OVER, OverTree, SHORT_STACK, STACK_DIRECTION};
use crate::accel::{BuildError, Event, Options, Steps, VARIANTS, Values};
use crate::geom::TriangleSource;
use crate::math::Ray;
use crate::simd::Isa;

/// The sets that are shot.
pub const SETS: [RaySet; 3] = [RaySet::Random, RaySet::Primary, RaySet::Bounce];

/// Passes that are timed; the fastest counts.
const ROUNDS: usize = 3;

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct KdBenchSettings {
    /// Rays of each set.
    pub rays: usize,
    /// Bytes that a structure may take by the estimate.
    pub memory: u64,
    /// The instruction set.
    pub isa: Isa,
}

/// A structure's row.
#[derive(Clone, Debug)]
pub struct Row {
    /// Id and options.
    pub spec: String,
    /// Seconds to build the tree.
    pub build_seconds: f64,
    /// Its cost by the surface area heuristic.
    pub sah_cost: f64,
    /// All its bytes.
    pub bytes: usize,
    /// By [`SETS`].
    pub sets: Vec<Measured>,
}

impl Row {
    /// As an object.
    pub fn json(&self) -> Value {
        let sets: serde_json::Map<String, Value> = SETS
            .iter()
            .zip(&self.sets)
            .map(|(set, measured)| {
                let object = json!({
                    "inner_nodes": measured.per_ray(Event::InnerNode),
                    "leaves": measured.per_ray(Event::Leaf),
                    "triangle_tests": measured.per_ray(Event::TriangleTest),
                    "triangles": measured.per_ray(Event::TriangleLane),
                    "restarts": measured.per_ray(Event::Restart),
                    "mrays_s": measured.rate(),
                });
                (set.name().to_owned(), object)
            })
            .collect();
        json!({
            "accel": self.spec,
            "build_s": self.build_seconds,
            "sah_cost": self.sah_cost,
            "bytes": self.bytes,
            "sets": sets,
        })
    }
}

/// Rays, and what the first structure answered to them.
struct Sets {
    rays: Vec<Vec<Ray>>,
    first: String,
    expected: Vec<Answers>,
}

/// Bytes that a kd-tree over that many triangles may take, with links: some five references a
/// triangle, and as many nodes. While the default build is at work, its two trees and their lists
/// take less (330 bytes a triangle for a scanned dragon of 870,000).
pub fn estimate(triangles: usize) -> u64 {
    triangles as u64 * 1200
}

/// Measures all walks over a tree of the default build: table 3.
///
/// # Errors
/// If the tree would not fit, or a walk disagrees with the first.
pub fn measure_walks(
    source: &Arc<dyn TriangleSource>,
    settings: &KdBenchSettings,
) -> Result<Vec<Row>, BenchError> {
    let mut options = Options::defaults(&OPTIONS);
    let mut tree = build_tree(source, settings, &options)?;
    let sets = shoot_first(&tree, source, settings)?;
    let mut rows = Vec::new();
    for &(id, over) in OVER {
        let variant = VARIANTS.iter().find(|variant| variant.id == id).unwrap_or(&STACK_DIRECTION);
        let own = Options::defaults(variant.options);
        if !own.iter().take(OPTIONS.len()).eq(options.iter().take(OPTIONS.len())) {
            tree = build_tree(source, settings, &own)?;
        }
        options = own;
        rows.push(measure_row(id.to_owned(), &tree, over, &options, &sets, settings)?);
    }
    Ok(rows)
}

/// Measures the plain stack over all builds and layouts.
///
/// # Errors
/// If a tree would not fit, or disagrees with the first.
pub fn measure_builds_and_layouts(
    source: &Arc<dyn TriangleSource>,
    settings: &KdBenchSettings,
) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    let mut kept: Option<Sets> = None;
    let over = find_walk(STACK_DIRECTION.id);
    for build in choices(OPTIONS[0].values) {
        let tree = build_tree(source, settings, &options_with_build(build))?;
        let sets = match kept.take() {
            Some(sets) => sets,
            None => shoot_first(&tree, source, settings)?,
        };
        for layout in choices(LAYOUT.values) {
            let text = format!("build={build},layout={layout}");
            let options = Options::parse(STACK_DIRECTION.id, STACK_DIRECTION.options, &text)
                .unwrap_or_else(|_| Options::defaults(STACK_DIRECTION.options));
            rows.push(measure_row(text, &tree, over, &options, &sets, settings)?);
        }
        kept = Some(sets);
    }
    Ok(rows)
}

/// The words of a choice.
pub(super) fn choices(values: Values) -> &'static [&'static str] {
    match values {
        Values::Choice(words) => words,
        _ => &[],
    }
}

fn find_walk(id: &str) -> OverTree {
    OVER.iter().find(|(known, _)| *known == id).unwrap_or(&OVER[0]).1
}

/// The default options with one of the builds.
pub(super) fn options_with_build(build: &str) -> Options {
    let options = Options::parse("kd", &OPTIONS, &format!("build={build}"));
    options.unwrap_or_else(|_| Options::defaults(&OPTIONS))
}

/// A tree, if the estimate fits the memory.
pub(super) fn build_tree(
    source: &Arc<dyn TriangleSource>,
    settings: &KdBenchSettings,
    options: &Options,
) -> Result<KdTree, BenchError> {
    let needed = estimate(source.len());
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    Ok(KdTree::build(source, options, &Steps::untold())?)
}

fn find_level(settings: &KdBenchSettings) -> Result<fearless_simd::Level, BuildError> {
    settings.isa.level().ok_or(BuildError::NoSuchIsa { isa: settings.isa.name() })
}

fn shoot_first(
    tree: &KdTree,
    source: &Arc<dyn TriangleSource>,
    settings: &KdBenchSettings,
) -> Result<Sets, BenchError> {
    let options = Options::defaults(STACK_DIRECTION.options);
    let accel = find_walk(STACK_DIRECTION.id)(tree, &options, find_level(settings)?)?;
    let target = Target::new(&**source, &*accel);
    let count = |set| match set {
        RaySet::Primary => side(settings.rays).pow(2),
        _ => settings.rays,
    };
    let rays: Vec<_> = SETS.iter().map(|&set| target.rays(set, count(set), 1)).collect();
    let all = SETS.iter().zip(&rays);
    let expected = all.map(|(&set, rays)| make_shots(set, rays).trace(&*accel)).collect();
    Ok(Sets { rays, first: STACK_DIRECTION.id.to_owned(), expected })
}

/// Sides of the largest square picture of so many rays.
fn side(rays: usize) -> usize {
    rays.isqrt().max(1)
}

/// All rays of a set at once; primary ones are a picture's.
fn make_shots(set: RaySet, rays: &[Ray]) -> Shots<'_> {
    let side = side(rays.len()) as u32;
    let grid = (set == RaySet::Primary).then_some((side, side));
    Shots { grid, ..Shots::new(rays, Ask::Closest, rays.len()) }
}

fn measure_row(
    spec: String,
    tree: &KdTree,
    over: OverTree,
    options: &Options,
    sets: &Sets,
    settings: &KdBenchSettings,
) -> Result<Row, BenchError> {
    let accel = over(tree, options, find_level(settings)?)?;
    let mut measured = Vec::new();
    for ((&set, rays), expected) in SETS.iter().zip(&sets.rays).zip(&sets.expected) {
        let shots = make_shots(set, rays);
        shots.trace(&*accel).check(expected, &spec, &sets.first, set.name())?;
        let rounds = (0..ROUNDS).map(|_| shots.time(&*accel));
        let seconds = rounds.fold(f64::INFINITY, f64::min);
        measured.push(Measured { counts: shots.count_work(&*accel), rays: rays.len(), seconds });
    }
    Ok(Row {
        spec,
        build_seconds: tree.report.seconds(),
        sah_cost: tree.report.sah_cost,
        bytes: accel.memory().total(),
        sets: measured,
    })
}

/// The rows as tables: sizes and rates in one, then the work of each set in one of its own.
pub fn make_tables(title: &str, rows: &[Row]) -> Vec<Table> {
    let mut rates = Table::new(title, "", &["structure", "build s", "SAH cost", "MB"]);
    rates.heading.extend(SETS.map(|set| format!("{} Mrays/s", set.name())));
    rates.rows = rows.iter().map(rate_cells).collect();
    let work = SETS.iter().enumerate().map(|(place, set)| {
        let heading = ["structure", "nodes", "leaves", "tests", "triangles", "restarts"];
        let title = format!("{title}: {} rays, each", set.name());
        let mut table = Table::new(title, compare_short_stack(rows, place), &heading);
        table.rows = rows.iter().map(|row| work_cells(row, place)).collect();
        table
    });
    std::iter::once(rates).chain(work).collect()
}

/// What the short stack's restarts cost beside the full stack, where both were measured.
fn compare_short_stack(rows: &[Row], set: usize) -> String {
    let nodes = |id: &str| {
        let row = rows.iter().find(|row| row.spec == id)?;
        Some(row.sets[set].per_ray(Event::InnerNode)).filter(|&nodes| nodes > 0.0)
    };
    match (nodes(STACK_DIRECTION.id), nodes(SHORT_STACK.id)) {
        (Some(full), Some(short)) => format!(
            "{} visits {:.2} % more nodes than {}; the review tells of less than 3 %.",
            SHORT_STACK.id,
            (short / full - 1.0) * 100.0,
            STACK_DIRECTION.id
        ),
        _ => String::new(),
    }
}

fn rate_cells(row: &Row) -> Vec<String> {
    let mut cells = vec![
        row.spec.clone(),
        format!("{:.3}", row.build_seconds),
        format!("{:.2}", row.sah_cost),
        format!("{:.1}", row.bytes as f64 * 1e-6),
    ];
    cells.extend(row.sets.iter().map(|set| format!("{:.3}", set.rate())));
    cells
}

fn work_cells(row: &Row, set: usize) -> Vec<String> {
    const EVENTS: [Event; 5] =
        [Event::InnerNode, Event::Leaf, Event::TriangleTest, Event::TriangleLane, Event::Restart];
    let figures = EVENTS.map(|event| format!("{:.2}", row.sets[set].per_ray(event)));
    std::iter::once(row.spec.clone()).chain(figures).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Triangle, TriangleList};
    use crate::math::Vec3;

    fn source() -> Arc<dyn TriangleSource> {
        let corner = |i: usize| Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, i as f32);
        let list = (0..100).map(|i| {
            let a = corner(i);
            Triangle { a, b: a + Vec3::X, c: a + Vec3::ONE }
        });
        Arc::new(TriangleList(list.collect()))
    }

    #[test]
    fn every_walk_and_every_build_has_a_row() {
        let settings = KdBenchSettings { rays: 2500, memory: u64::MAX, isa: Isa::Portable };
        let rows = measure_walks(&source(), &settings).expect("all agree");
        assert_eq!(rows.len(), OVER.len());
        let tables = make_tables("walks", &rows);
        assert_eq!(tables.len(), 1 + SETS.len());
        for table in tables.iter().map(Table::markdown) {
            assert!(OVER.iter().all(|(id, _)| table.contains(id)));
            assert!(table.lines().all(|line| line.len() <= 130), "{table}");
        }
        let nodes = |id: &str| {
            let row = rows.iter().find(|row| row.spec == id).expect("has a row");
            row.sets[1].per_ray(Event::InnerNode)
        };
        assert!(nodes("kd-packet") < 0.5 * nodes("kd-stack-direction"), "a raster by packets");
        assert!(tables[1].note.starts_with("kd-short-stack visits "), "{}", tables[1].note);
        assert_eq!(measure_builds_and_layouts(&source(), &settings).expect("all agree").len(), 15);
    }

    #[test]
    fn what_would_not_fit_is_refused() {
        let settings = KdBenchSettings { rays: 50, memory: 1000, isa: Isa::Portable };
        let error =
            measure_walks(&source(), &settings).expect_err("100 triangles take more than 1000 B");
        assert!(error.to_string().contains("more than the 1000"), "{error}");
    }
}
