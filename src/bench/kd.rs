//! Kd-trees side by side: table 3 of Hapala and Havran's review, measured.
//!
//! All walks share one tree. Each is made, held against the first one's answers, timed and dropped,
//! so that the derived data of one at a time is in memory. Then the plain stack, over all builds
//! and layouts.

use std::sync::Arc;
use std::time::Instant;

use serde_json::{Value, json};

use super::ray_sets::{RaySet, Target};
use crate::accel::kd::build::OPTIONS;
use crate::accel::kd::tree::KdTree;
use crate::accel::kd::{LAYOUT, OVER, OverTree, STACK_DIRECTION};
use crate::accel::{
    Accel, Batch, BuildError, ClosestHit, Counts, Event, Options, VARIANTS, Values,
};
use crate::geom::TriangleSource;
use crate::math::Ray;
use crate::simd::Isa;

/// The sets that are shot.
pub const SETS: [RaySet; 3] = [RaySet::Random, RaySet::Primary, RaySet::Bounce];

/// Passes that are timed; the fastest counts.
const ROUNDS: usize = 3;

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Rays of each set.
    pub rays: usize,
    /// Bytes that a structure may take by the estimate.
    pub memory: u64,
    /// The instruction set.
    pub isa: Isa,
}

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A structure could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A structure answers otherwise than the first.
    #[error("{spec} disagrees with {first} on {rays} of {count} {set} rays; nothing was timed")]
    Disagrees {
        /// Which.
        spec: String,
        /// With which.
        first: String,
        /// How often.
        rays: usize,
        /// Of how many.
        count: usize,
        /// In which set.
        set: &'static str,
    },
}

/// Work and time of a set of rays.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Counted work of all rays.
    pub counts: Counts,
    /// How many rays.
    pub rays: usize,
    /// Seconds of the fastest pass, one thread.
    pub seconds: f64,
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

impl Measured {
    /// How often an event happened per ray.
    pub fn per_ray(&self, event: Event) -> f64 {
        self.counts[event] as f64 / self.rays.max(1) as f64
    }

    /// Millions of rays a second.
    pub fn rate(&self) -> f64 {
        self.rays as f64 / self.seconds.max(1e-9) * 1e-6
    }
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
struct Shots {
    rays: Vec<Vec<Ray>>,
    first: String,
    expected: Vec<Vec<ClosestHit>>,
}

/// Bytes that a kd-tree over that many triangles may take, with links: some five references a
/// triangle, and as many nodes.
pub fn estimate(triangles: usize) -> u64 {
    triangles as u64 * 1200
}

/// Measures all walks over a tree of the default build: table 3.
///
/// # Errors
/// If the tree would not fit, or a walk disagrees with the first.
pub fn walks(
    source: &Arc<dyn TriangleSource>,
    settings: &Settings,
) -> Result<Vec<Row>, BenchError> {
    let tree = tree(source, settings, "sah")?;
    let shots = shots(&tree, source, settings)?;
    let rows = OVER.iter().map(|&(id, over)| {
        let variant = VARIANTS.iter().find(|variant| variant.id == id).unwrap_or(&STACK_DIRECTION);
        let options = Options::defaults(variant.options);
        row(id.to_owned(), &tree, over, &options, &shots, settings)
    });
    rows.collect()
}

/// Measures the plain stack over all builds and layouts.
///
/// # Errors
/// If a tree would not fit, or disagrees with the first.
pub fn builds_and_layouts(
    source: &Arc<dyn TriangleSource>,
    settings: &Settings,
) -> Result<Vec<Row>, BenchError> {
    let mut rows = Vec::new();
    let mut shot: Option<Shots> = None;
    let over = over(STACK_DIRECTION.id);
    for build in choices(OPTIONS[0].values) {
        let tree = tree(source, settings, build)?;
        let shots = match shot.take() {
            Some(shots) => shots,
            None => shots(&tree, source, settings)?,
        };
        for layout in choices(LAYOUT.values) {
            let text = format!("build={build},layout={layout}");
            let options = Options::parse(STACK_DIRECTION.id, STACK_DIRECTION.options, &text)
                .unwrap_or_else(|_| Options::defaults(STACK_DIRECTION.options));
            rows.push(row(text, &tree, over, &options, &shots, settings)?);
        }
        shot = Some(shots);
    }
    Ok(rows)
}

fn choices(values: Values) -> &'static [&'static str] {
    match values {
        Values::Choice(words) => words,
        _ => &[],
    }
}

fn over(id: &str) -> OverTree {
    OVER.iter().find(|(known, _)| *known == id).unwrap_or(&OVER[0]).1
}

