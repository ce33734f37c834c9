//! `dapple trace`: a file of rays in, hits out.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde_json::json;

use crate::accel::{Accel, AccelSpec, AnyHit, Batch, ClosestHit, Counts, Event, Tracer, build};
use crate::bench::ray_sets::from_rows;
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, whole};
use crate::cli::outputs::{self, Output};
use crate::cli::settings::parse::threads;
use crate::cli::{input, memory, text};
use crate::formats::npy;
use crate::geom::TriangleSource;
use crate::math::Ray;
use crate::simd::Isa;

/// Shoot a file of rays at a scene and time it.
///
/// Rays are rows of eight float32 (origin, t_min, direction, t_max) in an .npy file. Hits are rows
/// of four float32: t (infinity on a miss), u, v and the triangle's number as its bits; in scenes
/// of 2^32 triangles and more of five: placement and number in the mesh. With --any they are one
/// byte per ray. The time is from rays to hits, both in memory, after an untimed pass.
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:\n  dapple trace bunny.obj --rays rays.npy --hits hits.npy\n  \
    dapple trace tris.npy --rays rays.npy --any --accel bvh2 --threads 1 --repeat 5 --json\n  \
    dapple trace tris.npy --rays primary.npy --width 1024 --accel bvh-packet --counters")]
pub struct TraceArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles, numbered in that order
    scene: PathBuf,
    /// The rays
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// Where to write the hits
    #[arg(long, value_name = "FILE")]
    hits: Option<PathBuf>,
    /// Only ask whether anything is hit
    #[arg(long)]
    any: bool,
    /// The structure; `dapple accels` lists them
    #[arg(long, value_name = "ID[:option=value,…]", default_value = "auto")]
    accel: AccelSpec,
    /// The instruction set; never changes a hit
    #[arg(long, default_value_t)]
    isa: Isa,
    /// Threads to build and shoot with; 0: one per core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Timed passes; the median counts
    #[arg(long, value_name = "N", default_value_t = 1)]
    #[arg(value_parser = whole(1..=1_000_000_u32))]
    repeat: u32,
    /// Ask ray by ray, in slices of one
    #[arg(long)]
    single: bool,
    /// Width of the raster whose pixels the rays are, row by row: structures for coherent rays gain
    #[arg(long, value_name = "N", conflicts_with = "single")]
    #[arg(value_parser = whole(1..=65_536_u32))]
    width: Option<u32>,
    /// Count the work of a further pass
    #[arg(long)]
    counters: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    quiet: Quiet,
}

/// Rays that a thread takes at once; `validate` replays slices of up to as many.
pub const SLICE: usize = 4096;

/// How rays are handed over.
#[derive(Clone, Copy)]
enum Slices {
    /// One by one.
    Single,
    /// In runs of [`SLICE`].
    Runs,
    /// In bands of whole rows of a raster of that width, high enough for square packets.
    Bands(usize),
}

impl Slices {
    /// Rows of the tallest packets.
    const BAND: usize = 16;

    fn new(args: &TraceArgs) -> Self {
        match args.width {
            Some(width) => Self::Bands(width as usize),
            None if args.single => Self::Single,
            None => Self::Runs,
        }
    }

    /// Rays that are read at once, and rays of a slice of these.
    fn lengths(self) -> (usize, usize) {
        match self {
            Self::Single => (SLICE, 1),
            Self::Runs => (SLICE, SLICE),
            Self::Bands(width) => {
                let band = width * (SLICE / width).next_multiple_of(Self::BAND).max(Self::BAND);
                (band, band)
            }
        }
    }

    fn batch(self, rays: &[Ray]) -> Batch<'_> {
        match self {
            Self::Bands(width) => {
                Batch::new(rays).with_grid(width as u32, (rays.len() / width) as u32)
            }
            _ => Batch::new(rays),
        }
    }
}

/// The answers to all rays.
enum Answers {
    Closest(Vec<ClosestHit>),
    Any(Vec<AnyHit>),
}

/// Runs the command.
pub fn run(args: &TraceArgs) -> Result<ExitCode, CliError> {
    let hits = args.hits.as_deref();
    let hits = hits.map(|path| Output { flag: "--hits", path, ending: "npy" });
    outputs::check(hits.as_slice(), &[&args.scene, &args.rays])?;
    // A hit is half as long as a ray. The file's rows are in memory, too, until rays are made.
    let length = fs::metadata(&args.rays).map_or(0, |found| found.len());
    memory::require(&args.rays.display().to_string(), length / 2 * 5)?;
    let source = input::load_triangles(&args.scene, args.quiet)?;
    let rays: Vec<Ray> = from_rows(&npy::read_f32(&args.rays, 8)?).collect();
    let (triangles, slices) = (source.len(), Slices::new(args));
    input::run_on_threads(args.threads, || {
        let accel = build(&args.accel, Arc::clone(&source), args.isa)?;
        let mut answers = if args.any {
            Answers::Any(vec![AnyHit(false); rays.len()])
        } else {
            Answers::Closest(vec![ClosestHit::MISS; rays.len()])
        };
        shoot(&*accel, &rays, &mut answers, slices, false);
        let mut seconds: Vec<f64> = (0..args.repeat)
            .map(|_| {
                let start = Instant::now();
                shoot(&*accel, &rays, &mut answers, slices, false);
                start.elapsed().as_secs_f64()
            })
            .collect();
        seconds.sort_by(f64::total_cmp);
        let counts = args.counters.then(|| shoot(&*accel, &rays, &mut answers, slices, true));
        if let Some(path) = &args.hits {
            match &answers {
                Answers::Closest(hits) => {
                    let (columns, rows) = hit_rows(&*source, hits);
                    npy::write_f32(path, columns, &rows)?;
                }
                Answers::Any(hits) => {
                    npy::write_u8(
                        path,
                        &hits.iter().map(|hit| u8::from(hit.0)).collect::<Vec<_>>(),
                    )?;
                }
            }
        }
        let summary = Summary {
            triangles,
            rays: rays.len(),
            hits: answers.count_hits(),
            seconds: seconds[seconds.len() / 2],
            counts,
        };
        text::print(&summary.to_text(args, &*accel))?;
        Ok(ExitCode::SUCCESS)
    })?
}

