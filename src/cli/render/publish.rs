//! The end of a render: its outputs, what it says of itself, and its exit code.

use std::path::Path;
use std::time::Instant;

use super::checkpoint::{self, Checkpoint};
use super::expose::{Control, Exposed, Outcome};
use super::header::Header;
use super::report;
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::outputs::{self, Output};
use crate::cli::progress::say;
use crate::cli::settings::RenderArgs;
use crate::cli::{text, watch};
use crate::denoise::Denoiser;
use crate::film::Picture;
use crate::formats::EnvironmentSource;
use crate::render::{Film, Rendered};

/// Writes what a render has come to.
pub struct Publisher<'a> {
    pub job: &'a Job,
    /// The words of the command line after `dapple`.
    pub words: &'a [String],
}

impl Publisher<'_> {
    /// Writes the outputs, denoised if they are to be, says what the render took, and returns the
    /// exit code.
    ///
    /// # Errors
    /// If an output cannot be written, or if the picture is not as good as was asked for.
    pub fn publish(
        &self,
        exposed: Exposed,
        denoiser: Option<&Denoiser>,
        control: &Control<'_>,
    ) -> Result<u8, CliError> {
        let Exposed { film, mut took, checkpoint } = exposed;
        if film.is_blank() && !film.range().is_empty() {
            say("interrupted before the first samples: there is nothing to save");
            return Ok(control.signals.code());
        }
        let save = |checkpoint: &Checkpoint| checkpoint.save(&film);
        let is_whole = film.is_whole();
        // What is needed to go on comes first.
        let saved = checkpoint.as_ref().filter(|_| !is_whole).map_or(Ok(()), save);
        let mut rendered = self.develop(&film);
        report::print_lost(&rendered, self.words);
        control.watch.set_rays(rendered.rays.total());
        let denoised = match denoiser {
            Some(denoiser) => {
                let start = Instant::now();
                let denoised = self.denoise(&mut rendered, denoiser);
                took.denoised = denoised.is_ok().then(|| start.elapsed());
                denoised
            }
            None => Ok(()),
        };
        let picture = &rendered.picture;
        let shown = control.watch.present(picture, self.label(picture).as_deref());
        let written = [self.write_part(&film), self.write(picture), shown, denoised];
        if let Err(error) = outputs::try_all([saved].into_iter().chain(written)) {
            return Err(match checkpoint.as_ref().filter(|_| is_whole).map(save) {
                Some(Err(too)) => CliError::Several(vec![error, too]),
                _ => error,
            });
        }
        if let Some(checkpoint) = checkpoint.filter(|_| is_whole) {
            checkpoint.remove();
        }
        self.tell(&Outcome { rendered, took }, control)
    }

    /// Writes what there is of the picture while more samples are taken. That it cannot is a
    /// warning.
    pub fn save(&self, film: &Film) {
        let mut rendered = self.develop(film);
        self.drop_extra_layers(&mut rendered.picture);
        if let Err(error) = outputs::try_all([self.write_part(film), self.write(&rendered.picture)])
        {
            say(&format!("warning: {error}; the render goes on"));
        }
    }

    /// Says what the render took, and works out how the process ends.
    fn tell(&self, outcome: &Outcome, control: &Control<'_>) -> Result<u8, CliError> {
        let job = self.job;
        control.watch.tell(&report::summarize(job, outcome));
        if job.args.verbose > 0 {
            say(&report::describe_textures(&job.textures.figures()));
        }
        if job.args.json {
            text::print(&format!("{}\n", report::summarize_as_json(job, outcome)))?;
        }
        if !job.args.quiet {
            report::print_cut(job, outcome);
        }
        let is_incomplete = report::is_incomplete(outcome);
        if outcome.rendered.cancelled {
            report::print_unfinished(job, outcome);
        } else if is_incomplete && !job.args.quiet {
            report::print_noisy(outcome);
        }
        let code = control.signals.code();
        if code == 0 && job.args.fail_incomplete && is_incomplete {
            let message = "the picture is not as good as was asked for (--fail-incomplete)";
            return Err(CliError::Limit(message.to_owned()));
        }
        Ok(code)
    }

    /// The picture of the samples so far, with its header.
    fn develop(&self, film: &Film) -> Rendered {
        let mut rendered = film.finish();
        Header::of_render(&rendered, self.job, self.words).apply(&mut rendered.picture);
        rendered
    }

    /// Adds the denoised layer, and drops those that were rendered for it alone. Whoever ended the
    /// render early may end this too: the picture is written before.
    fn denoise(&self, rendered: &mut Rendered, denoiser: &Denoiser) -> Result<(), CliError> {
        if rendered.cancelled {
            self.write(&rendered.picture)?;
        }
        let denoised = denoiser.denoise(&mut rendered.picture, Path::new("the picture"));
        self.drop_extra_layers(&mut rendered.picture);
        Ok(denoised?)
    }

    /// Drops the layers that were rendered for the denoiser alone.
    fn drop_extra_layers(&self, picture: &mut Picture) {
        let wanted = &self.job.args.aov;
        for layer in self.job.settings.aovs.iter().filter(|layer| !wanted.contains(layer)) {
            let prefix = format!("{}.", layer.name());
            picture.retain_channels(|channel| !channel.starts_with(&prefix));
        }
    }

    /// Writes the sums that are asked for.
    fn write_part(&self, film: &Film) -> Result<(), CliError> {
        let Some(path) = &self.job.args.partial else { return Ok(()) };
        let head = checkpoint::head(self.job);
        checkpoint::write(path, &head, film).map_err(|source| CliError::not_written(path, &source))
    }

    /// The label of a picture's PNG, if it is whole.
    fn label(&self, picture: &Picture) -> Option<String> {
        let is_whole = !picture.strings.contains_key("dapple/unfinished");
        Header::label_of(self.job).filter(|_| is_whole)
    }

    /// Writes the pictures; where one fails the others are there still.
    fn write(&self, picture: &Picture) -> Result<(), CliError> {
        let args = &self.job.args;
        let label = self.label(picture);
        let (tonemap, exposure) = (args.tonemap, args.exposure);
        outputs::write_picture(&pictures(args), picture, tonemap, exposure, label.as_deref())
    }
}

/// Makes sure that all outputs can be written, before the work.
///
/// # Errors
/// Those of [`outputs::check`], and [`CliError::Usage`] if there is nowhere to put the picture.
pub fn check_outputs(args: &RenderArgs, checkpoint: Option<&Path>) -> Result<(), CliError> {
    let partial = args.partial.as_deref();
    let part = partial.map(|path| Output { flag: "--partial", path, ending: "part" });
    let saved = checkpoint.map(|path| Output { flag: "--checkpoint", path, ending: "checkpoint" });
    let mut all: Vec<Output<'_>> = pictures(args).into_iter().chain(part).collect();
    if all.is_empty() {
        return outputs::check_picture(&all, &[]);
    }
    all.extend(saved);
    all.extend(watch::outputs(args));
    outputs::check(&all, &inputs(args))
}

fn pictures(args: &RenderArgs) -> Vec<Output<'_>> {
    outputs::of_picture(args.output.as_deref(), args.png.as_deref())
}

fn inputs(args: &RenderArgs) -> Vec<&Path> {
    let environment = match &args.env {
        Some(EnvironmentSource::File(path)) => Some(path.as_path()),
        _ => None,
    };
    std::iter::once(&*args.scene_file).chain(environment).collect()
}
