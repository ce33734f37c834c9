//! `dapple validate`: structures against brute force.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{CliError, input};
use crate::accel::{Accel, AccelSpec, AnyHit, Batch, ClosestHit, VARIANTS, build};
use crate::bench::ray_sets::{RaySet, Target, to_rows};
use crate::geom::TriangleSource;
use crate::math::Ray;
use crate::scene::npy;
use crate::simd::Isa;

/// Check that structures answer as brute force does, to the bit.
///
/// Rays are random, shadow, primary, bounce and hostile ones in equal parts: aimed at vertices and
/// edges, along axes and planes, from far away, with zeros, denormals and NaN. Each structure is
/// compared to brute force on as many as a time allows, and to `bvh2` on the rest.
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:\n  dapple validate bunny.obj --accel all --rays 1000000\n  \
    dapple validate tris.npy --accel bvh2,kd-ropes --brute-rays 100000")]
pub struct ValidateArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles
    scene: PathBuf,
    /// Structures, separated by commas, or `all`
    #[arg(long, default_value = "all")]
    accel: String,
    /// How many rays in all
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    rays: usize,
    /// How many of them brute force answers, too [default: what it can in 30 seconds]
    #[arg(long, value_name = "N")]
    brute_rays: Option<usize>,
    /// Another seed, other rays
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    /// Threads; 0: one a core
    #[arg(long, default_value_t = 0)]
    threads: usize,
    /// Where to leave the first ray that differs
    #[arg(long, value_name = "FILE", default_value = "differs.npy")]
    save: PathBuf,
}

/// How long brute force may take unless `--brute-rays` says how many rays it gets.
const BRUTE_TIME: Duration = Duration::from_secs(30);
/// Slices that structures are asked in, in turn.
const SLICES: [usize; 6] = [4096, 1, 33, 8, 257, 1024];

/// Answers to trust.
struct Expected {
    /// Which rays, from the first.
    closest: Vec<ClosestHit>,
    by: &'static str,
}

/// Runs the command; exit 1 if a structure differs.
pub fn run(args: &ValidateArgs) -> Result<ExitCode, CliError> {
    let specs = specs(&args.accel)?;
    let source = input::triangles(&args.scene)?;
    input::on_threads(args.threads, || validate(args, &specs, &source))?
}

/// The structures of a list; options of one may hold commas, so a part without an id joins the one
/// before.
pub fn specs(list: &str) -> Result<Vec<AccelSpec>, CliError> {
    if list == "all" {
        let ids = VARIANTS.iter().filter(|variant| variant.id != "brute");
        return Ok(ids.map(|variant| variant.id.parse().expect("in the table")).collect());
    }
    let mut texts: Vec<String> = Vec::new();
    for part in list.split(',') {
        match texts.last_mut() {
            Some(last) if part.contains('=') && !part.contains(':') => {
                *last = format!("{last},{part}");
            }
            _ => texts.push(part.to_owned()),
        }
    }
    let parse = |text: String| {
        text.parse().map_err(|error| CliError::Usage(format!("--accel {text}: {error}")))
    };
    texts.into_iter().map(parse).collect()
}

