//! Short runs of the benches, whose figures are compared with those of files.

use std::num::NonZero;

use serde_json::{Value, json};

use crate::bench::fly_through::{self, FlyThroughBenchSettings};
use crate::bench::kd::{self, KdBenchSettings, Row};
use crate::bench::mbvh::{self, MbvhBenchSettings};
use crate::bench::renders::Scene;
use crate::bench::results::cells::is_quick;
use crate::bench::results::short_run::{Made, ShortRun, What};
use crate::bench::structures::{self, AccelsBenchSettings};
use crate::cli::bench::options::parse_builder;
use crate::cli::bench::render::{self, RenderRun};
use crate::cli::bench::scenes::BenchScene;
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, parse_accels};
use crate::cli::input;
use crate::files;
use crate::simd::Isa;

/// Passes of each structure; the median counts.
const ROUNDS: usize = 5;
/// Passes over a flight, whose pictures are many rays.
const FLIGHT_ROUNDS: usize = 3;

/// Measures, and gives what the bench would write.
///
/// # Errors
/// Those of the bench, or values in the file that no bench knows.
pub fn measure(run: &ShortRun, quiet: Quiet) -> Result<Value, CliError> {
    let threads = match run.what {
        // A file may tell of more threads than there are cores here.
        What::Render { threads, .. } => {
            threads.min(std::thread::available_parallelism().map_or(1, NonZero::get))
        }
        _ => 1,
    };
    let measured = input::run_on_threads(threads, || measure_here(run, quiet))??;
    // As it would be read from a file, digit by digit.
    let text = measured.to_string();
    serde_json::from_str(&text).map_err(|error| CliError::Output(error.to_string()))
}

/// The same on the threads of this pool.
fn measure_here(run: &ShortRun, quiet: Quiet) -> Result<Value, CliError> {
    let memory = files::memory::limit() / 4 * 3;
    let isa = Isa::Auto;
    let Made { generator, triangles } = run.scene;
    let scene = BenchScene::Made(generator, triangles);
    let name = scene.name();
    let tell = |what: &str| quiet.tell(what);
    let load = || scene.with_file(|path| input::load_triangles(path, quiet));
    match &run.what {
        &What::Accels { rays } => {
            let pose = generator.flight(triangles, 0)[0];
            let (rays, rounds, wanted) = (rays as usize, ROUNDS, is_quick as fn(&str) -> bool);
            let settings = AccelsBenchSettings { rays, rounds, wanted, memory, isa };
            let source = load()?;
            let rows = structures::measure(&source, Some(pose), &settings, &tell)?;
            Ok(structures::to_json(&rows, &name, source.len()))
        }
        &What::Kd { rays } => {
            let settings = KdBenchSettings { rays: rays as usize, memory, isa };
            tell(&format!("{name}: kd-trees"));
            let walks = kd::measure_walks(&load()?, &settings)?;
            Ok(json!({ "walks": walks.iter().map(Row::json).collect::<Vec<_>>() }))
        }
        What::Mbvh { rays, build, refine } => {
            let (rays, rounds, build) = (*rays as usize, ROUNDS, parse(build)?);
            let settings = MbvhBenchSettings { rays, rounds, build, refine: *refine, memory, isa };
            let scene = mbvh::measure(&name, &load()?, false, &settings, &tell)?;
            Ok(mbvh::to_json(&[scene], &settings))
        }
        What::Coherent { resolution, pictures, build, .. } => {
            let settings = FlyThroughBenchSettings {
                resolution: *resolution,
                frames: *pictures,
                rounds: FLIGHT_ROUNDS,
                build: parse(build)?,
                memory,
                isa,
            };
            let source = load()?;
            let flight = generator.flight(triangles, 0);
            let scene = fly_through::measure(&name, &source, &flight, &settings, &tell)?;
            Ok(fly_through::to_json(&[scene], &settings))
        }
        What::Render { resolution: (width, height), spp, accels, .. } => {
            let resolution = format!("{width}x{height}");
            let specs = parse_accels(&accels.join(","))
                .map_err(|error| CliError::Input(format!("structures: {error}")))?;
            if specs.iter().any(|spec| spec.variant.id == "brute") {
                let why = "structures: brute force takes forever here".to_owned();
                return Err(CliError::Input(why));
            }
            let run = RenderRun { resolution: &resolution, spp: *spp, rounds: ROUNDS, isa, quiet };
            let (scene, _) = render::measure(&run, &specs, &scene)?;
            Ok(json!({ "scenes": [Scene::json(&scene)] }))
        }
    }
}

fn parse(build: &str) -> Result<&'static str, CliError> {
    parse_builder(build).map_err(|error| CliError::Input(format!("build `{build}`: {error}")))
}
