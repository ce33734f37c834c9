//! `dapple bench mbvh`: the tables of multi bounding volume hierarchies.

use std::path::PathBuf;

use super::options::{MachineArgs, parse_builder, ray_bytes};
use super::output::{OutputArgs, Results};
use super::scenes::choose_scenes;
use crate::bench::mbvh::{self, MbvhBenchSettings};
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, whole};
use crate::cli::{input, memory};

/// bvh2, mbvh4, mbvh8, mbvh16 and auto: the tables of Ernst and Greiner's paper, next to its
/// figures.
///
/// On one thread: construction (table 1), random rays with and without a cache of triangles (2),
/// the size of that cache, on the largest scene (3), width (4), and packets of rays that lose their
/// coherence (figure 4). Rays run from and to random points of the scene's box. Structures take
/// turns, and the median of the rounds counts. First all answers are compared to those of bvh2.
///
/// Without files, the scenes are machines of 69,451, 334,080, 770,534 and 4,304,391 triangles as
/// `dapple generate assembly` makes them, the sizes of the paper's. That takes some three hours;
/// --rays 200000 gives a first impression in five minutes, though few rays hardly fill a cache.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench mbvh --report out
  dapple bench mbvh --rays 200000 --rounds 1
  dapple bench mbvh hall.glb bunny.obj --build sweep --json")]
pub struct MbvhArgs {
    /// Scene files, or .npy of (N, 9) float32 triangles
    files: Vec<PathBuf>,
    /// Rays of each kind; a tenth of them at each point of figure 4
    #[arg(long, value_name = "N", default_value_t = 10_000_000)]
    #[arg(value_parser = whole(1..=1_000_000_000_u64))]
    rays: u64,
    /// Timed passes of each structure
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = whole(1..=1000_usize))]
    rounds: usize,
    /// How trees are built; see the option `build` in `dapple accels`
    #[arg(long, default_value = "binned", value_parser = parse_builder)]
    build: &'static str,
    /// Refine all trees by reinsertion, bvh2's too; auto's always is
    #[arg(long)]
    refine: bool,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    quiet: Quiet,
    #[command(flatten)]
    output: OutputArgs,
}

/// With fewer rays, a pass takes less than some tenths of a second.
const FEW_RAYS: u64 = 100_000;

/// Runs the command.
pub fn run(args: &MbvhArgs) -> Result<(), CliError> {
    // A set, its answers, and those that are compared with them.
    memory::require(&format!("{} rays", args.rays), ray_bytes(args.rays, 2))?;
    args.output.probe()?;
    let isa = args.machine.isa()?;
    let settings = MbvhBenchSettings {
        rays: args.rays as usize,
        rounds: args.rounds,
        build: args.build,
        refine: args.refine,
        memory: args.machine.memory_limit(),
        isa,
    };
    let tell = |what: &str| args.quiet.tell(what);
    if args.rays < FEW_RAYS {
        tell(&format!(
            "warning: {} rays of a kind take milliseconds, and times so short say little; \
             --rays 200000 gives a first impression",
            args.rays
        ));
    }
    let mut loaded = Vec::new();
    for scene in choose_scenes(&args.files) {
        tell(&format!("{}: loading", scene.name()));
        let source = scene.with_file(|path| input::load_triangles(path, args.quiet))?;
        loaded.push((scene.name(), source));
    }
    let largest = loaded.iter().map(|(_, source)| source.len()).max();
    // One thread in all: caches share their bytes among the threads of the pool.
    let measured = input::run_on_threads(1, || {
        let mut caches = true;
        let measure = |(name, source): &(String, _)| {
            let source: &std::sync::Arc<dyn crate::geom::TriangleSource> = source;
            // Of scenes of equal size the first.
            let largest = Some(source.len()) == largest && std::mem::take(&mut caches);
            mbvh::measure(name, source, largest, &settings, &tell)
        };
        loaded.iter().map(measure).collect::<Result<Vec<_>, _>>()
    })??;
    let plot = |scene: &mbvh::Scene| {
        (format!("incoherence-{}", scene.name), mbvh::draw_incoherence(scene))
    };
    let plots = std::iter::once(("scaling".to_owned(), mbvh::draw_scaling(&measured)));
    let results = Results {
        name: "mbvh",
        tables: mbvh::make_tables(&measured, &settings),
        json: mbvh::to_json(&measured, &settings),
        plots: plots.chain(measured.iter().map(plot)).collect(),
    };
    results.publish(&args.output)
}
