//! `dapple bench render`: whole renders per structure.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde_json::json;

use super::output::{OutputArgs, Results};
use super::scenes::{BenchScene, choose_scenes};
use crate::accel::{Accel, AccelSpec, build};
use crate::bench::bars::draw_bars;
use crate::bench::breakdown::{self, Breakdown};
use crate::bench::renders::{self, Rendered, Scene};
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, parse_accels, whole};
use crate::cli::job::Job;
use crate::cli::settings::parse::threads;
use crate::cli::settings::resolve_words;
use crate::cli::{input, memory};
use crate::geom::TriangleSource;
use crate::render::{Aov, Control, Stage, film_bytes, render};
use crate::simd::Isa;

/// Whole renders per structure: figure 1 of Ernst and Greiner's paper, its speed-ups next to ours.
///
/// Structures take turns, and the median of the rounds counts, without loading and building. All
/// pictures must be equal to the bit.
///
/// Without files, the scenes are machines of 69,451, 334,080, 770,534 and 4,304,391 triangles as
/// `dapple generate assembly` makes them, the sizes of the paper's. The paper took 256 samples a
/// pixel on one core; the default is a sixteenth of that, and takes some hours.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  dapple bench render --spp 4 --rounds 1 --threads 0
  dapple bench render kitchen.glb --accel auto --breakdown
  dapple bench render kitchen.glb --accel bvh2,mbvh8,mbvh8:triangles=cache --report out")]
pub struct BenchRenderArgs {
    /// Scenes: .gltf, .glb, .obj, .ply or .toml
    files: Vec<PathBuf>,
    /// Structures, separated by commas; speed-ups are over the first
    #[arg(long, default_value = "bvh2,mbvh4,mbvh8,mbvh16,kd-stack-direction")]
    accel: String,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "500x500")]
    resolution: String,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = whole(1..=1_u64 << 32))]
    spp: u64,
    /// Renders of each structure
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = whole(1..=1000_usize))]
    rounds: usize,
    /// Threads to build and render with; 0: one per core
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    threads: usize,
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    #[command(flatten)]
    quiet: Quiet,
    /// Also tell where the time of the renders goes, stage by stage
    #[arg(long)]
    breakdown: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// The most segments of a path, as in the paper.
const DEPTH: u32 = 20;

/// Runs the command.
pub fn run(args: &BenchRenderArgs) -> Result<(), CliError> {
    let specs = parse_accels(&args.accel)?;
    if specs.iter().any(|spec| spec.variant.id == "brute") {
        let message = "--accel: brute force takes forever here; leave it out".to_owned();
        return Err(CliError::Usage(message));
    }
    args.output.probe()?;
    let run = RenderRun {
        resolution: &args.resolution,
        spp: args.spp,
        rounds: args.rounds,
        isa: args.isa,
        quiet: args.quiet,
    };
    let measured = input::run_on_threads(args.threads, || {
        let measure = |scene: &BenchScene| measure(&run, &specs, scene);
        choose_scenes(&args.files).iter().map(measure).collect::<Result<Vec<_>, _>>()
    })??;
    let (measured, breakdowns): (Vec<Scene>, Vec<Vec<Breakdown>>) = measured.into_iter().unzip();
    let breakdowns: Vec<Breakdown> = breakdowns.into_iter().flatten().collect();
    let how = format!(
        "{} pixels, {} samples a pixel, depth {DEPTH}, {} threads",
        args.resolution,
        args.spp,
        match args.threads {
            0 => "all".to_owned(),
            threads => threads.to_string(),
        }
    );
    let results = Results {
        name: "render",
        tables: if args.breakdown {
            vec![renders::make_table(&measured, &how), breakdown::make_table(&breakdowns)]
        } else {
            vec![renders::make_table(&measured, &how)]
        },
        json: json!({
            "resolution": args.resolution,
            "spp": args.spp,
            "max_depth": DEPTH,
            "threads": args.threads,
            "rounds": args.rounds,
            "scenes": measured.iter().map(Scene::json).collect::<Vec<_>>(),
            "breakdowns": breakdowns.iter().map(Breakdown::json).collect::<Vec<_>>(),
        }),
        plots: vec![("speed-ups".to_owned(), draw_chart(&measured))],
    };
    results.publish(&args.output)
}

