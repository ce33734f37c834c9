//! `dapple validate`: structures against brute force.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

use crate::accel::{Accel, AccelSpec, Batch, BuildError, ClosestHit, Instances, build};
use crate::bench::agreement::{
    Difference, LONGEST_SLICE, answers_in_time, first_difference, mixed_rays,
};
use crate::bench::ray_sets::{Target, to_rows};
use crate::cli::error::CliError;
use crate::cli::flags::{Quiet, parse_accels, seed, whole};
use crate::cli::outputs::{self, Output};
use crate::cli::settings::parse::threads;
use crate::cli::{input, memory, shell, text, trace};
use crate::formats::npy;
use crate::geom::TriangleSource;
use crate::math::Ray;
use crate::simd::Isa;

/// Check that structures answer as brute force does, to the bit.
///
/// Rays are random, shadow, primary, bounce and hostile ones in equal parts. Hostile ones are aimed
/// at vertices and edges, along axes and planes, from far away, with zeros, denormals and NaN. Each
/// structure is compared to brute force on as many rays as the time allows, and to `bvh2` on the
/// rest.
#[derive(clap::Args, Debug)]
#[command(after_help = "Examples:\n  dapple validate bunny.obj --accel all --rays 1000000\n  \
    dapple validate tris.npy --accel bvh2,kd-ropes --brute-rays 100000")]
pub struct ValidateArgs {
    /// A scene file, or an .npy of (N, 9) float32 triangles
    scene: PathBuf,
    /// Structures, separated by commas, or `all`
    #[arg(long, default_value = "all")]
    accel: String,
    /// Number of rays
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    #[arg(value_parser = whole(1..=1_000_000_000_u64))]
    rays: u64,
    /// How many of them brute force answers, too [default: as many as it can in 30 seconds]
    #[arg(long, value_name = "N", value_parser = whole(0..=1_000_000_000_u64))]
    brute_rays: Option<u64>,
    /// Another number, other rays
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// The instruction set
    #[arg(long, default_value_t)]
    isa: Isa,
    /// Threads; 0: one per core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    threads: usize,
    /// Where to write rays that differ; each structure's id is added before the ending
    #[arg(long, value_name = "FILE", default_value = "differs.npy")]
    save: PathBuf,
    #[command(flatten)]
    quiet: Quiet,
}

/// How long brute force may take unless `--brute-rays` says how many rays it gets.
const BRUTE_TIME: Duration = Duration::from_secs(30);

// What is left to be replayed is one slice there as it was here.
const _: () = assert!(LONGEST_SLICE <= trace::SLICE);

/// Runs the command; exit 1 if a structure differs.
pub fn run(args: &ValidateArgs) -> Result<ExitCode, CliError> {
    let specs = parse_accels(&args.accel)?;
    for spec in &specs {
        let path = &save_path(args, &spec.to_string());
        outputs::check(&[Output { flag: "--save", path, ending: "npy" }], &[&args.scene])?;
    }
    // Rays of all sets, those in turn, the answers of both oracles.
    let each = 2 * (size_of::<Ray>() + size_of::<ClosestHit>()) as u64;
    memory::require(&format!("--rays {}", args.rays), args.rays * each)?;
    let source = input::load_triangles(&args.scene, args.quiet)?;
    let specs = in_all_ways(specs, &*source);
    let build = |spec: &AccelSpec| build(spec, Arc::clone(&source), args.isa);
    let say = |line: &str| Ok(text::print(&format!("{line}\n"))?);
    let agree =
        input::run_on_threads(args.threads, || validate(args, &specs, &*source, &build, &say))?;
    Ok(ExitCode::from(u8::from(!agree?)))
}

/// Whether meshes are placed more than once.
fn has_copies(source: &dyn TriangleSource) -> bool {
    source.placements().is_some_and(|placed| placed.len() > placed.meshes())
}

/// The structures that a scene allows: where meshes are placed more than once, in two levels and
/// flat, unless it was said which.
fn in_all_ways(specs: Vec<AccelSpec>, source: &dyn TriangleSource) -> Vec<AccelSpec> {
    let both: &[Instances] = &[Instances::Flat, Instances::TwoLevel];
    let ways = if has_copies(source) { both } else { &[Instances::Auto] };
    let said = |spec: &AccelSpec| spec.instances != Instances::Auto;
    let in_ways = |spec: AccelSpec| {
        let ways = if said(&spec) { vec![spec.instances] } else { ways.to_vec() };
        ways.into_iter().map(move |instances| AccelSpec { instances, ..spec.clone() })
    };
    specs.into_iter().flat_map(in_ways).collect()
}

