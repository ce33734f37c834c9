//! All that watch a run, for those who run it.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use super::courier::Courier;
use super::due::Due;
use super::metrics::{self, Figures};
use super::outlet::Outlet;
use super::preview::Preview;
use super::show::{Found, Screen, detect};
use super::tev::Link;
use crate::cli::error::{CliError, format_chain};
use crate::cli::outputs::Output;
use crate::cli::progress::{Reporter, format_line, say};
use crate::cli::settings::RenderArgs;
use crate::cli::settings::parse::ProgressStyle;
use crate::cli::settings::parse_long::Every;
use crate::cli::settings::parse_watch::{Show, TevAddress};
use crate::cli::status::{Phase, Status};
use crate::cli::{log, shell};
use crate::files::Meter;
use crate::film::Picture;
use crate::render::Progress;

/// Between pictures for a preview and for a terminal, where nothing else is asked for.
const PICTURE_EVERY: Duration = Duration::from_secs(5);
/// Between pictures for tev.
const TEV_EVERY: Duration = Duration::from_secs(1);
/// Between lines of the log, and between metrics.
const FIGURES_EVERY: Duration = Duration::from_secs(10);
/// How long the last picture in a terminal or in tev is waited for.
const LAST_WAIT: Duration = Duration::from_secs(10);

/// All that watch a run: what reports progress, previews, viewers, the log and metrics.
///
/// Whatever they do that may take long is done on threads of their own.
pub struct Watch {
    reporter: Reporter,
    status: Mutex<Status>,
    outlets: Mutex<Vec<Outlet>>,
    preview: Option<Preview>,
    metrics: Option<MetricsFile>,
    /// When the log gets its next line about progress.
    log: Option<Mutex<Due>>,
    rays: AtomicU64,
    checkpoints: AtomicU64,
    quiet: bool,
}

/// A file of metrics, and who writes it.
struct MetricsFile {
    path: PathBuf,
    scene: String,
    started: SystemTime,
    due: Mutex<Due>,
    courier: Courier<String>,
}

/// The files that watchers write, which are to be checked with the others.
pub fn outputs(args: &RenderArgs) -> Vec<Output<'_>> {
    let files = [
        ("--preview", &args.preview, "png"),
        ("--log", &args.log, Output::APPENDED),
        ("--metrics", &args.metrics, "prom"),
    ];
    let named = files
        .into_iter()
        .filter_map(|(flag, path, ending)| Some(Output { flag, path: path.as_deref()?, ending }));
    named.collect()
}

impl Watch {
    /// Begins to watch a run with such settings. Its log begins here.
    ///
    /// # Errors
    /// [`CliError::Output`] if the log cannot be written, [`CliError::Limit`] if there is no
    /// thread.
    pub fn start(args: &RenderArgs) -> Result<Self, CliError> {
        if let Some(path) = &args.log {
            log::open(path).map_err(|error| CliError::not_written(path, &error))?;
            log::write(&describe_run(args));
        }
        let figures = || Mutex::new(Due::new(Every::Time(FIGURES_EVERY)));
        let mut watch =
            Self::with_style(if args.quiet { ProgressStyle::None } else { args.progress });
        watch.quiet = args.quiet;
        watch.log = args.log.as_ref().map(|_| figures());
        watch.start_outlets(args).map_err(|error| {
            CliError::Limit(format!("cannot start a thread for previews: {error}"))
        })?;
        watch.enter(Phase::Read);
        if let Some(metrics) = &watch.metrics {
            metrics.courier.give(watch.format_figures(metrics, None));
        }
        Ok(watch)
    }

    /// Watches nothing.
    pub fn silent() -> Self {
        Self { quiet: true, ..Self::with_style(ProgressStyle::None) }
    }

    fn with_style(style: ProgressStyle) -> Self {
        Self {
            reporter: Reporter::new(style),
            status: Mutex::default(),
            outlets: Mutex::default(),
            preview: None,
            metrics: None,
            log: None,
            rays: AtomicU64::new(0),
            checkpoints: AtomicU64::new(0),
            quiet: false,
        }
    }

