//! All structures with their defaults, a row each: the table of `docs/structures.md`.

use std::sync::Arc;

use serde_json::{Value, json};

use super::fly_through::frame::Frame;
use super::measure::{Ask, BenchError, Shots, time_interleaved};
use super::ray_sets::{RaySet, Target};
use super::table::{Table, cell};
use crate::accel::{Accel, AccelSpec, BuildError, VARIANTS, Variant, build};
use crate::camera::Camera;
use crate::camera::flight::Pose;
use crate::geom::TriangleSource;
use crate::math::{Aabb, PrimId, Vec3};
use crate::simd::Isa;

/// What others are compared with.
const ORACLE: &str = "bvh2";
/// Rays that are asked about at once.
const SLICE: usize = 4096;
/// Sides of a tile of the picture, pixels.
const TILE: u32 = 64;
/// Tests of a ray and a triangle that brute force may make.
const BRUTE_TESTS: usize = 200_000_000;

/// What to measure with.
#[derive(Clone, Copy, Debug)]
pub struct AccelsBenchSettings {
    /// Rays of each kind.
    pub rays: usize,
    /// Passes of each structure; the median counts.
    pub rounds: usize,
    /// Which structures are measured, by id.
    pub wanted: fn(&str) -> bool,
    /// Bytes that all may take by the estimate.
    pub memory: u64,
    /// The instruction set.
    pub isa: Isa,
}

/// A structure's figures.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its row in the table of structures.
    pub variant: &'static Variant,
    /// Seconds to build it, on one thread.
    pub build_seconds: f64,
    /// All its bytes.
    pub bytes: usize,
    /// Millions of random rays a second, by slices.
    pub random: f64,
    /// Millions of primary rays a second, by tiles.
    pub primary: f64,
}

/// Measures structures over a scene: random rays, and a picture from a camera or else from
/// outside; `tell` is told what is being done.
///
/// # Errors
/// If a structure can't be built or would not fit, or disagrees with `bvh2`.
pub fn measure(
    source: &Arc<dyn TriangleSource>,
    pose: Option<Pose>,
    settings: &AccelsBenchSettings,
    tell: &dyn Fn(&str),
) -> Result<Vec<Row>, BenchError> {
    // Two structures at a time, one of them the oracle.
    let needed = source.len() as u64 * 1500 + settings.rays as u64 * 160;
    if needed > settings.memory {
        return Err(BuildError::TooLarge { needed, limit: settings.memory }.into());
    }
    let built = |variant: &'static Variant| {
        let spec = AccelSpec::of(variant);
        build(&spec, Arc::clone(source), settings.isa)
    };
    let oracle = VARIANTS.iter().find(|variant| variant.id == ORACLE).expect("is in the table");
    let oracle = built(oracle)?;
    let random = Target::new(&**source, &*oracle).rays(RaySet::Random, settings.rays, 1);
    let side = (settings.rays as f64).sqrt().ceil().clamp(1.0, 16_384.0) as u32;
    let pose = pose.unwrap_or_else(|| frame_camera(&**source));
    let picture = Frame::new(&pose, (side, side), side.div_ceil(TILE));
    let mut rows = Vec::new();
    for variant in VARIANTS.iter().filter(|variant| (settings.wanted)(variant.id)) {
        tell(&format!("{}: building", variant.id));
        let accel = built(variant)?;
        tell(&format!("{}: shooting", variant.id));
        // Brute force has no time for all of them.
        let most =
            if variant.id == "brute" { BRUTE_TESTS / source.len().max(1) } else { usize::MAX };
        let shoot = |rays: &[_], set: &'static str, tiles: bool| {
            let few = most.clamp(1, rays.len());
            let shots = Shots::new(&rays[..few], Ask::Closest, SLICE);
            let whole = tiles && few == rays.len();
            let seconds = |accel: &dyn Accel| {
                if whole { picture.time(&mut *accel.tracer()) } else { shots.time(accel) }
            };
            let answers = |accel: &dyn Accel| {
                if whole { picture.trace(accel) } else { shots.trace(accel) }
            };
            answers(&*accel).check(&answers(&*oracle), variant.id, ORACLE, set)?;
            let seconds =
                time_interleaved(1, settings.rounds, |_| Ok::<_, BenchError>(seconds(&*accel)))?;
            Ok::<_, BenchError>(few as f64 * 1e-6 / seconds[0].max(1e-9))
        };
        rows.push(Row {
            variant,
            build_seconds: accel.report().seconds(),
            bytes: accel.memory().total(),
            random: shoot(&random, "random", false)?,
            primary: shoot(&picture.rays, "primary", true)?,
        });
    }
    Ok(rows)
}

