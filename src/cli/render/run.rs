//! The command.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use super::checkpoint;
use super::header::Header;
use super::moments::{self, Control, Exposed, Outcome};
use super::signals::Signals;
use super::{done, dry_run, frames, report};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::outputs::{self, Output};
use crate::cli::progress::{note, say};
use crate::cli::settings::parse::ProgressStyle;
use crate::cli::settings::{self, RenderArgs, Request, Table, Typed};
use crate::cli::{shell, text};
use crate::film::{Picture, exr, png};
use crate::formats::EnvironmentSource;
use crate::render::{Film, replay};
use crate::scene::Notice;

/// Runs the command.
pub fn run(typed: &Typed) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    let signals = Signals::listen()?;
    let Request { args, from } = settings::resolve(typed)?;
    let mut said = Vec::new();
    for args in frames::split(args)? {
        let request = Request { args: args?, from: from.clone() };
        let code = run_one(request, start, &signals, &mut said)?;
        signals.go_on();
        if signals.is_cancelled() {
            return Ok(code);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Renders a picture. What has been `said` of the scene already is not said again.
fn run_one(
    Request { args, from }: Request,
    start: Instant,
    signals: &Signals,
    said: &mut Vec<Notice>,
) -> Result<ExitCode, CliError> {
    let stops = args.debug_sample.is_some() || args.dry_run || args.print_config;
    let checkpoint = checkpoint::path(&args)?;
    if !stops {
        let outputs = outputs(&args, checkpoint.as_deref());
        if outputs.iter().all(|output| output.flag == "--checkpoint") {
            return Err(CliError::Usage("nowhere to put the picture: give -o FILE.exr".to_owned()));
        }
        outputs::check(&outputs, &inputs(&args))?;
    }
    let mut job = Job::prepare(args)?;
    job.first.notices.retain(|notice| !said.contains(notice));
    said.extend(job.first.notices.iter().cloned());
    if !job.args.quiet {
        report::print_scene(&job);
        if let Some(from) = &from {
            from.list_changes(job.first.world.scene.digest()).iter().for_each(note);
        }
    }
    if let Some(sample) = job.args.debug_sample {
        return print_path(&job, sample);
    }
    if job.args.print_config {
        text::print(&format!("[render]\n{}", Table::default().to_toml(&job.args)))?;
        return Ok(ExitCode::SUCCESS);
    }
    if job.args.dry_run {
        return dry_run::run(&job);
    }
    if done::is_done(&job)? {
        return Ok(ExitCode::SUCCESS);
    }
    let words = shell::own_words();
    let save = |film: &Film| save_picture(&job, film, &words);
    let control = Control { signals, style: job.args.progress, start, save: &save };
    let exposed = moments::expose(&job, &control)?;
    publish(&job, exposed, signals, &words)
}

/// Writes the outputs and says what it took.
fn publish(
    job: &Job,
    exposed: Exposed,
    signals: &Signals,
    words: &[String],
) -> Result<ExitCode, CliError> {
    let Exposed { film, took, checkpoint } = exposed;
    let save = || checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.save(&film));
    if film.is_blank() && !film.range().is_empty() {
        say("interrupted before the first samples: there is nothing to save");
        return Ok(signals.exit_code());
    }
    let is_whole = film.is_whole();
    // What is needed to go on comes first.
    let saved = if is_whole { Ok(()) } else { save() };
    let mut rendered = film.finish();
    Header::of_render(&rendered, job, words).apply(&mut rendered.picture);
    report::print_lost(&rendered, words);
    let written = write_part(job, &film);
    let written = outputs::try_all([saved, written, write(&job.args, &rendered.picture)]);
    if let Err(error) = written {
        return Err(match is_whole.then(save) {
            Some(Err(too)) => CliError::Several(vec![error, too]),
            _ => error,
        });
    }
    if is_whole && let Some(checkpoint) = &checkpoint {
        checkpoint.remove();
    }
    finish(job, Outcome { rendered, took }, signals)
}

/// Says what it took, and works out how the process ends.
fn finish(job: &Job, outcome: Outcome, signals: &Signals) -> Result<ExitCode, CliError> {
    if !job.args.quiet {
        say(&report::summarize(job, &outcome));
    }
    if job.args.json {
        text::print(&format!("{}\n", report::summarize_as_json(job, &outcome)))?;
    }
    let is_incomplete = report::is_incomplete(&outcome);
    if outcome.rendered.cancelled {
        report::print_unfinished(job, &outcome);
    } else if is_incomplete && !job.args.quiet {
        report::print_noisy(&outcome);
    }
    if let Some(error) = outcome.took.stopped {
        return Err(error);
    }
    if signals.code() == 0 && job.args.fail_incomplete && is_incomplete {
        let message = "the picture is not as good as was asked for (--fail-incomplete)";
        return Err(CliError::Limit(message.to_owned()));
    }
    Ok(signals.exit_code())
}

/// Writes what there is of the picture while more samples are taken. That it cannot is a warning.
fn save_picture(job: &Job, film: &Film, words: &[String]) {
    let mut rendered = film.finish();
    Header::of_render(&rendered, job, words).apply(&mut rendered.picture);
    if let Err(error) =
        outputs::try_all([write_part(job, film), write(&job.args, &rendered.picture)])
    {
        say(&format!("warning: {error}; the render goes on"));
    }
}

/// Writes the sums that are asked for.
fn write_part(job: &Job, film: &Film) -> Result<(), CliError> {
    let Some(path) = &job.args.partial else { return Ok(()) };
    let head = checkpoint::head(job)?;
    checkpoint::write(path, &head, film).map_err(|source| CliError::not_written(path, &source))
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
        ("--frames", args.frames.is_some()),
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
        style: ProgressStyle::None,
        start: Instant::now(),
        save: &|_| {},
    };
    let Exposed { film, took, .. } = moments::expose(&job, &control)?;
    if let Some(error) = took.stopped {
        return Err(error);
    }
    let named = ["render".to_owned(), scene.display().to_string()];
    let words: Vec<String> = named.into_iter().chain(words.iter().cloned()).collect();
    let mut rendered = film.finish();
    Header::of_render(&rendered, &job, &words).apply(&mut rendered.picture);
    report::print_lost(&rendered, &words);
    Ok(rendered.picture)
}

