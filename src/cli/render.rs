//! `dapple render`: a scene in, a picture out.

use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use serde_json::json;
use signal_hook::consts::{SIGINT, SIGTERM};

use super::args::RenderArgs;
use super::header::{self, describe};
use super::outputs::{self, Output};
use super::prepare::Job;
use super::progress::{Reporter, note, say};
use super::shutter::Shutter;
use super::values::ProgressStyle;
use super::{CliError, dry_run, input, layers, memory, shell, table};
use crate::accel;
use crate::film::{Picture, exr, png};
use crate::formats::EnvironmentSource;
use crate::render::{Control, Exposure, LostSample, Rendered, film_bytes, replay};

/// Runs the command.
pub fn run() -> Result<ExitCode, CliError> {
    let settled = layers::settled(std::env::args_os().skip(2).collect())?;
    let args = &settled.args;
    let stops = args.debug_sample.is_some() || args.dry_run || args.print_config;
    let outputs = outputs(args);
    if outputs.is_empty() && !stops {
        return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
    }
    if !stops {
        outputs::check(&outputs, &inputs(args))?;
    }
    let interrupt = Interrupt::listen()?;
    let shutter = Shutter::new(args);
    let job = shutter.first(args)?;
    if !args.quiet {
        tell(args, &job);
        settled.made_of(&job).iter().for_each(note);
    }
    if let Some(sample) = args.debug_sample {
        return debug(args, &shutter, &job, sample);
    }
    if args.print_config {
        table::print(&format!("[render]\n{}", header::settings(args, &job)))?;
        return Ok(ExitCode::SUCCESS);
    }
    if args.dry_run {
        return dry_run::run(args, &job);
    }
    let mut exposed = on_pool(args, &job, &interrupt.raised, args.progress)?;
    let rendered = &mut exposed.rendered;
    if rendered.samples.1 == 0 {
        say("interrupted before the first samples: there is nothing to save");
        return Ok(interrupt.exit_code());
    }
    let words = shell::own_words();
    describe(rendered, args, &job, &words);
    report_lost(rendered, &words);
    write(args, &rendered.picture)?;
    if !args.quiet {
        say(&summary(args, &job, &exposed));
    }
    if args.json {
        table::print(&format!("{}\n", summary_json(args, &job, &exposed)))?;
    }
    let Exposed { rendered, moments, stopped, .. } = exposed;
    if rendered.cancelled {
        let (fewest, most) = rendered.samples;
        let why = if stopped.is_some() { "stopped" } else { "interrupted" };
        let of = match shutter.moments() {
            1 => String::new(),
            all => format!(", in {moments} of {all} moments"),
        };
        say(&format!("{why}: saved with {fewest} to {most} of {} samples{of}", args.spp));
        if rendered.without_samples > 0 {
            let (without, all) = (rendered.without_samples, job.settings.crop.area());
            say(&format!("{without} of {all} pixels have no sample: they are black"));
        }
        return stopped.map_or_else(|| Ok(interrupt.exit_code()), Err);
    }
    Ok(ExitCode::SUCCESS)
}

/// The flags of a scene and further words of a command line, of which a later one overrides an
/// earlier one, over the settings that the scene itself brings.
///
/// # Errors
/// [`CliError::Usage`] for words that `dapple render` does not take.
pub fn parse(scene: &Path, words: &[String]) -> Result<RenderArgs, CliError> {
    let all = std::iter::once(scene.into()).chain(words.iter().map(OsString::from)).collect();
    layers::settled(all).map(|settled| settled.args)
}

/// Renders a scene by the words of a command line, without saying what it takes and without writing
/// a file: for `dapple golden`.
///
/// # Errors
/// All that [`run`] may fail with, and flags that ask for other outputs.
pub fn picture(scene: &Path, words: &[String]) -> Result<Picture, CliError> {
    let args = parse(scene, words)?;
    let misplaced = [
        ("-o", args.output.is_some()),
        ("--png", args.png.is_some()),
        ("--debug-sample", args.debug_sample.is_some()),
        ("--json", args.json),
        ("--dry-run", args.dry_run),
        ("--print-config", args.print_config),
    ];
    if let Some((flag, _)) = misplaced.iter().find(|(_, given)| *given) {
        let message = format!("{flag} has no place here: the picture is compared, not written");
        return Err(CliError::Usage(message));
    }
    let job = Shutter::new(&args).first(&args)?;
    let cancel = AtomicBool::new(false);
    let Exposed { mut rendered, stopped, .. } = on_pool(&args, &job, &cancel, ProgressStyle::None)?;
    if let Some(error) = stopped {
        return Err(error);
    }
    let named = ["render".to_owned(), scene.display().to_string()];
    let words: Vec<String> = named.into_iter().chain(words.iter().cloned()).collect();
    describe(&mut rendered, &args, &job, &words);
    report_lost(&rendered, &words);
    Ok(rendered.picture)
}