type Build<'a> = dyn Fn(&AccelSpec) -> Result<Box<dyn Accel>, BuildError> + Sync + 'a;
type Say<'a> = dyn Fn(&str) -> Result<(), CliError> + Sync + 'a;

/// Whether all structures agree with the oracles: brute force on the first rays, and on the rest
/// `bvh2`, which first has to agree with brute force itself.
fn validate(
    args: &ValidateArgs,
    specs: &[AccelSpec],
    source: &dyn TriangleSource,
    build: &Build<'_>,
    say: &Say<'_>,
) -> Result<bool, CliError> {
    const SECOND: &str = "bvh2";
    let named = |id: &str| {
        let spec: AccelSpec = id.parse().expect("in the table");
        let copies = has_copies(source);
        let instances = if copies { Instances::Flat } else { Instances::Auto };
        build(&AccelSpec { instances, ..spec })
    };
    let (brute, second) = (named("brute")?, named(SECOND)?);
    let rays = mixed_rays(&Target::new(source, &*second), args.rays as usize, args.seed);
    say(&format!("{} triangles, {} rays", source.len(), rays.len()))?;

    let brute_rays = args.brute_rays.map(|rays| rays as usize);
    let mut expected = answers_in_time(&*brute, &rays, brute_rays, BRUTE_TIME);
    let sure = expected.len();
    let difference = first_difference(&*second, &rays, &expected);
    let second_agrees = difference.is_none();
    match difference {
        None => say(&format!("{SECOND}: {sure} rays agree with brute force"))?,
        Some(found) => {
            report_difference(args, SECOND, &rays, &found, &expected, "brute force", say)?;
            say(&format!("{SECOND} cannot be trusted with the rest: {sure} rays are compared"))?;
        }
    }
    let rest = rays.len() - sure;
    if second_agrees && rest > 0 {
        expected.resize(rays.len(), ClosestHit::MISS);
        second.tracer().closest_hits(&Batch::new(&rays[sure..]), &mut expected[sure..]);
    }

    let mut all_agree = second_agrees;
    for spec in specs {
        let name = spec.to_string();
        if name == SECOND || name == format!("{SECOND}:instances=flat") {
            continue; // it gave the answers
        }
        let accel = build(spec)?;
        match first_difference(&*accel, &rays, &expected) {
            None if expected.len() > sure => {
                say(&format!("{name}: {sure} with brute force, {rest} with {SECOND}"))?;
            }
            None => say(&format!("{name}: {sure} rays agree with brute force"))?,
            Some(found) => {
                all_agree = false;
                let by = if found.ray < sure { "brute force" } else { SECOND };
                report_difference(args, &name, &rays, &found, &expected, by, say)?;
            }
        }
    }
    Ok(all_agree)
}

/// Reports a ray that differs, writes it to a file, with its slice if it differs only there, and
/// says how to shoot it again.
fn report_difference(
    args: &ValidateArgs,
    name: &str,
    rays: &[Ray],
    found: &Difference,
    expected: &[ClosestHit],
    by: &str,
    say: &Say<'_>,
) -> Result<(), CliError> {
    let ray = found.ray;
    say(&format!("{name}: ray {ray} differs: {:?}", rays[ray]))?;
    say(&format!("  {by} says {:?}", expected[ray]))?;
    say(&format!("  {name} says {:?}, any hit {}", found.closest, found.any.0))?;
    let saved = if found.alone { ray..ray + 1 } else { found.slice.clone() };
    if !found.alone {
        let (start, end) = (saved.start, saved.end - 1);
        say(&format!("  alone it does not differ: in the slice of rays {start} to {end} it does"))?;
    }
    let save = save_path(args, name);
    npy::write_f32(&save, 8, &to_rows(&rays[saved]))?;
    let (scene, save) = (shell::quote(&args.scene), shell::quote(&save));
    let any = if found.any_only { " --any" } else { "" };
    let single = if found.alone { " --single" } else { " --threads 1" };
    let (name, isa) = (shell::quote(name), args.isa);
    say(&format!(
        "  to replay: dapple trace {scene} --rays {save}{any}{single} --accel {name} --isa {isa}"
    ))
}

