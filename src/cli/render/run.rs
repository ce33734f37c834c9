//! The command.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::header::describe;
use super::interrupt::Interrupt;
use super::moments::{self, Outcome};
use super::{dry_run, report};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::outputs::{self, Output};
use crate::cli::progress::{note, say};
use crate::cli::settings::parse::ProgressStyle;
use crate::cli::settings::{self, RenderArgs, Request, Table, Typed};
use crate::cli::{shell, text};
use crate::denoise::Denoiser;
use crate::film::Picture;
use crate::formats::EnvironmentSource;
use crate::render::replay;

/// Runs the command.
pub fn run(typed: &Typed) -> Result<ExitCode, CliError> {
    let Request { args, from } = settings::resolve(typed)?;
    let stops = args.debug_sample.is_some() || args.dry_run || args.print_config;
    if !stops {
        outputs::check_picture(&outputs(&args), &inputs(&args))?;
    }
    // Before the work, so that nobody waits in vain.
    let denoises = args.denoise && !stops;
    let denoiser = denoises.then(|| Denoiser::find(args.threads)).transpose()?;
    let interrupt = Interrupt::listen()?;
    let job = Job::prepare(args)?;
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
    let outcome = moments::render(&job, interrupt.raised(), job.args.progress)?;
    publish(&job, outcome, denoiser.as_ref(), &interrupt)
}

/// Writes the picture, denoised if it is to be, and says what it took.
fn publish(
    job: &Job,
    mut outcome: Outcome,
    denoiser: Option<&Denoiser>,
    interrupt: &Interrupt,
) -> Result<ExitCode, CliError> {
    if outcome.rendered.samples.1 == 0 {
        say("interrupted before the first samples: there is nothing to save");
        return Ok(interrupt.exit_code());
    }
    let words = shell::own_words();
    describe(&mut outcome.rendered, job, &words);
    report::print_lost(&outcome.rendered, &words);
    let denoised = match denoiser {
        Some(denoiser) => denoise(job, &mut outcome, denoiser),
        None => Ok(()),
    };
    outputs::try_all([write(&job.args, &outcome.rendered.picture), denoised])?;
    if !job.args.quiet {
        say(&report::summarize(job, &outcome));
    }
    if job.args.json {
        text::print(&format!("{}\n", report::summarize_as_json(job, &outcome)))?;
    }
    if !outcome.rendered.cancelled {
        return Ok(ExitCode::SUCCESS);
    }
    report::print_unfinished(job, &outcome);
    outcome.stopped.map_or_else(|| Ok(interrupt.exit_code()), Err)
}

/// Renders a scene by the words of a command line, without saying what it takes and without writing
/// a file: for `dapple golden`. A denoised layer is not made, since it is not the same everywhere.
///
/// # Errors
/// All that [`run`] may fail with, and flags that ask for other outputs.
pub fn render_picture(scene: &Path, words: &[String]) -> Result<Picture, CliError> {
    let mut args = settings::resolve_words(scene, words)?.args;
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
    args.denoise = false;
    let job = Job::prepare(args)?;
    let cancel = AtomicBool::new(false);
    let Outcome { mut rendered, stopped, .. } =
        moments::render(&job, &cancel, ProgressStyle::None)?;
    if let Some(error) = stopped {
        return Err(error);
    }
    let named = ["render".to_owned(), scene.display().to_string()];
    let words: Vec<String> = named.into_iter().chain(words.iter().cloned()).collect();
    describe(&mut rendered, &job, &words);
    report::print_lost(&rendered, &words);
    Ok(rendered.picture)
}

/// Adds the denoised layer, and drops those that were rendered for it alone. Whoever ended the
/// render early may end this too: the picture is written before.
fn denoise(job: &Job, outcome: &mut Outcome, denoiser: &Denoiser) -> Result<(), CliError> {
    let picture = &mut outcome.rendered.picture;
    if outcome.rendered.cancelled {
        write(&job.args, picture)?;
    }
    let start = Instant::now();
    let denoised = denoiser.denoise(picture, Path::new("the picture"));
    outcome.denoised = denoised.is_ok().then(|| start.elapsed());
    for layer in job.settings.aovs.iter().filter(|layer| !job.args.aov.contains(layer)) {
        let prefix = format!("{}.", layer.name());
        picture.retain_channels(|channel| !channel.starts_with(&prefix));
    }
    Ok(denoised?)
}

fn outputs(args: &RenderArgs) -> Vec<Output<'_>> {
    outputs::of_picture(args.output.as_deref(), args.png.as_deref())
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

fn write(args: &RenderArgs, picture: &Picture) -> Result<(), CliError> {
    outputs::write_picture(&outputs(args), picture, args.tonemap, args.exposure)
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
