//! Builds and renders.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::checkpoint::{self, Checkpoint};
use super::signals::{AGAIN, Signals};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::memory;
use crate::cli::progress::say;
use crate::cli::status::Phase;
use crate::cli::watch::Watch;
use crate::render::{Film, Rendered, film_bytes, with_ticks};

/// The exit code where the temporary file of textures cannot be read.
const UNREADABLE: u8 = 4;

/// A film with all samples that could be taken, and what it took.
pub struct Exposed {
    pub film: Film,
    pub took: Took,
    /// Where it can go on from.
    pub checkpoint: Option<Checkpoint>,
}

/// A picture, and what it took.
pub struct Outcome {
    pub rendered: Rendered,
    pub took: Took,
}

/// What a render took besides samples.
#[derive(Default)]
pub struct Took {
    /// Time to read and prepare the scene.
    pub loaded: Duration,
    /// Time to build the structure.
    pub built: Duration,
    /// Time to denoise the picture, if it is.
    pub denoised: Option<Duration>,
    /// Whether it ended because its time was over.
    pub out_of_time: bool,
}

/// What a render answers to while it runs.
pub struct Control<'a> {
    pub signals: &'a Signals,
    pub watch: &'a Watch,
    /// When the process started.
    pub start: Instant,
    /// Saves what there is, where there is no checkpoint to save.
    pub save: &'a (dyn Fn(&Film) + Sync),
}

/// Takes the samples of a job, on as many threads as it asks for.
///
/// # Errors
/// What is wrong with the checkpoint, or with the structure for this scene.
pub fn expose(job: &Job, control: &Control<'_>) -> Result<Exposed, CliError> {
    let crop = job.settings.crop;
    let what = format!("a picture of {}x{}", crop.width(), crop.height());
    memory::require(&what, film_bytes(&job.settings))?;
    let mut film = Film::of_samples(job.settings.clone(), checkpoint::range(&job.args));
    let checkpoint = Checkpoint::open(job)?.map(|(checkpoint, restored)| {
        if let Some(restored) = restored {
            film.restore(restored.tiles, restored.elapsed);
            let (next, range) = (film.next_sample(), film.range());
            if !job.args.quiet {
                let (path, has) = (checkpoint.path().display(), next - range.start);
                let all = range.end - range.start;
                say(&format!("goes on from {path}: has {has} of {all} samples a pixel"));
            }
        }
        checkpoint
    });
    job.on_threads(|| {
        control.watch.expect_pixels(crop.area() as u64);
        let exposure = Exposure {
            job,
            control,
            film: &film,
            checkpoint: checkpoint.as_ref(),
            out_of_time: Mutex::new(false),
        };
        let took = exposure.expose()?;
        Ok(Exposed { film, took, checkpoint })
    })?
}

/// A render under way.
struct Exposure<'a> {
    job: &'a Job,
    control: &'a Control<'a>,
    film: &'a Film,
    checkpoint: Option<&'a Checkpoint>,
    out_of_time: Mutex<bool>,
}

impl Exposure<'_> {
    /// Builds the structure and takes the samples.
    fn expose(&self) -> Result<Took, CliError> {
        let (job, signals, watch) = (self.job, self.control.signals, self.control.watch);
        let mut took = Took { loaded: job.staged.elapsed, ..Took::default() };
        let end = self.film.range().end;
        if self.film.next_sample() >= end {
            return Ok(took);
        }
        let (accel, built) = job.take_structure(watch)?;
        took.built = built;
        if job.args.verbose > 0 {
            say(&format!("built {} in {:.2} s", job.args.accel, took.built.as_secs_f64()));
        }
        watch.enter(Phase::Render);
        signals.expect_samples();
        with_ticks(&|| self.tick(), || {
            let (world, camera) = (&job.staged.world, &job.staged.camera);
            self.film.accumulate(world, camera, &*accel, end, signals.cancel());
        });
        // What was rendered since is wrong: nothing of it is to be saved.
        if let Some(reason) = job.textures.failure() {
            let message = format!("textures: the temporary file cannot be read: {reason}");
            return Err(CliError::Output(message));
        }
        took.out_of_time = self.out_of_time.lock().is_ok_and(|it| *it);
        Ok(took)
    }

    /// Looks after the render, some ten times a second.
    fn tick(&self) {
        let Self { job, film, .. } = self;
        let watch = self.control.watch;
        watch.set_rays(film.rays().total());
        watch.update(film.progress(), &|| film.preview());
        if job.textures.failure().is_some() {
            self.control.signals.stop(UNREADABLE);
        }
        let is_over =
            |limit: Option<Duration>, spent: Duration| limit.is_some_and(|it| spent >= it);
        if is_over(job.args.stop_after, self.control.start.elapsed()) {
            self.control.signals.stop(AGAIN);
        }
        // A picture with holes is of no use.
        let has_all_pixels = || film.next_sample() > film.range().start;
        if is_over(job.args.time_limit, film.elapsed())
            && has_all_pixels()
            && !self.control.signals.is_cancelled()
            && let Ok(mut out_of_time) = self.out_of_time.lock()
        {
            *out_of_time = true;
            self.control.signals.stop(0);
        }
        let told = self.control.signals.takes_save();
        match self.checkpoint {
            // What ends the render saves it, too.
            Some(_) if self.control.signals.is_cancelled() => {}
            Some(checkpoint) => watch.count_checkpoints(checkpoint.look_after(film, told).into()),
            None if told => (self.control.save)(film),
            None => {}
        }
    }
}