/// How scenes are rendered.
pub(super) struct RenderRun<'a> {
    /// Pixels, as the flag has them.
    pub resolution: &'a str,
    /// Samples per pixel.
    pub spp: u64,
    /// Renders of each structure.
    pub rounds: usize,
    /// The instruction set.
    pub isa: Isa,
    /// Whether nothing is told.
    pub quiet: Quiet,
}

/// Loads a scene, builds all structures and renders by turns, on the threads of the caller's pool.
///
/// # Errors
/// If the scene can't be loaded, a structure can't be built or would not fit, or pictures differ.
pub(super) fn measure(
    args: &RenderRun<'_>,
    specs: &[AccelSpec],
    scene: &BenchScene,
) -> Result<(Scene, Vec<Breakdown>), CliError> {
    let tell = |what: &str| args.quiet.tell(&format!("{}: {what}", scene.name()));
    tell("loading");
    // The time of a sample is the one layer that differs from run to run.
    let layers = Aov::ALL.into_iter().filter(|&aov| aov != Aov::Cost).map(Aov::name);
    let layers = layers.collect::<Vec<_>>().join(",");
    let (spp, depth) = (args.spp.to_string(), DEPTH.to_string());
    let words = [
        ["--resolution", args.resolution],
        ["--spp", &spp],
        ["--max-depth", &depth],
        ["--aov", &layers],
    ];
    let words = words.concat().into_iter().map(str::to_owned).collect::<Vec<_>>();
    let job = scene.with_file(|path| Job::prepare(resolve_words(path, &words)?.args))?;
    // One to compare with, and one under way.
    let what = format!("two pictures of {}", args.resolution);
    memory::require(&what, film_bytes(&job.settings) * 2)?;
    let mut structures: Vec<(String, f64)> = Vec::new();
    let mut accels: Vec<Box<dyn Accel>> = Vec::new();
    for spec in specs {
        tell(&format!("building {spec}"));
        let start = Instant::now();
        accels.push(build(spec, job.staged.world.triangles.clone(), args.isa)?);
        structures.push((spec.to_string(), start.elapsed().as_secs_f64()));
    }
    let name = (scene.name(), job.staged.world.triangles.len());
    let mut breakdowns: Vec<Breakdown> =
        structures.iter().map(|(spec, _)| start_breakdown(&name.0, spec)).collect();
    let scene = renders::measure(name, &structures, args.rounds, |which| {
        tell(&format!("rendering by {}", structures[which].0));
        render_once(&job, &*accels[which], &mut breakdowns[which])
    });
    Ok((scene?, breakdowns))
}

fn start_breakdown(scene: &str, spec: &str) -> Breakdown {
    Breakdown {
        scene: scene.to_owned(),
        spec: spec.to_owned(),
        paths: 0,
        seconds: 0.0,
        threads: rayon::current_num_threads(),
        stages: Vec::new(),
        writing: 0.0,
    }
}

/// Renders, and tells where the time went; writing is timed by a file that is not kept.
fn render_once(job: &Job, accel: &dyn Accel, breakdown: &mut Breakdown) -> Rendered {
    let control = Control { cancel: &AtomicBool::new(false), progress: &|_| {} };
    let rendered = render(&job.staged.world, &job.staged.camera, accel, &job.settings, &control);
    let stages = Stage::ALL.map(|stage| (stage.name(), rendered.breakdown.seconds(stage)));
    breakdown.add(rendered.paths, rendered.elapsed.as_secs_f64(), &stages);
    let start = Instant::now();
    if let Ok(bytes) = rendered.picture.encode_exr() {
        breakdown.writing = start.elapsed().as_secs_f64();
        drop(bytes);
    }
    Rendered {
        picture: rendered.picture,
        rays: rendered.rays.total(),
        seconds: rendered.elapsed.as_secs_f64(),
    }
}

/// Speed-ups by scene.
fn draw_chart(scenes: &[Scene]) -> String {
    let names: Vec<&str> =
        scenes.first().into_iter().flat_map(|scene| &scene.rows).map(|row| &*row.spec).collect();
    let speed_ups = |scene: &Scene| scene.rows.iter().map(|row| scene.speed_up(row)).collect();
    let rows: Vec<_> = scenes.iter().map(|scene| (scene.name.clone(), speed_ups(scene))).collect();
    draw_bars("Whole renders", "speed-up over the first", &names, &rows)
}
