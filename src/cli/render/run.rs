//! The command.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use super::checkpoint;
use super::expose::{Control, Exposed, expose};
use super::header::Header;
use super::listen::listen;
use super::publish::{self, Publisher};
use super::signals::Signals;
use super::{done, dry_run, frames, report};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::progress::note;
use crate::cli::settings::parse::LightArg;
use crate::cli::settings::{self, Request, Table, Typed};
use crate::cli::status::Phase;
use crate::cli::watch::Watch;
use crate::cli::{shell, text};
use crate::denoise::Denoiser;
use crate::film::Picture;
use crate::render::{Film, replay};
use crate::scene::Notice;

/// Runs the command.
pub fn run(typed: &Typed) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    let signals = listen()?;
    let Request { args, from } = settings::resolve(typed)?;
    let mut before = Before::default();
    for args in frames::split(args)? {
        let mut args = args?;
        if args.light == LightArg::Auto {
            args.light = before.light;
        }
        let request = Request { args, from: from.clone() };
        let code = run_one(request, (start, &signals), &mut before)?;
        signals.go_on();
        if signals.is_cancelled() {
            return Ok(ExitCode::from(code));
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// What frames before have told of the scene.
#[derive(Default)]
struct Before {
    /// It is not said again.
    said: Vec<Notice>,
    /// What lights all frames, unless that must be asked anew.
    light: LightArg,
}

/// Renders a picture, while someone watches. Returns the exit code.
fn run_one(
    Request { args, from }: Request,
    (start, signals): (Instant, &Signals),
    before: &mut Before,
) -> Result<u8, CliError> {
    let stops = args.debug_sample.is_some() || args.dry_run || args.print_config;
    let checkpoint = checkpoint::path(&args)?;
    if !stops {
        publish::check_outputs(&args, checkpoint.as_deref())?;
    }
    // Before the work, so that nobody waits in vain.
    let denoises = args.denoise && !stops;
    let denoiser = denoises.then(|| Denoiser::find(args.threads)).transpose()?;
    let watch = if stops { Watch::silent() } else { Watch::start(&args)? };
    let request = Request { args, from };
    let ended = run_watched(request, denoiser.as_ref(), (start, signals, &watch), before);
    let told = watch.finish(ended.as_ref().map_or_else(CliError::exit_code, |&code| code));
    let code = ended?;
    told.map(|()| code)
}

fn run_watched(
    Request { args, from }: Request,
    denoiser: Option<&Denoiser>,
    (start, signals, watch): (Instant, &Signals, &Watch),
    before: &mut Before,
) -> Result<u8, CliError> {
    let mut job = if args.print_config {
        // What settings say needs no look at the scene, and leaves the light open.
        let light = args.light;
        let mut job = Job::prepare(args)?;
        job.args.light = light;
        job
    } else {
        Job::prepare_looking(args, watch)?
    };
    job.staged.notices.retain(|notice| !before.said.contains(notice));
    before.said.extend(job.staged.notices.iter().cloned());
    // How bright a lamp is, is found out by a look.
    if matches!(job.args.light, LightArg::File | LightArg::Sky) {
        before.light = job.args.light;
    }
    if !job.args.quiet {
        report::print_scene(&job);
        if let Some(from) = &from {
            from.list_changes(&job.staged.world.scene.digest_text()).iter().for_each(note);
        }
    }
    if let Some(sample) = job.args.debug_sample {
        return print_path(&job, sample);
    }
    if job.args.print_config {
        text::print(&format!("[render]\n{}", Table::default().to_toml(&job.args)))?;
        return Ok(0);
    }
    if job.args.dry_run {
        return dry_run::run(&job).map(|_| 0);
    }
    if done::is_done(&job)? {
        return Ok(0);
    }
    let words = shell::own_words();
    let publisher = Publisher { job: &job, words: &words };
    let save = |film: &Film| publisher.save(film);
    let control = Control { signals, watch, start, save: &save };
    let exposed = expose(&job, &control)?;
    watch.enter(Phase::Write);
    publisher.publish(exposed, denoiser, &control)
}

/// Renders a scene by the words of a command line, without saying what it takes and without writing
/// a file: for `dapple golden`.
///
/// # Errors
/// All that [`run`] may fail with, and flags that ask for other outputs.
pub fn render_picture(scene: &Path, words: &[String]) -> Result<Picture, CliError> {
    let args = settings::resolve_words(scene, words)?.args;
    let misplaced = [
        ("-o", args.output.is_some()),
        ("--png", args.png.is_some()),
        ("--partial", args.partial.is_some()),
        ("--checkpoint", args.checkpoint.is_some()),
        ("--resume", args.resume.is_some()),
        ("--debug-sample", args.debug_sample.is_some()),
        ("--json", args.json),
        ("--dry-run", args.dry_run),
        ("--print-config", args.print_config),
    ];
    if let Some((flag, _)) = misplaced.iter().find(|(_, given)| *given) {
        let message = format!("{flag} has no place here: the picture is compared, not written");
        return Err(CliError::Usage(message));
    }
    let job = Job::prepare(args)?;
    let signals = Signals::default();
    let control = Control {
        signals: &signals,
        watch: &Watch::silent(),
        start: Instant::now(),
        save: &|_| {},
    };
    let Exposed { film, .. } = expose(&job, &control)?;
    let named = ["render".to_owned(), scene.display().to_string()];
    let words: Vec<String> = named.into_iter().chain(words.iter().cloned()).collect();
    let mut rendered = film.finish();
    Header::of_render(&rendered, &job, &words).apply(&mut rendered.picture);
    report::print_lost(&rendered, &words);
    Ok(rendered.picture)
}

/// Prints the path of one sample.
fn print_path(job: &Job, sample: (u32, u32, u64)) -> Result<u8, CliError> {
    let (width, height) = job.settings.resolution;
    if sample.0 >= width || sample.1 >= height {
        let message = format!("--debug-sample: the frame is {width}x{height}");
        return Err(CliError::Usage(message));
    }
    let path = job.on_threads(|| {
        let (accel, _) = job.take_structure(&Watch::silent())?;
        let (world, camera) = (&job.staged.world, &job.staged.camera);
        Ok::<_, CliError>(replay(world, camera, &*accel, &job.settings, sample))
    })??;
    text::print(&path)?;
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_that_ask_for_other_outputs_are_refused_where_pictures_are_compared() {
        for flags in [&["-o", "x"][..], &["--png", "x"], &["--json"], &["--debug-sample", "0,0,0"]]
        {
            let words: Vec<String> = flags.iter().map(|&word| word.to_owned()).collect();
            let error = render_picture(Path::new("a"), &words).expect_err("misplaced");
            assert!(error.exit_code() == 2 && error.to_string().starts_with(flags[0]), "{error}");
        }
    }
}