fn outputs<'a>(args: &'a RenderArgs, checkpoint: Option<&'a Path>) -> Vec<Output<'a>> {
    let exr = args.output.as_deref().map(|path| Output { flag: "-o", path, ending: "exr" });
    let png = args.png.as_deref().map(|path| Output { flag: "--png", path, ending: "png" });
    let partial = args.partial.as_deref();
    let part = partial.map(|path| Output { flag: "--partial", path, ending: "part" });
    let saved = checkpoint.map(|path| Output { flag: "--checkpoint", path, ending: "checkpoint" });
    [exr, png, part, saved].into_iter().flatten().collect()
}

fn inputs(args: &RenderArgs) -> Vec<&Path> {
    let environment = match &args.env {
        Some(EnvironmentSource::File(path)) => Some(path.as_path()),
        _ => None,
    };
    std::iter::once(&*args.scene_file).chain(environment).collect()
}

/// Prints the path of one sample.
fn print_path(job: &Job, sample: (u32, u32, u64)) -> Result<ExitCode, CliError> {
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
    Ok(ExitCode::SUCCESS)
}

/// Writes the pictures; where one fails the others are there still.
fn write(args: &RenderArgs, picture: &Picture) -> Result<(), CliError> {
    let exr = args.output.iter().map(|path| exr::write(path, picture));
    let png = args.png.iter().map(|path| png::write(path, picture, args.tonemap, args.exposure));
    outputs::try_all(exr.chain(png).map(|written| written.map_err(CliError::from)))
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