    fn start_outlets(&mut self, args: &RenderArgs) -> std::io::Result<()> {
        let every = args.every.unwrap_or(Every::Time(PICTURE_EVERY));
        let (tonemap, exposure) = (args.tonemap, args.exposure);
        let outlets = self.outlets.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(path) = &args.preview {
            let preview = Preview { path: path.clone(), tonemap, exposure };
            self.preview = Some(preview.clone());
            outlets.push(start_preview(preview, every)?);
        }
        if let Some(screen) = args.show.and_then(|wish| find_screen(args, wish)) {
            outlets.push(start_screen(screen, every)?);
        }
        if let Some(address) = &args.tev {
            outlets.push(start_tev(args, address.clone())?);
        }
        if let Some(path) = &args.metrics {
            self.metrics = Some(MetricsFile::start(path.clone(), args)?);
        }
        Ok(())
    }

    /// Takes note of how many pixels share the samples.
    pub fn expect_pixels(&self, pixels: u64) {
        self.status().pixels = pixels;
        self.reporter.expect_pixels(pixels);
    }

    /// Takes note of what the run does from now on.
    pub fn enter(&self, phase: Phase) {
        self.status().phase = phase;
        self.reporter.enter(phase);
    }

    /// What is told how much of the reading or the building is done.
    pub fn meter(&self) -> &Arc<Meter> {
        self.reporter.meter()
    }

    /// Takes note of how many rays were shot since the run began.
    pub fn set_rays(&self, rays: u64) {
        self.rays.store(rays, Ordering::Relaxed);
    }

    /// Takes note of checkpoints that were written.
    pub fn count_checkpoints(&self, count: u64) {
        self.checkpoints.fetch_add(count, Ordering::Relaxed);
    }

    /// Takes note of the progress. `snapshot` makes a picture of the colours so far; it is called
    /// if someone is to have one now.
    pub fn update(&self, progress: Progress, snapshot: &(dyn Fn() -> Picture + Sync)) {
        let samples = {
            let mut status = self.status();
            status.progress = Some(progress);
            status.samples_per_pixel()
        };
        self.reporter.update(progress);
        if let Some(due) = &self.log
            && lock(due).take(progress.elapsed, 0.0)
        {
            log::write(&format_line(progress));
        }
        if let Some(metrics) = &self.metrics
            && lock(&metrics.due).take(progress.elapsed, 0.0)
        {
            metrics.courier.give(self.format_figures(metrics, None));
        }
        // Before the first sample there is nothing to see, and the last picture comes at the end.
        if progress.done > 0 && progress.done < progress.total {
            let mut made: Option<Arc<Picture>> = None;
            let mut picture = || Arc::clone(made.get_or_insert_with(|| Arc::new(snapshot())));
            for outlet in &*lock(&self.outlets) {
                outlet.update(progress.elapsed, samples, &mut picture);
            }
        }
    }

    /// Prints what is not worth a word if it is to be quiet; the log gets it in any case.
    pub fn tell(&self, line: &str) {
        if self.quiet { log::write(line) } else { say(line) }
    }

    /// Gives the last picture to all that show one, and waits for them within bounds. `label` is
    /// that of its PNG.
    ///
    /// # Errors
    /// [`CliError::Film`] if the preview could not be written.
    pub fn present(&self, picture: &Picture, label: Option<&str>) -> Result<(), CliError> {
        let mut made: Option<Arc<Picture>> = None;
        let mut last = || Arc::clone(made.get_or_insert_with(|| Arc::new(colours_of(picture))));
        for outlet in lock(&self.outlets).drain(..) {
            outlet.finish(&mut last);
        }
        self.preview.as_ref().map_or(Ok(()), |preview| preview.write(picture, label))?;
        Ok(())
    }

    /// Ends the run, well or not: the log and the metrics tell the exit code.
    ///
    /// # Errors
    /// [`CliError::Output`] if the metrics could not be written.
    pub fn finish(mut self, exit_code: u8) -> Result<(), CliError> {
        self.status().phase = Phase::End;
        self.reporter.finish();
        log::write(&format!("ends with exit code {exit_code}"));
        let Some(metrics) = self.metrics.take() else { return Ok(()) };
        let text = self.format_figures(&metrics, Some(exit_code));
        metrics.courier.finish(LAST_WAIT);
        metrics::write(&metrics.path, &text)
            .map_err(|error| CliError::not_written(&metrics.path, &error))
    }