fn validate(
    args: &ValidateArgs,
    specs: &[AccelSpec],
    source: &Arc<dyn TriangleSource>,
) -> Result<ExitCode, CliError> {
    let named = |id: &str| build(&id.parse().expect("in the table"), Arc::clone(source), args.isa);
    let (brute, second) = (named("brute")?, named("bvh2")?);
    let rays = mixed_rays(&**source, &*second, args);
    println!("{} triangles, {} rays", source.len(), rays.len());

    let sure = by_brute_force(&*brute, &rays, args.brute_rays);
    println!("brute force answered {} rays", sure.len());
    let mut differs = false;
    if let Some(ray) = first_difference(&*second, &rays, &sure) {
        differs = true;
        tell(args, "bvh2", &rays, ray, &sure[ray], "brute", &*second)?;
    }
    let mut rest = vec![ClosestHit::MISS; rays.len()];
    second.tracer().closest_hits(&Batch::new(&rays), &mut rest);
    rest[..sure.len()].copy_from_slice(&sure);
    let expected = Expected { closest: rest, by: "bvh2" };

    for spec in specs {
        let accel = build(spec, Arc::clone(source), args.isa)?;
        match first_difference(&*accel, &rays, &expected.closest) {
            None => println!("{spec}: all {} rays agree", rays.len()),
            Some(ray) => {
                differs = true;
                let by = if ray < sure.len() { "brute" } else { expected.by };
                let name = spec.to_string();
                tell(args, &name, &rays, ray, &expected.closest[ray], by, &*accel)?;
            }
        }
    }
    Ok(if differs { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// Rays of all sets, taking turns, so that any prefix has of each.
fn mixed_rays(source: &dyn TriangleSource, accel: &dyn Accel, args: &ValidateArgs) -> Vec<Ray> {
    let target = Target::new(source, accel);
    let each = args.rays.div_ceil(RaySet::ALL.len());
    let sets = RaySet::ALL.map(|set| target.rays(set, each, args.seed));
    (0..each).flat_map(|i| sets.iter().filter_map(move |set| set.get(i)).copied()).collect()
}

/// Brute force on the first rays: `count`, or as many as it gets done in its time.
fn by_brute_force(brute: &dyn Accel, rays: &[Ray], count: Option<usize>) -> Vec<ClosestHit> {
    let rays = &rays[..count.unwrap_or(rays.len()).min(rays.len())];
    let start = Instant::now();
    let mut answers = Vec::new();
    let mut tracer = brute.tracer();
    for slice in rays.chunks(2048) {
        if count.is_none() && start.elapsed() > BRUTE_TIME {
            break;
        }
        let first = answers.len();
        answers.resize(first + slice.len(), ClosestHit::MISS);
        tracer.closest_hits(&Batch::new(slice), &mut answers[first..]);
    }
    answers
}

/// The first ray whose answer differs, to either question, in slices of all lengths.
fn first_difference(accel: &dyn Accel, rays: &[Ray], expected: &[ClosestHit]) -> Option<usize> {
    let mut tracer = accel.tracer();
    let (mut first, mut lengths) = (0, SLICES.into_iter().cycle());
    while first < expected.len() {
        let end = expected.len().min(first + lengths.next().unwrap_or(1));
        let batch = Batch::new(&rays[first..end]);
        let mut hits = vec![ClosestHit::MISS; end - first];
        let mut any = vec![AnyHit(false); end - first];
        tracer.closest_hits(&batch, &mut hits);
        tracer.any_hits(&batch, &mut any);
        let answers = hits.iter().zip(&any).zip(&expected[first..end]);
        let same = |((hit, any), expected): ((&ClosestHit, &AnyHit), &ClosestHit)| {
            hit.same_bits(expected) && any.0 == expected.is_hit()
        };
        if let Some(at) = answers.into_iter().position(|answer| !same(answer)) {
            return Some(first + at);
        }
        first = end;
    }
    None
}

/// Prints a ray that differs, leaves it in a file and says how to shoot it again.
fn tell(
    args: &ValidateArgs,
    name: &str,
    rays: &[Ray],
    ray: usize,
    expected: &ClosestHit,
    by: &str,
    accel: &dyn Accel,
) -> Result<(), CliError> {
    let batch = [rays[ray]];
    let (mut hit, mut any) = ([ClosestHit::MISS], [AnyHit(false)]);
    accel.tracer().closest_hits(&Batch::new(&batch), &mut hit);
    accel.tracer().any_hits(&Batch::new(&batch), &mut any);
    npy::write_f32(&args.save, 8, &to_rows(&batch))?;
    println!("{name}: ray {ray} differs: {:?}", rays[ray]);
    println!("  {by} says {expected:?}");
    println!("  {name} says {:?}, any hit {}", hit[0], any[0].0);
    let (scene, save) = (args.scene.display(), args.save.display());
    println!("  to replay: dapple trace {scene} --rays {save} --single --accel {name}");
    Ok(())
}
