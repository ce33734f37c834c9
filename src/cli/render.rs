//! `dapple render`: a scene in, a picture out.

use std::ffi::OsStr;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::json;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::args::{ProgressStyle, RenderArgs};
use super::prepare::{Job, prepare};
use super::progress::{Reporter, say};
use super::{CliError, input};
use crate::accel;
use crate::film::{Picture, exr, png};
use crate::render::{Control, Rendered, render, replay};

/// Runs the command.
pub fn run(args: &RenderArgs) -> Result<ExitCode, CliError> {
    if args.output.is_none() && args.png.is_none() && args.debug_sample.is_none() {
        return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
    }
    let interrupt = Interrupt::listen()?;
    let job = prepare(args)?;
    if !args.quiet {
        tell(args, &job);
    }
    if let Some(sample) = args.debug_sample {
        return debug(args, &job, sample);
    }
    let (mut rendered, built) = on_pool(args, &job, &interrupt.raised, args.progress)?;
    describe(&mut rendered.picture, args, &job, &rendered.elapsed);
    write(args, &rendered.picture)?;
    if !args.quiet {
        report_lost(&rendered);
        say(&summary(args, &job, &rendered, built));
    }
    if args.json {
        println!("{}", summary_json(args, &job, &rendered, built));
    }
    if rendered.cancelled {
        let (fewest, most) = rendered.samples;
        say(&format!("interrupted: saved with {fewest} to {most} of {} samples", args.spp));
        return Ok(interrupt.exit_code());
    }
    Ok(ExitCode::SUCCESS)
}

/// The flags of a command line's words, for a scene.
///
/// # Errors
/// Words that make no sense.
pub fn parsed_words(scene: &Path, words: &[String]) -> Result<RenderArgs, CliError> {
    #[derive(Parser)]
    struct Words {
        #[command(flatten)]
        args: RenderArgs,
    }
    let words = words.iter().map(OsStr::new);
    let parsed =
        Words::try_parse_from([OsStr::new("render"), scene.as_os_str()].into_iter().chain(words));
    Ok(parsed.map_err(|error| CliError::Usage(error.to_string()))?.args)
}

/// Renders a scene by the words of a command line, without saying one and without writing a file:
/// for `dapple golden`.
///
/// # Errors
/// All that [`run`] may fail with.
pub fn picture(scene: &Path, words: &[String]) -> Result<Picture, CliError> {
    let args = parsed_words(scene, words)?;
    let job = prepare(&args)?;
    let (mut rendered, _) = on_pool(&args, &job, &AtomicBool::new(false), ProgressStyle::None)?;
    describe(&mut rendered.picture, &args, &job, &rendered.elapsed);
    Ok(rendered.picture)
}

/// Builds the structure and renders, on as many threads as asked for.
fn on_pool(
    args: &RenderArgs,
    job: &Job,
    cancel: &AtomicBool,
    style: ProgressStyle,
) -> Result<(Rendered, Duration), CliError> {
    input::on_threads(args.threads, || {
        let start = Instant::now();
        let accel = accel::build(&args.accel, job.world.triangles.clone(), args.isa)?;
        let built = start.elapsed();
        if args.verbose > 0 {
            say(&format!("built {} in {:.2} s", args.accel, built.as_secs_f64()));
        }
        let reporter = Reporter::new(if args.quiet { ProgressStyle::None } else { style });
        let control = Control { cancel, progress: &|progress| reporter.update(progress) };
        let rendered = render(&job.world, &job.camera, &*accel, &job.settings, &control);
        reporter.finish();
        Ok((rendered, built))
    })?
}

/// Tells what the scene asks in vain and what was decided for the user.
fn tell(args: &RenderArgs, job: &Job) {
    for notice in &job.notices {
        say(&format!("note: {}: {}", notice.place, notice.message));
    }
    if args.verbose > 0 {
        let scene = &job.world.scene;
        say(&format!(
            "{}: {} triangles, {} instances of {} meshes, {} materials, {} textures, {} lights; {:.2} s",
            args.scene_file.display(),
            crate::geom::TriangleSource::len(&*job.world.triangles),
            scene.instances.len(),
            scene.meshes.len(),
            scene.materials.len(),
            scene.textures.len(),
            job.world.lights.len(),
            job.elapsed.as_secs_f64(),
        ));
    }
}

/// Prints the path of one sample.
fn debug(args: &RenderArgs, job: &Job, sample: (u32, u32, u64)) -> Result<ExitCode, CliError> {
    let (width, height) = job.settings.resolution;
    if sample.0 >= width || sample.1 >= height {
        let message = format!("--debug-sample: the frame is {width}x{height}");
        return Err(CliError::Usage(message));
    }
    let accel = accel::build(&args.accel, job.world.triangles.clone(), args.isa)?;
    print!("{}", replay(&job.world, &job.camera, &*accel, &job.settings, sample));
    Ok(ExitCode::SUCCESS)
}