fn outputs(args: &RenderArgs) -> Vec<Output<'_>> {
    let exr = args.output.as_deref().map(|path| Output { flag: "-o", path, ending: "exr" });
    let png = args.png.as_deref().map(|path| Output { flag: "--png", path, ending: "png" });
    exr.into_iter().chain(png).collect()
}

fn inputs(args: &RenderArgs) -> Vec<&Path> {
    let environment = match &args.env {
        Some(EnvironmentSource::File(path)) => Some(path.as_path()),
        _ => None,
    };
    std::iter::once(args.scene_file()).chain(environment).collect()
}

/// A picture, and what it took.
struct Exposed {
    rendered: Rendered,
    /// Time to read and prepare the scene, of all moments.
    loaded: Duration,
    /// Time to build structures, of all moments.
    built: Duration,
    /// How many moments have samples.
    moments: usize,
    /// What ended it before the last moment.
    stopped: Option<CliError>,
}

/// Builds the structure and renders, on as many threads as asked for; moment by moment if the
/// shutter is open for some time, of which `job` is the first. Where a later one fails, what there
/// is is the picture.
fn on_pool(
    args: &RenderArgs,
    job: &Job,
    cancel: &AtomicBool,
    style: ProgressStyle,
) -> Result<Exposed, CliError> {
    let crop = job.settings.crop;
    let what = format!("a picture of {}x{}", crop.width(), crop.height());
    memory::require(&what, film_bytes(&job.settings))?;
    let shutter = Shutter::new(args);
    input::on_threads(args.threads, || {
        let reporter = Reporter::new(if args.quiet { ProgressStyle::None } else { style });
        let control = Control { cancel, progress: &|progress| reporter.update(progress) };
        let mut exposure = Exposure::new(&job.settings);
        let (mut loaded, mut built) = (job.elapsed, Duration::ZERO);
        let (mut moments, mut stopped) = (0, None);
        let mut expose = |moment: usize| -> Result<(), CliError> {
            let later = shutter.later(args, job, moment)?;
            if let Some(later) = &later {
                loaded += later.elapsed;
                if !args.quiet {
                    later.notices.iter().for_each(note);
                }
                if cancel.load(Ordering::Relaxed) {
                    return Ok(());
                }
            }
            let now = later.as_ref().unwrap_or(job);
            let start = Instant::now();
            let accel = accel::build(&args.accel, now.world.triangles.clone(), args.isa)?;
            built += start.elapsed();
            if args.verbose > 0 && moment == 0 {
                say(&format!("built {} in {:.2} s", args.accel, built.as_secs_f64()));
            }
            exposure.expose(&now.world, &now.camera, &*accel, shutter.end(moment), &control);
            moments += 1;
            Ok(())
        };
        for moment in 0..shutter.moments() {
            match expose(moment) {
                Err(error) if moment == 0 => return Err(error),
                Err(error) => stopped = Some(error),
                Ok(()) => {}
            }
            if stopped.is_some() || cancel.load(Ordering::Relaxed) {
                break;
            }
        }
        reporter.finish();
        Ok(Exposed { rendered: exposure.develop(), loaded, built, moments, stopped })
    })?
}

