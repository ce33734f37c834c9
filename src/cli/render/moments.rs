//! Builds and renders, moment by moment if the shutter is open for some time.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::memory;
use crate::cli::progress::{Reporter, note, say};
use crate::cli::settings::parse::ProgressStyle;
use crate::render::{Control, FilmAccumulator, Rendered, film_bytes};

/// A picture, and what it took.
pub struct Outcome {
    pub rendered: Rendered,
    /// Time to read and prepare the scene, at all moments.
    pub loaded: Duration,
    /// Time to build structures, at all moments.
    pub built: Duration,
    /// Time that denoising took, if the picture has been denoised.
    pub denoised: Option<Duration>,
    /// How many moments have samples.
    pub moments: usize,
    /// What ended it before the last moment.
    pub stopped: Option<CliError>,
}

/// Renders a job, on as many threads as it asks for.
///
/// # Errors
/// What is wrong at the first moment. Where a later one fails, the picture is of those before.
pub fn render(job: &Job, cancel: &AtomicBool, style: ProgressStyle) -> Result<Outcome, CliError> {
    let crop = job.settings.crop;
    let what = format!("a picture of {}x{}", crop.width(), crop.height());
    memory::require(&what, film_bytes(&job.settings))?;
    job.on_threads(|| {
        let style = if job.args.quiet { ProgressStyle::None } else { style };
        let reporter = Reporter::new(style);
        let control = Control { cancel, progress: &|progress| reporter.update(progress) };
        let mut progress = Progress {
            film: FilmAccumulator::new(&job.settings),
            loaded: job.first.elapsed,
            built: Duration::ZERO,
            moments: 0,
        };
        let mut stopped = None;
        for moment in 0..job.shutter.moments() {
            match progress.add_moment(job, moment, &control) {
                Err(error) if moment == 0 => return Err(error),
                Err(error) => stopped = Some(error),
                Ok(()) => {}
            }
            if stopped.is_some() || cancel.load(Ordering::Relaxed) {
                break;
            }
        }
        reporter.finish();
        let Progress { film, loaded, built, moments } = progress;
        Ok(Outcome { rendered: film.finish(), loaded, built, denoised: None, moments, stopped })
    })?
}

/// What there is between moments.
struct Progress<'a> {
    film: FilmAccumulator<'a>,
    loaded: Duration,
    built: Duration,
    moments: usize,
}

impl Progress<'_> {
    /// Poses the scene, builds the structure and takes the samples of a moment.
    fn add_moment(
        &mut self,
        job: &Job,
        moment: usize,
        control: &Control<'_>,
    ) -> Result<(), CliError> {
        let later = job.pose(moment)?;
        if let Some(later) = &later {
            self.loaded += later.elapsed;
            if !job.args.quiet {
                later.notices.iter().for_each(note);
            }
            if control.cancel.load(Ordering::Relaxed) {
                return Ok(());
            }
        }
        let now = later.as_ref().unwrap_or(&job.first);
        let start = Instant::now();
        let accel = job.build(&now.world)?;
        self.built += start.elapsed();
        if job.args.verbose > 0 && moment == 0 {
            say(&format!("built {} in {:.2} s", job.args.accel, self.built.as_secs_f64()));
        }
        let end = job.shutter.end(moment);
        self.film.accumulate(&now.world, &now.camera, &*accel, end, control);
        self.moments += 1;
        Ok(())
    }
}