/// Puts into the header what the picture was made of.
fn describe(picture: &mut Picture, args: &RenderArgs, job: &Job, elapsed: &Duration) {
    let settings = &job.settings;
    let transport = &settings.transport;
    let roulette = transport.roulette_depth.map_or("\"off\"".to_owned(), |depth| depth.to_string());
    let toml = format!(
        "resolution = [{}, {}]\ncrop = [{}]\nspp = {}\nseed = {}\nsampler = \"{}\"\nfilter = \"{}\"\nbsdf = \"{}\"\n\
         max-depth = {}\nrr-depth = {roulette}\ntransparent = {}\n",
        settings.resolution.0,
        settings.resolution.1,
        settings.crop,
        settings.spp,
        settings.seed,
        settings.pattern,
        settings.filter,
        args.bsdf,
        transport.max_depth,
        transport.transparent,
    );
    let command: Vec<String> = std::env::args().collect();
    for (name, value) in [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("command", command.join(" ")),
        ("settings", toml),
        ("seed", settings.seed.to_string()),
        ("spp", settings.spp.to_string()),
        ("accel", args.accel.to_string()),
        ("scene", args.scene_file.display().to_string()),
        ("scene-digest", format!("{:016x}", job.world.scene.digest())),
        ("render-time", format!("{:.3} s", elapsed.as_secs_f64())),
    ] {
        picture.strings.insert(format!("dapple/{name}"), value);
    }
}

fn write(args: &RenderArgs, picture: &Picture) -> Result<(), CliError> {
    if let Some(path) = &args.output {
        exr::write(path, picture)?;
    }
    if let Some(path) = &args.png {
        png::write(path, picture, args.tonemap, args.exposure)?;
    }
    Ok(())
}

/// Names the samples that were not finite, each with the command that follows it.
fn report_lost(rendered: &Rendered) {
    if rendered.lost_count == 0 {
        return;
    }
    say(&format!("warning: {} samples were not finite and are left out:", rendered.lost_count));
    let words: Vec<String> = std::env::args().skip(1).collect();
    for lost in &rendered.lost {
        let place = format!("{},{},{}", lost.x, lost.y, lost.sample);
        say(&format!("  dapple {} --debug-sample {place}", words.join(" ")));
    }
}

/// The last line: what it took.
fn summary(args: &RenderArgs, job: &Job, rendered: &Rendered, built: Duration) -> String {
    let (width, height) = job.settings.resolution;
    let seconds = rendered.elapsed.as_secs_f64();
    let rays = rendered.rays.total() as f64;
    let outputs: Vec<String> = [&args.output, &args.png]
        .into_iter()
        .flatten()
        .map(|path| path.display().to_string())
        .collect();
    let memory =
        peak_memory().map_or(String::new(), |bytes| format!(", peak {:.0} MB", bytes as f64 / 1e6));
    format!(
        "{}: {width}x{height}, {} spp, {:.1} M rays in {:.2} s, {:.2} Mrays/s, \
         {:.2} µs a path; load {:.2} s, build {:.2} s{memory}",
        outputs.join(", "),
        rendered.samples.0,
        rays / 1e6,
        seconds,
        rays / seconds.max(1e-9) / 1e6,
        seconds * 1e6 / rendered.paths.max(1) as f64,
        job.elapsed.as_secs_f64(),
        built.as_secs_f64(),
    )
}

fn summary_json(args: &RenderArgs, job: &Job, rendered: &Rendered, built: Duration) -> String {
    json!({
        "scene": args.scene_file,
        "resolution": [job.settings.resolution.0, job.settings.resolution.1],
        "spp": rendered.samples.0,
        "accel": args.accel.to_string(),
        "paths": rendered.paths,
        "rays": rendered.rays.total(),
        "shadow_rays": rendered.rays.shadow,
        "render_s": rendered.elapsed.as_secs_f64(),
        "load_s": job.elapsed.as_secs_f64(),
        "build_s": built.as_secs_f64(),
        "mrays_s": rendered.rays.total() as f64 / rendered.elapsed.as_secs_f64().max(1e-9) / 1e6,
        "lost_samples": rendered.lost_count,
        "peak_bytes": peak_memory(),
        "interrupted": rendered.cancelled,
    })
    .to_string()
}

/// The most memory that the process has had, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kilobytes: u64 = line.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

/// Ctrl-C and SIGTERM: the first ends the render early, a second one the process.
struct Interrupt {
    raised: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    fn listen() -> Result<Self, CliError> {
        let (raised, signal) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicUsize::new(0)));
        let register = |number: i32| -> std::io::Result<()> {
            let code = 128 + number;
            // In this order: a signal that finds the flag raised already ends the process.
            signal_hook::flag::register_conditional_shutdown(number, code, raised.clone())?;
            signal_hook::flag::register(number, raised.clone())?;
            signal_hook::flag::register_usize(number, signal.clone(), number as usize)?;
            Ok(())
        };
        [SIGINT, SIGTERM]
            .into_iter()
            .try_for_each(register)
            .map_err(|error| CliError::Input(format!("cannot listen to signals: {error}")))?;
        Ok(Self { raised, signal })
    }

    /// 130 after Ctrl-C, 143 after SIGTERM.
    fn exit_code(&self) -> ExitCode {
        ExitCode::from(128 + self.signal.load(Ordering::Relaxed) as u8)
    }
}
