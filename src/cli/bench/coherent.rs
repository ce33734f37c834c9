//! `dapple bench coherent`: the tables of path compression.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::options::{MachineArgs, parse_builder, ray_bytes};
use super::output::{OutputArgs, Results};
use super::scenes::BenchScene;
use crate::bench::fly_through::{self, FlyThroughBenchSettings, paper};
use crate::camera::flight::{self, Pose};
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, whole};
use crate::cli::settings::parse::resolution;
use crate::cli::{input, memory};
use crate::files;
use crate::generate::Generator;
use crate::geom::TriangleSource;

/// Packets, entry points and compressed paths over flights: the tables of Barczak's paper, next to
/// its figures.
///
/// On one thread, primary rays that were made before: nodes visited (table 1), rates of packets
/// (2), memory and construction of compressed paths (3), partitioned packets and single rays (4),
/// what a node spared is worth, entry points by fixed tiles and by adaptive ones, and rays to
/// lights of limited range, to spot lights and to lights with an area. Structures take turns,
/// picture by picture, and the median of the rounds counts. First all answers are compared to those
/// of bvh-packet.
///
/// Without files, the scenes are a machine of 871,414 triangles from afar, a city of 9,200, a
/// kitchen of 103,000 and a landscape of 644,000, as `dapple generate` makes them with their
/// flights: the sizes of the paper's. That takes some twelve minutes; --frames 4 --rounds 1 some
/// three.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench coherent --report out
  dapple bench coherent --frames 4 --rounds 1 --resolution 512x512
  dapple generate city --triangles 50000 -o city.glb --path city.txt
  dapple bench coherent city.glb --path city.txt --json")]
pub struct CoherentArgs {
    /// Scene files, or .npy of (N, 9) float32 triangles
    #[arg(requires = "path")]
    files: Vec<PathBuf>,
    /// A file of cameras for each scene, in the same order: a line each, eye, target, up (three
    /// numbers each) and the angle of view in degrees
    #[arg(long, value_name = "FILE", requires = "files")]
    path: Vec<PathBuf>,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "1024x1024", value_parser = resolution)]
    resolution: (u32, u32),
    /// Cameras of a flight that are taken, evenly along it, at most
    #[arg(long, value_name = "N", default_value_t = 12)]
    #[arg(value_parser = whole(1..=100_000_usize))]
    frames: usize,
    /// Timed passes of each structure over each picture
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = whole(1..=1000_usize))]
    rounds: usize,
    /// How trees are built; see the option `build` in `dapple accels`
    #[arg(long, default_value = "binned", value_parser = parse_builder)]
    build: &'static str,
    #[command(flatten)]
    machine: MachineArgs,
    #[command(flatten)]
    quiet: Quiet,
    #[command(flatten)]
    output: OutputArgs,
}

/// The scenes that are compared with the paper's, in its order.
const MADE: [Generator; 4] =
    [Generator::Assembly, Generator::City, Generator::Kitchen, Generator::Landscape];

/// What is measured: a name, triangles and cameras.
type Loaded = (String, Arc<dyn TriangleSource>, Vec<Pose>);

/// Runs the command.
pub fn run(args: &CoherentArgs) -> Result<(), CliError> {
    if args.files.len() != args.path.len() {
        let (scenes, paths) = (args.files.len(), args.path.len());
        let message =
            format!("{scenes} scenes and {paths} --path: each scene needs one of its own");
        return Err(CliError::Usage(message));
    }
    let (width, height) = args.resolution;
    let rays = u64::from(width) * u64::from(height);
    // A picture's rays and their answers, and shadow rays with theirs.
    memory::require(&format!("pictures of {width}x{height}"), ray_bytes(rays, 4))?;
    args.output.probe()?;
    let isa = args.machine.isa()?;
    let settings = FlyThroughBenchSettings {
        resolution: args.resolution,
        frames: args.frames,
        rounds: args.rounds,
        build: args.build,
        memory: args.machine.memory_limit(),
        isa,
    };
    let tell = |what: &str| args.quiet.tell(what);
    let measured = input::run_on_threads(1, || {
        let measure = |load: Box<dyn Fn() -> Result<Loaded, CliError>>| {
            let (name, source, flight) = load()?;
            Ok::<_, CliError>(fly_through::measure(&name, &source, &flight, &settings, &tell)?)
        };
        plan_scenes(args).into_iter().map(measure).collect::<Result<Vec<_>, _>>()
    })??;
    let results = Results {
        name: "coherent",
        tables: fly_through::make_tables(&measured, &settings),
        json: fly_through::to_json(&measured, &settings),
        plots: fly_through::draw_plots(&measured),
    };
    results.publish(&args.output)
}

/// How each scene is loaded.
fn plan_scenes(args: &CoherentArgs) -> Vec<Box<dyn Fn() -> Result<Loaded, CliError> + '_>> {
    let quiet = args.quiet;
    if args.files.is_empty() {
        let pairs = MADE.into_iter().zip(paper::SCENES);
        let load = |(generator, paper): (Generator, paper::Scene)| {
            let triangles = paper.triangles as u64;
            let scene = BenchScene::Made(generator, triangles);
            Box::new(move || {
                let source = scene.with_file(|path| input::load_triangles(path, quiet))?;
                Ok((generator.name().to_owned(), source, generator.flight(triangles, 0)))
            }) as Box<dyn Fn() -> _>
        };
        return pairs.map(load).collect();
    }
    let load = |(file, path): (&PathBuf, &PathBuf)| {
        let (scene, path) = (BenchScene::File(file.clone()), path.clone());
        Box::new(move || {
            // What is short first.
            let flight = read_flight(&path)?;
            Ok((scene.name(), scene.with_file(|path| input::load_triangles(path, quiet))?, flight))
        }) as Box<dyn Fn() -> _>
    };
    args.files.iter().zip(&args.path).map(load).collect()
}

fn read_flight(path: &Path) -> Result<Vec<Pose>, CliError> {
    let shown = path.display();
    let text = fs::read_to_string(path)
        .map_err(|error| CliError::Input(format!("{shown}: {}", files::why_unread(&error))))?;
    flight::parse(&text).map_err(|error| CliError::Input(format!("{shown}: {error}")))
}