    fn status(&self) -> MutexGuard<'_, Status> {
        lock(&self.status)
    }

    fn format_figures(&self, metrics: &MetricsFile, exit_code: Option<u8>) -> String {
        let rays = self.rays.load(Ordering::Relaxed);
        let figures = Figures {
            status: *self.status(),
            started: metrics.started,
            rays: (rays > 0).then_some(rays),
            checkpoints: self.checkpoints.load(Ordering::Relaxed),
            exit_code,
        };
        metrics::format(&metrics.scene, &figures)
    }
}

impl MetricsFile {
    fn start(path: PathBuf, args: &RenderArgs) -> std::io::Result<Self> {
        let to = path.clone();
        let mut failed = false;
        let courier = Courier::start("metrics", move |text: String| {
            let written = metrics::write(&to, &text);
            let written = written.map_err(|error| CliError::not_written(&to, &error));
            warn_once(&mut failed, written);
            Duration::ZERO
        })?;
        Ok(Self {
            path,
            scene: args.scene_file.display().to_string(),
            started: SystemTime::now(),
            due: Mutex::new(Due::new(Every::Time(FIGURES_EVERY))),
            courier,
        })
    }
}

fn start_preview(preview: Preview, every: Every) -> std::io::Result<Outlet> {
    let mut failed = false;
    Outlet::start("preview", every, None, move |picture| {
        warn_once(&mut failed, preview.write(picture, None).map_err(CliError::from));
        Duration::ZERO
    })
}

fn start_screen(mut screen: Screen, every: Every) -> std::io::Result<Outlet> {
    Outlet::start("show", every, Some(LAST_WAIT), move |picture| {
        screen.show(picture);
        Duration::ZERO
    })
}

fn start_tev(args: &RenderArgs, address: TevAddress) -> std::io::Result<Outlet> {
    let target = [&args.output, &args.png].into_iter().flatten().next();
    let name = format!("dapple: {}", target.unwrap_or(&args.scene_file).display());
    let quiet = args.quiet;
    let tell = move |line: &str| if quiet { log::write(line) } else { say(line) };
    let mut link = Link::new(address, name, Box::new(tell));
    let every = Every::Time(TEV_EVERY);
    Outlet::start("tev", every, Some(LAST_WAIT), move |picture| link.show(picture))
}

/// Where pictures are shown, if they are; what a user may not expect is said.
fn find_screen(args: &RenderArgs, wish: Show) -> Option<Screen> {
    let found = detect(wish, stderr().is_terminal(), &|name| std::env::var(name).ok());
    let (way, note) = match found {
        Found::Way(way) => (Some(way), None),
        Found::Within(name, way) => {
            (Some(way), Some(format!("within {name} pictures are made of half blocks")))
        }
        Found::Nothing => {
            let advice = "--show blocks does not ask";
            (None, Some(format!("standard error is no terminal that shows pictures; {advice}")))
        }
    };
    if let Some(note) = note.filter(|_| !args.quiet) {
        say(&format!("note: --show: {note}"));
    }
    Some(Screen::new(way?, args.tonemap, args.exposure))
}

/// Says why a file could not be written: the first time, and again after it could.
fn warn_once(failed: &mut bool, written: Result<(), CliError>) {
    let before = std::mem::replace(failed, written.is_err());
    if let Err(error) = written
        && !before
    {
        say(&format!("warning: {}", format_chain(&error)));
    }
}

/// What a log begins with.
fn describe_run(args: &RenderArgs) -> String {
    let threads = match args.threads {
        0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        threads => threads,
    };
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let host = host.or_else(|| std::env::var("HOSTNAME").ok());
    let host = host.or_else(|| std::env::var("COMPUTERNAME").ok());
    let host = host.map_or(String::new(), |host| format!(" on {}", host.trim()));
    let (version, words) = (env!("CARGO_PKG_VERSION"), shell::join(shell::own_words()));
    format!("dapple {version} begins, {threads} threads{host}: dapple {words}")
}

/// A picture's colours alone.
fn colours_of(picture: &Picture) -> Picture {
    let mut colours = Picture::new(picture.frame, picture.crop);
    for name in ["R", "G", "B", "A"] {
        if let Some(values) = picture.channel(name) {
            colours.set_channel(name, values.to_vec());
        }
    }
    colours
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