/// A camera that sees all triangles.
fn frame_camera(source: &dyn TriangleSource) -> Pose {
    const YFOV: f32 = 40.0;
    let ids = (0..source.len()).map(PrimId::from_index);
    let bounds = ids.map(|id| source.triangle(id).bounds()).fold(Aabb::EMPTY, Aabb::union);
    let camera = Camera::framing(&bounds, YFOV.to_radians(), 1.0).to_world;
    let eye = Vec3::from(camera.translation);
    Pose::new(eye, eye - Vec3::from(camera.matrix3.z_axis) * eye.abs().max_element().max(1.0), YFOV)
}

fn describe(scene: &str, triangles: usize) -> String {
    format!(
        "{scene}, {triangles} triangles, one thread, defaults. MB: all that a structure takes. \
         Millions of rays a second: random ones by slices of {SLICE}, primary ones by tiles of \
         {TILE}x{TILE} pixels."
    )
}

fn cells(row: &Row) -> [String; 4] {
    [(row.bytes as f64 * 1e-6, 1), (row.build_seconds, 2), (row.random, 3), (row.primary, 3)]
        .map(|(x, decimals)| cell(Some(x), decimals))
}

const FIGURES: [&str; 4] = ["MB", "build s", "random", "primary"];

/// The figures, for the terminal.
pub fn make_table(rows: &[Row], scene: &str, triangles: usize) -> Table {
    let heading = [&[""], &FIGURES[..]].concat();
    let mut table = Table::new("Structures", describe(scene, triangles), &heading);
    let line = |row: &Row| {
        let id = std::iter::once(row.variant.id.to_owned());
        id.chain(cells(row)).collect()
    };
    table.rows = rows.iter().map(line).collect();
    table
}

/// The same with summaries and papers, for the documentation.
pub fn to_markdown(rows: &[Row], scene: &str, triangles: usize) -> String {
    let mut text = format!(
        "| id | what | paper | {} |\n|---|---|---|{}\n",
        FIGURES.join(" | "),
        "---:|".repeat(FIGURES.len())
    );
    for row in rows {
        let Variant { id, summary, paper, .. } = row.variant;
        let line = format!("| `{id}` | {summary} | {paper} | {} |\n", cells(row).join(" | "));
        text.push_str(&line);
    }
    text + "\n" + &describe(scene, triangles) + "\n"
}

/// The same for programs.
pub fn to_json(rows: &[Row], scene: &str, triangles: usize) -> Value {
    let row = |row: &Row| {
        json!({
            "accel": row.variant.id,
            "paper": row.variant.paper,
            "bytes": row.bytes,
            "build_s": row.build_seconds,
            "random_mrays_s": row.random,
            "primary_mrays_s": row.primary,
        })
    };
    json!({
        "scene": scene,
        "triangles": triangles,
        "threads": 1,
        "structures": rows.iter().map(row).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::{Triangle, TriangleList};

    #[test]
    fn every_structure_has_a_row_with_its_figures() {
        let triangle = |i: u16| {
            let a = Vec3::new(f32::from(i % 7), f32::from(i % 5), f32::from(i % 11));
            Triangle { a, b: a + Vec3::X, c: a + Vec3::Y }
        };
        let source: Arc<dyn TriangleSource> =
            Arc::new(TriangleList((0..300).map(triangle).collect()));
        let (memory, isa) = (1 << 30, Isa::Auto);
        let settings = AccelsBenchSettings { rays: 500, rounds: 1, wanted: |_| true, memory, isa };
        let rows = measure(&source, None, &settings, &|_| {}).expect("all agree");
        let ids: Vec<_> = rows.iter().map(|row| row.variant.id).collect();
        assert_eq!(ids, VARIANTS.iter().map(|variant| variant.id).collect::<Vec<_>>());
        let brute = |row: &&Row| row.variant.id == "brute";
        assert!(rows.iter().filter(|row| !brute(row)).all(|row| row.bytes > 0 && row.random > 0.0));
        let text = to_markdown(&rows, "cloud", 300);
        assert!(VARIANTS.iter().all(|variant| text.contains(&format!("| `{}` |", variant.id))));
        assert_eq!(make_table(&rows, "cloud", 300).rows.len(), rows.len());
        assert_eq!(
            to_json(&rows, "cloud", 300)["structures"].as_array().map(Vec::len),
            Some(rows.len())
        );
        let one = AccelsBenchSettings { wanted: |id| id == "mbvh4", ..settings };
        let rows = measure(&source, None, &one, &|_| {}).expect("all agree");
        assert_eq!(rows.iter().map(|row| row.variant.id).collect::<Vec<_>>(), ["mbvh4"]);
        let small = AccelsBenchSettings { memory: 1000, ..settings };
        assert!(measure(&source, None, &small, &|_| {}).is_err());
    }
}