/// `differs.npy` is `differs-kd-ropes.npy` for that structure.
fn save_path(args: &ValidateArgs, name: &str) -> PathBuf {
    let id: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let mut file = args.save.file_stem().unwrap_or_default().to_owned();
    file.push(format!("-{id}"));
    if let Some(ending) = args.save.extension() {
        file.push(".");
        file.push(ending);
    }
    args.save.with_file_name(file)
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use clap::Parser;

    use super::*;
    use crate::bench::agreement::tests::{Liar, honest, source};

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        args: ValidateArgs,
    }

    /// Whether all agree and what is said, where the structure `liar` lies about ray `ray`.
    fn validated(words: &str, folder: &std::path::Path, liar: &str, ray: usize) -> (bool, String) {
        let save = folder.join("it's.npy");
        let words = words.split_whitespace().map(|word| {
            if word == "SAVE" { save.to_str().expect("a name").to_owned() } else { word.to_owned() }
        });
        let args = Command::parse_from(std::iter::once("validate".to_owned()).chain(words)).args;
        let source = source();
        let rays = {
            let second = honest(&source, "bvh2");
            mixed_rays(&Target::new(&*source, &*second), args.rays as usize, args.seed)
        };
        let build = |spec: &AccelSpec| -> Result<Box<dyn Accel>, BuildError> {
            let name = spec.to_string();
            let honest = honest(&source, &name);
            if name != liar {
                return Ok(honest);
            }
            let (ray, any_only) = (rays[ray], name == "kd-restart");
            Ok(Box::new(Liar { honest, ray, any_only, in_company: name == "kd-spill" }))
        };
        let said = Mutex::new(String::new());
        let say = |line: &str| {
            let mut said = said.lock().expect("one thread");
            said.push_str(line);
            said.push('\n');
            Ok(())
        };
        let specs = parse_accels(&args.accel).expect("rows of the table");
        let agree = validate(&args, &specs, &*source, &build, &say).expect("it runs");
        (agree, said.into_inner().expect("one thread"))
    }

    const WORDS: &str = "my.obj --rays 1000 --brute-rays 200 --save SAVE --isa portable --accel ";

    fn saved_rays(folder: &std::path::Path, id: &str) -> usize {
        let rows = npy::read_f32(&folder.join(format!("it's-{id}.npy")), 8).expect("it was saved");
        rows.len() / 8
    }

    #[test]
    fn what_was_compared_with_what_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        let (agree, said) = validated(&format!("{WORDS}bvh2,kd-ropes"), folder.path(), "none", 0);
        let expected = "100 triangles, 1000 rays\nbvh2: 200 rays agree with brute force\n\
                        kd-ropes: 200 with brute force, 800 with bvh2\n";
        assert_eq!((agree, said.as_str()), (true, expected));
        let (_, said) = validated(
            &WORDS
                .replace("200 --s", "2000 --accel kd-ropes --s")
                .replace("portable --accel ", "portable"),
            folder.path(),
            "none",
            0,
        );
        assert!(said.ends_with("kd-ropes: 1000 rays agree with brute force\n"), "{said}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }

    #[test]
    fn a_lie_about_one_ray_is_found_and_can_be_replayed() {
        let folder = tempfile::tempdir().expect("a folder");
        let lie = |id: &str, ray| validated(&format!("{WORDS}{id}"), folder.path(), id, ray);
        let (agree, said) = lie("kd-ropes", 777);
        assert!(!agree && said.contains("kd-ropes: ray 777 differs"), "{said}");
        assert!(said.contains("bvh2 says"), "{said}");
        assert!(said.contains("it'\\''s-kd-ropes.npy' --single --accel kd-ropes --isa portable"));
        assert_eq!(saved_rays(folder.path(), "kd-ropes"), 1);

        let (agree, said) = lie("kd-restart", 77);
        assert!(!agree && said.contains("brute force says"), "{said}");
        assert!(said.contains(".npy' --any --single --accel kd-restart"), "{said}");

        let (agree, said) = lie("kd-spill", 77);
        assert!(!agree && said.contains("in the slice of rays 0 to 999"), "{said}");
        assert!(said.contains(".npy' --threads 1 --accel kd-spill"), "{said}");
        assert_eq!(saved_rays(folder.path(), "kd-spill"), 1000);
        assert_eq!(saved_rays(folder.path(), "kd-ropes"), 1, "each has its own file");
    }

    #[test]
    fn a_second_oracle_that_lies_is_not_asked() {
        let folder = tempfile::tempdir().expect("a folder");
        let words = format!("{WORDS}bvh2,kd-ropes");
        let (agree, said) = validated(&words, folder.path(), "bvh2", 77);
        assert!(!agree && said.contains("bvh2: ray 77 differs"), "{said}");
        assert!(said.ends_with("kd-ropes: 200 rays agree with brute force\n"), "{said}");
    }
}