/// Tells what the scene asks in vain and what was decided for the user.
fn tell(args: &RenderArgs, job: &Job) {
    job.notices.iter().for_each(note);
    if args.verbose > 0 {
        let scene = &job.world.scene;
        say(&format!(
            "{}: {} triangles, {} instances of {} meshes, {} materials, {} textures, {} lights; {:.2} s",
            args.scene_file().display(),
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
fn debug(
    args: &RenderArgs,
    shutter: &Shutter,
    first: &Job,
    sample: (u32, u32, u64),
) -> Result<ExitCode, CliError> {
    let (width, height) = first.settings.resolution;
    if sample.0 >= width || sample.1 >= height {
        let message = format!("--debug-sample: the frame is {width}x{height}");
        return Err(CliError::Usage(message));
    }
    let moment = shutter.moment_of(sample.2);
    let later = shutter.later(args, first, moment)?;
    let job = later.as_ref().unwrap_or(first);
    let path = input::on_threads(args.threads, || {
        let accel = accel::build(&args.accel, job.world.triangles.clone(), args.isa)?;
        Ok::<_, CliError>(replay(&job.world, &job.camera, &*accel, &job.settings, sample))
    })??;
    table::print(&path)?;
    Ok(ExitCode::SUCCESS)
}

/// Writes all outputs; where one fails the others are there still.
fn write(args: &RenderArgs, picture: &Picture) -> Result<(), CliError> {
    outputs::all(outputs(args).into_iter().map(|output| {
        let written = match output.ending {
            "png" => png::write(output.path, picture, args.tonemap, args.exposure),
            _ => exr::write(output.path, picture),
        };
        written.map_err(CliError::from)
    }))
}

/// Names the samples that were not finite, each with the command that follows it. `words` are those
/// of the command line, the first of them `render`.
fn report_lost(rendered: &Rendered, words: &[String]) {
    if rendered.lost_count == 0 {
        return;
    }
    say(&format!("warning: {} samples were not finite and are left out:", rendered.lost_count));
    for lost in &rendered.lost {
        say(&format!("  {}", replay_command(lost, words)));
    }
}

/// The flag comes before all others: nothing is one after a `--`.
fn replay_command(lost: &LostSample, words: &[String]) -> String {
    let place = format!("{},{},{}", lost.x, lost.y, lost.sample);
    let (command, rest) = words.split_at(words.len().min(1));
    let (command, rest) = (shell::line(command), shell::line(rest));
    format!("dapple {command} --debug-sample {place} {rest}")
}

/// The last line: what it took.
fn summary(args: &RenderArgs, job: &Job, exposed: &Exposed) -> String {
    let Exposed { rendered, loaded, built, .. } = exposed;
    let (width, height) = job.settings.resolution;
    let seconds = rendered.elapsed.as_secs_f64();
    let rays = rendered.rays.total() as f64;
    let outputs: Vec<String> = [&args.output, &args.png]
        .into_iter()
        .flatten()
        .map(|path| path.display().to_string())
        .collect();
    let samples = match rendered.samples {
        (fewest, most) if fewest == most => fewest.to_string(),
        (fewest, most) => format!("{fewest} to {most}"),
    };
    let memory = crate::files::memory::peak()
        .map_or(String::new(), |bytes| format!(", peak {:.0} MB", bytes as f64 / 1e6));
    format!(
        "{}: {width}x{height}, {samples} spp, {:.1} M rays in {:.2} s, {:.2} Mrays/s, \
         {:.2} µs a path; load {:.2} s, build {:.2} s{memory}",
        outputs.join(", "),
        rays / 1e6,
        seconds,
        rays / seconds.max(1e-9) / 1e6,
        seconds * 1e6 / rendered.paths.max(1) as f64,
        loaded.as_secs_f64(),
        built.as_secs_f64(),
    )
}

fn summary_json(args: &RenderArgs, job: &Job, exposed: &Exposed) -> String {
    let Exposed { rendered, loaded, built, moments, .. } = exposed;
    json!({
        "scene": args.scene_file(),
        "resolution": [job.settings.resolution.0, job.settings.resolution.1],
        "spp": rendered.samples.0,
        "accel": args.accel.to_string(),
        "paths": rendered.paths,
        "rays": rendered.rays.total(),
        "shadow_rays": rendered.rays.shadow,
        "render_s": rendered.elapsed.as_secs_f64(),
        "moments": moments,
        "load_s": loaded.as_secs_f64(),
        "build_s": built.as_secs_f64(),
        "mrays_s": rendered.rays.total() as f64 / rendered.elapsed.as_secs_f64().max(1e-9) / 1e6,
        "lost_samples": rendered.lost_count,
        "peak_bytes": crate::files::memory::peak(),
        "interrupted": rendered.cancelled,
        "pixels_without_samples": rendered.without_samples,
    })
    .to_string()
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
            .map_err(|error| CliError::Limit(format!("cannot listen to signals: {error}")))?;
        Ok(Self { raised, signal })
    }

    /// 130 after Ctrl-C, 143 after SIGTERM.
    fn exit_code(&self) -> ExitCode {
        ExitCode::from(128 + self.signal.load(Ordering::Relaxed) as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_that_follows_a_lost_sample_is_fit_for_a_shell() {
        let lost = LostSample { x: 3, y: 4, sample: 5 };
        let words = ["render", "-o", "it's.exr", "--", "my scene.gltf"].map(str::to_owned);
        let command = replay_command(&lost, &words);
        let expected = r"render --debug-sample 3,4,5 -o 'it'\''s.exr' -- 'my scene.gltf'";
        assert_eq!(command, format!("dapple {expected}"));
    }

    #[test]
    fn later_words_override_earlier_ones() {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<_>>();
        let args = parse(Path::new("a"), &words(&["--spp", "4", "--aov", "cost", "--spp", "8"]));
        assert_eq!(args.expect("good words").spp, 8);
        let error = parse(Path::new("a"), &words(&["--spq", "4"])).expect_err("no such flag");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().starts_with("unexpected argument '--spq'"), "{error}");
        for flags in [&["-o", "x"][..], &["--png", "x"], &["--json"], &["--debug-sample", "0,0,0"]]
        {
            let error = picture(Path::new("a"), &words(flags)).expect_err("misplaced");
            assert!(error.exit_code() == 2 && error.to_string().starts_with(flags[0]), "{error}");
        }
    }
}
