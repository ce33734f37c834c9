//! The command.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use super::header::describe;
use super::interrupt::Interrupt;
use super::moments::{self, Outcome};
use super::{dry_run, report};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::outputs::{self, Output};
use crate::cli::progress::{note, say};
use crate::cli::settings::{self, Origin, RenderArgs, Request, Table, Typed};
use crate::cli::status::Phase;
use crate::cli::watch::{self, Watch};
use crate::cli::{shell, text};
use crate::film::{Picture, exr, png};
use crate::formats::EnvironmentSource;
use crate::render::replay;

/// Runs the command.
pub fn run(typed: &Typed) -> Result<ExitCode, CliError> {
    let Request { args, from } = settings::resolve(typed)?;
    let stops = args.debug_sample.is_some() || args.dry_run || args.print_config;
    if !stops {
        let outputs = outputs(&args);
        if outputs.is_empty() {
            return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
        }
        outputs::check(&[outputs, watch::outputs(&args)].concat(), &inputs(&args))?;
    }
    let watch = if stops { Watch::silent() } else { Watch::start(&args)? };
    let ended = run_watched(args, from.as_ref(), &watch);
    let told = watch.finish(ended.as_ref().map_or_else(CliError::exit_code, |&code| code));
    let code = ended?;
    told.map(|()| ExitCode::from(code))
}

/// The same, while someone watches. Returns the exit code.
fn run_watched(args: RenderArgs, from: Option<&Origin>, watch: &Watch) -> Result<u8, CliError> {
    let interrupt = Interrupt::listen()?;
    let job = Job::prepare(args)?;
    if !job.args.quiet {
        report::print_scene(&job);
        if let Some(from) = from {
            from.list_changes(job.first.world.scene.digest()).iter().for_each(note);
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
    let outcome = moments::render(&job, interrupt.raised(), watch)?;
    watch.enter(Phase::Write);
    watch.set_rays(outcome.rendered.rays.total());
    publish(&job, outcome, &interrupt, watch)
}

/// Writes the picture and says what it took.
fn publish(
    job: &Job,
    mut outcome: Outcome,
    interrupt: &Interrupt,
    watch: &Watch,
) -> Result<u8, CliError> {
    if outcome.rendered.samples.1 == 0 {
        say("interrupted before the first samples: there is nothing to save");
        return Ok(interrupt.exit_code());
    }
    let words = shell::own_words();
    describe(&mut outcome.rendered, job, &words);
    report::print_lost(&outcome.rendered, &words);
    let picture = &outcome.rendered.picture;
    outputs::try_all([write(&job.args, picture), watch.present(picture)])?;
    watch.tell(&report::summarize(job, &outcome));
    if job.args.json {
        text::print(&format!("{}\n", report::summarize_as_json(job, &outcome)))?;
    }
    if !outcome.rendered.cancelled {
        return Ok(0);
    }
    report::print_unfinished(job, &outcome);
    outcome.stopped.map_or_else(|| Ok(interrupt.exit_code()), Err)
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
    let cancel = AtomicBool::new(false);
    let Outcome { mut rendered, stopped, .. } = moments::render(&job, &cancel, &Watch::silent())?;
    if let Some(error) = stopped {
        return Err(error);
    }
    let named = ["render".to_owned(), scene.display().to_string()];
    let words: Vec<String> = named.into_iter().chain(words.iter().cloned()).collect();
    describe(&mut rendered, &job, &words);
    report::print_lost(&rendered, &words);
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
    std::iter::once(&*args.scene_file).chain(environment).collect()
}

/// Prints the path of one sample.
fn print_path(job: &Job, sample: (u32, u32, u64)) -> Result<u8, CliError> {
    let (width, height) = job.settings.resolution;
    if sample.0 >= width || sample.1 >= height {
        let message = format!("--debug-sample: the frame is {width}x{height}");
        return Err(CliError::Usage(message));
    }
    let later = job.pose(job.shutter.moment_of(sample.2))?;
    let now = later.as_ref().unwrap_or(&job.first);
    let path = job.on_threads(|| {
        let accel = job.build(&now.world)?;
        Ok::<_, CliError>(replay(&now.world, &now.camera, &*accel, &job.settings, sample))
    })??;
    text::print(&path)?;
    Ok(0)
}

/// Writes all outputs; where one fails the others are there still.
fn write(args: &RenderArgs, picture: &Picture) -> Result<(), CliError> {
    outputs::try_all(outputs(args).into_iter().map(|output| {
        let written = match output.ending {
            "png" => png::write(output.path, picture, args.tonemap, args.exposure),
            _ => exr::write(output.path, picture),
        };
        written.map_err(CliError::from)
    }))
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
