//! `dapple bench accels`: a row for each structure.

use std::path::PathBuf;

use super::options::MachineArgs;
use super::output::{OutputArgs, Results};
use super::scenes::{BenchScene, KITCHEN};
use crate::bench::structures::{self, AccelsBenchSettings};
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, whole};
use crate::cli::{input, text};
use crate::generate::Generator;

/// All structures with their defaults: paper, memory and rates, a row each.
///
/// On one thread: nearest hits of random rays by slices of 4096, and of a picture by tiles of 64 by
/// 64 pixels, the median of the rounds. One structure is built and measured after the other: on a
/// machine that does other things besides, only `bench mbvh`, `coherent` and `render`, where
/// structures take turns, compare well. Before one is timed, its answers are compared to those of
/// bvh2.
///
/// Without a file, the scene is the kitchen of 103,000 triangles that `dapple generate` makes.
/// --markdown prints the table of docs/structures.md.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench accels
  dapple bench accels --markdown
  dapple bench accels bunny.obj --rays 1000000 --rounds 5 --json")]
pub struct BenchAccelsArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles
    file: Option<PathBuf>,
    /// Rays of each kind; brute force gets a few of them
    #[arg(long, value_name = "N", default_value_t = 250_000)]
    #[arg(value_parser = whole(1..=100_000_000_u64))]
    rays: u64,
    /// Timed passes of each structure
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = whole(1..=1000_usize))]
    rounds: usize,
    #[command(flatten)]
    machine: MachineArgs,
    /// Print the table as Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    #[command(flatten)]
    quiet: Quiet,
    #[command(flatten)]
    output: OutputArgs,
}

/// Runs the command.
pub fn run(args: &BenchAccelsArgs) -> Result<(), CliError> {
    args.output.probe()?;
    let isa = args.machine.isa()?;
    let scene = match &args.file {
        Some(file) => BenchScene::File(file.clone()),
        None => BenchScene::Made(Generator::Kitchen, KITCHEN),
    };
    let quiet = args.quiet;
    let source = scene.with_file(|path| input::load_triangles(path, quiet))?;
    // Its own flight leads through a scene that was made.
    let pose = args.file.is_none().then(|| Generator::Kitchen.flight(KITCHEN, 0)[0]);
    let settings = AccelsBenchSettings {
        rays: args.rays as usize,
        rounds: args.rounds,
        wanted: |_| true,
        memory: args.machine.memory_limit(),
        isa,
    };
    let tell = |what: &str| args.quiet.tell(what);
    let rows = input::run_on_threads(1, || structures::measure(&source, pose, &settings, &tell))??;
    let mut json = structures::to_json(&rows, &scene.name(), source.len());
    json["rays"] = args.rays.into();
    json["rounds"] = args.rounds.into();
    let results = Results {
        name: "accels",
        tables: vec![structures::make_table(&rows, &scene.name(), source.len())],
        json,
        plots: Vec::new(),
    };
    if args.markdown {
        let text = structures::to_markdown(&rows, &scene.name(), source.len());
        return Ok(text::print(&text)?);
    }
    results.publish(&args.output)
}