fn tree(
    source: &Arc<dyn TriangleSource>,
    settings: &Settings,
    build: &'static str,
) -> Result<KdTree, BenchError> {
    let needed = estimate(source.len());
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    let options = Options::parse("kd", &OPTIONS, &format!("build={build}"));
    let options = options.unwrap_or_else(|_| Options::defaults(&OPTIONS));
    Ok(KdTree::build(source, &options)?)
}

fn level(settings: &Settings) -> Result<fearless_simd::Level, BuildError> {
    settings.isa.level().ok_or(BuildError::NoSuchIsa { isa: settings.isa.name() })
}

fn shots(
    tree: &KdTree,
    source: &Arc<dyn TriangleSource>,
    settings: &Settings,
) -> Result<Shots, BenchError> {
    let options = Options::defaults(STACK_DIRECTION.options);
    let accel = over(STACK_DIRECTION.id)(tree, &options, level(settings)?)?;
    let target = Target::new(&**source, &*accel);
    let rays: Vec<_> = SETS.iter().map(|&set| target.rays(set, settings.rays, 1)).collect();
    let expected = rays.iter().map(|rays| shoot(&*accel, rays).0).collect();
    Ok(Shots { rays, first: STACK_DIRECTION.id.to_owned(), expected })
}

/// Answers, and seconds.
fn shoot(accel: &dyn Accel, rays: &[Ray]) -> (Vec<ClosestHit>, f64) {
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    let mut tracer = accel.tracer();
    let start = Instant::now();
    tracer.closest_hits(&Batch::new(rays), &mut hits);
    (hits, start.elapsed().as_secs_f64())
}

fn row(
    spec: String,
    tree: &KdTree,
    over: OverTree,
    options: &Options,
    shots: &Shots,
    settings: &Settings,
) -> Result<Row, BenchError> {
    let accel = over(tree, options, level(settings)?)?;
    let mut sets = Vec::new();
    for ((set, rays), expected) in SETS.iter().zip(&shots.rays).zip(&shots.expected) {
        let (hits, _) = shoot(&*accel, rays);
        let wrong = hits.iter().zip(expected).filter(|(a, b)| !a.same_bits(b)).count();
        if wrong > 0 {
            return Err(BenchError::Disagrees {
                spec,
                first: shots.first.clone(),
                rays: wrong,
                count: rays.len(),
                set: set.name(),
            });
        }
        let rounds = (0..ROUNDS).map(|_| shoot(&*accel, rays).1);
        let seconds = rounds.fold(f64::INFINITY, f64::min);
        let mut counting = accel.counting_tracer();
        counting.closest_hits(&Batch::new(rays), &mut vec![ClosestHit::MISS; rays.len()]);
        sets.push(Measured { counts: counting.counts(), rays: rays.len(), seconds });
    }
    Ok(Row {
        spec,
        build_seconds: tree.report.seconds(),
        sah_cost: tree.report.sah_cost,
        bytes: accel.memory().total(),
        sets,
    })
}

/// The rows as a table in Markdown.
pub fn markdown(title: &str, rows: &[Row]) -> String {
    const PER_SET: [&str; 5] = ["nodes", "leaves", "tests", "restarts", "Mrays/s"];
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut heading: Vec<String> =
        ["structure", "build s", "SAH cost", "MB"].map(str::to_owned).into();
    for set in SETS {
        heading.extend(PER_SET.map(|name| format!("{} {name}", set.name())));
    }
    let rule = format!("|---|{}\n", "---:|".repeat(heading.len() - 1));
    let row = |row: &Row| {
        let mut cells = vec![
            row.spec.clone(),
            format!("{:.3}", row.build_seconds),
            format!("{:.2}", row.sah_cost),
            format!("{:.1}", row.bytes as f64 * 1e-6),
        ];
        for set in &row.sets {
            let events = [Event::InnerNode, Event::Leaf, Event::TriangleTest, Event::Restart];
            cells.extend(events.map(|event| format!("{:.2}", set.per_ray(event))));
            cells.push(format!("{:.3}", set.rate()));
        }
        line(cells)
    };
    let body: String = rows.iter().map(row).collect();
    format!("## {title}\n\n{}{rule}{body}", line(heading))
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
        let settings = Settings { rays: 50, memory: u64::MAX, isa: Isa::Portable };
        let rows = walks(&source(), &settings).expect("all agree");
        assert_eq!(rows.len(), OVER.len());
        let table = markdown("walks", &rows);
        assert!(OVER.iter().all(|(id, _)| table.contains(id)));
        assert_eq!(builds_and_layouts(&source(), &settings).expect("all agree").len(), 15);
    }

    #[test]
    fn what_would_not_fit_is_refused() {
        let settings = Settings { rays: 50, memory: 1000, isa: Isa::Portable };
        let error = walks(&source(), &settings).expect_err("100 triangles take more than 1000 B");
        assert!(error.to_string().contains("more than the 1000"), "{error}");
    }
}