/// Hits as rows of a table, and how many columns it has: the triangle's number is the last, or,
/// where there are more than a column can number, its placement and its number in the mesh are the
/// last two.
fn hit_rows(source: &dyn TriangleSource, hits: &[ClosestHit]) -> (usize, Vec<f32>) {
    let is_numbered = source.len() < u32::MAX as usize;
    let number =
        |hit: &ClosestHit| if hit.is_hit() { source.number(hit.triangle) as u32 } else { u32::MAX };
    let mut rows = Vec::with_capacity(hits.len() * 5);
    for hit in hits {
        rows.extend([hit.t, hit.u, hit.v]);
        if is_numbered {
            rows.push(f32::from_bits(number(hit)));
        } else {
            rows.extend([hit.triangle.instance.0, hit.triangle.index].map(f32::from_bits));
        }
    }
    (if is_numbered { 4 } else { 5 }, rows)
}

impl Answers {
    fn count_hits(&self) -> usize {
        match self {
            Self::Closest(hits) => hits.iter().filter(|hit| hit.is_hit()).count(),
            Self::Any(hits) => hits.iter().filter(|hit| hit.0).count(),
        }
    }
}

/// Answers all rows on the threads of the pool.
fn shoot(
    accel: &dyn Accel,
    rays: &[Ray],
    answers: &mut Answers,
    slices: Slices,
    counting: bool,
) -> Counts {
    match answers {
        Answers::Closest(hits) => {
            shoot_all(accel, rays, hits, slices, counting, |tracer, batch, hits| {
                tracer.closest_hits(batch, hits);
            })
        }
        Answers::Any(hits) => {
            shoot_all(accel, rays, hits, slices, counting, |tracer, batch, hits| {
                tracer.any_hits(batch, hits);
            })
        }
    }
}

fn shoot_all<A: Send>(
    accel: &dyn Accel,
    rays: &[Ray],
    answers: &mut [A],
    slices: Slices,
    counting: bool,
    ask: impl Fn(&mut dyn Tracer, &Batch<'_>, &mut [A]) + Sync,
) -> Counts {
    let tracer = || if counting { accel.counting_tracer() } else { accel.tracer() };
    let (read, slice) = slices.lengths();
    // A task of many slices, so that a tracer is not made anew for each.
    let task = (answers.len() / rayon::current_num_threads() / 4).max(1).next_multiple_of(read);
    let tasks = rays.par_chunks(task).zip(answers.par_chunks_mut(task));
    let counts: Vec<Counts> = tasks
        .map(|(rays, answers)| {
            let mut tracer = tracer();
            for (rays, answers) in rays.chunks(read).zip(answers.chunks_mut(read)) {
                for (rays, answers) in rays.chunks(slice).zip(answers.chunks_mut(slice)) {
                    ask(&mut *tracer, &slices.batch(rays), answers);
                }
            }
            tracer.counts()
        })
        .collect();
    counts.into_iter().fold(Counts::default(), |a, b| a + b)
}

struct Summary {
    triangles: usize,
    rays: usize,
    hits: usize,
    seconds: f64,
    counts: Option<Counts>,
}

impl Summary {
    fn to_text(&self, args: &TraceArgs, accel: &dyn Accel) -> String {
        let rate = self.rays as f64 / self.seconds.max(1e-9) * 1e-6;
        let (report, bytes) = (accel.report(), accel.memory().total());
        let query = if args.any { "any" } else { "closest" };
        if args.json {
            let counts = self.counts.as_ref().map(|counts| {
                let entry = |event: Event| (event.name().to_owned(), counts[event].into());
                serde_json::Map::from_iter(Event::ALL.map(entry))
            });
            let object = json!({
                "accel": args.accel.to_string(),
                "query": query,
                "triangles": self.triangles,
                "rays": self.rays,
                "hits": self.hits,
                "build_s": report.seconds(),
                "bytes": bytes,
                "seconds": self.seconds,
                "mrays_s": rate,
                "counters": counts,
            });
            return format!("{object}\n");
        }
        let mut text = format!(
            "{}: {} triangles, {bytes} bytes\n\
             built in {:.3} s: {}, {} of {:.2} triangles, depth {} ({:.1} on \
             average), SAH cost {:.2}\n\
             {} {query} rays, {} hits, {:.4} s, {rate:.3} Mrays/s\n",
            args.accel,
            self.triangles,
            report.seconds(),
            text::format_count(report.nodes as u64, "node", "nodes"),
            text::format_count(report.leaves as u64, "leaf", "leaves"),
            report.mean_leaf,
            report.max_depth,
            report.mean_depth,
            report.sah_cost,
            self.rays,
            self.hits,
            self.seconds
        );
        if let Some(counts) = self.counts {
            let rays = self.rays.max(1) as f64;
            for event in Event::ALL.into_iter().filter(|&event| counts[event] > 0) {
                let per_ray = counts[event] as f64 / rays;
                // Writing to a string cannot fail.
                let _ = writeln!(text, "{per_ray:>10.3} {} a ray", event.name());
            }
        }
        text
    }
}
