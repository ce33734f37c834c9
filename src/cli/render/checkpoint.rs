//! Parts and checkpoints: what a render has summed up, to files and back.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::progress::say;
use crate::cli::settings::parse_long::{Every, Resume};
use crate::cli::settings::{RenderArgs, Table};
use crate::files::{self, Flush};
use crate::part::{
    Difference, EncodedTile, Head, Part, PartError, PartWriter, is_part, list_differences,
};
use crate::render::{Film, Tile};

/// Between checkpoints, if no one says.
const EVERY: Every = Every::Time(Duration::from_secs(300));

/// Where the checkpoint of a render is, if it has one: beside its output if no one says.
///
/// # Errors
/// [`CliError::Usage`] if there is no output to put it beside.
pub fn path(args: &RenderArgs) -> Result<Option<PathBuf>, CliError> {
    let named = match (&args.checkpoint, args.resume) {
        (None, None) => return Ok(None),
        (named, _) => named.as_ref().filter(|path| !path.as_os_str().is_empty()),
    };
    let beside = || {
        let output = [&args.output, &args.partial, &args.png].into_iter().find_map(Option::as_ref);
        output.map(|path| path.with_extension("checkpoint"))
    };
    named.cloned().or_else(beside).map(Some).ok_or_else(|| {
        CliError::Usage("nowhere to put the checkpoint: give --checkpoint FILE".to_owned())
    })
}

/// The samples of each pixel that a render is to take.
pub fn range(args: &RenderArgs) -> Range<u64> {
    match (&args.samples, args.part) {
        (Some(samples), _) => samples.clone(),
        (None, Some(share)) => share.range(args.spp),
        (None, None) => 0..args.spp,
    }
}

/// What the samples of a job belong to.
pub fn head(job: &Job) -> Head {
    let (settings, table) = (&job.settings, Table::default());
    let mut head = Head::new(settings.resolution, settings.crop, &range(&job.args), settings.spp);
    head.scene_digest = job.staged.world.scene.digest_text();
    head.identity = table.identity(&job.args);
    head.settings = table.to_toml(&job.args);
    head.scene = job.args.scene_file.display().to_string();
    head
}

/// Writes what a film has summed up.
///
/// # Errors
/// The system's reason.
pub fn write(path: &Path, head: &Head, film: &Film) -> io::Result<()> {
    let mut head = head.clone();
    head.render_s = film.elapsed().as_secs_f64();
    files::write(path, Flush::ToDisk, |file| {
        let mut part = PartWriter::new(file, &head)?;
        film.try_for_each_tile(EncodedTile::new, |tile| part.add(&tile))?;
        part.finish()
    })
}

/// The checkpoint of a render.
pub struct Checkpoint {
    path: PathBuf,
    head: Head,
    every: Every,
    last: Mutex<Last>,
}

/// When it was last saved.
struct Last {
    time: Instant,
    /// The sample that came next then.
    sample: u64,
    /// What went wrong, if it could not be.
    error: Option<String>,
}

impl Checkpoint {
    /// The checkpoint that is asked for, if one is, and the tiles in it to go on from.
    ///
    /// # Errors
    /// If there is one and no word about going on, or none though it is to go on; if it is damaged;
    /// if it is of another render.
    pub fn open(job: &Job) -> Result<Option<(Self, Option<Restored>)>, CliError> {
        let Some(path) = path(&job.args)? else { return Ok(None) };
        let head = head(job);
        let restored = match (path.exists(), job.args.resume) {
            (true, Some(_)) => Some(Restored::read(&path, &head)?),
            (true, None) if !is_part(&path) => return Err(no_checkpoint(&path)),
            (true, None) => {
                let shown = path.display();
                return Err(CliError::Usage(format!(
                    "{shown}: is there: --resume goes on from it; remove it to start anew"
                )));
            }
            (false, Some(Resume::Must)) => {
                let shown = path.display();
                return Err(CliError::Input(format!(
                    "{shown}: there is no such checkpoint; --resume auto starts anew then"
                )));
            }
            (false, _) => None,
        };
        let every = job.args.every.unwrap_or(EVERY);
        let (time, sample) = (Instant::now(), head.samples().start);
        let last = Mutex::new(Last { time, sample, error: None });
        Ok(Some((Self { path, head, every, last }, restored)))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Saves if it is time to, or if it is `told` to, and says whether it did. That it cannot is a
    /// warning: the render goes on.
    pub fn look_after(&self, film: &Film, told: bool) -> bool {
        let Ok(mut last) = self.last.lock() else { return false };
        let is_due = match self.every {
            Every::Time(every) => last.time.elapsed() >= every,
            Every::Samples(every) => film.next_sample() >= last.sample.saturating_add(every),
        };
        if !is_due && !told {
            return false;
        }
        let sample = film.next_sample();
        let error = self.save(film).err().map(|error| error.to_string());
        // The same is not said again and again.
        if let Some(error) = error.as_ref().filter(|_| error != last.error) {
            say(&format!("warning: {error}; the render goes on"));
        }
        let is_saved = error.is_none();
        *last = Last { time: Instant::now(), sample, error };
        is_saved
    }

    /// Saves.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, film: &Film) -> Result<(), CliError> {
        write(&self.path, &self.head, film)
            .map_err(|source| CliError::not_written(&self.path, &source))
    }

    /// Removes the file: the picture is there.
    pub fn remove(&self) {
        if let Err(error) = std::fs::remove_file(&self.path)
            && error.kind() != io::ErrorKind::NotFound
        {
            say(&format!("warning: {}: cannot be removed: {error}", self.path.display()));
        }
    }
}

/// The error about a file that is something else, which may be dear to someone.
fn no_checkpoint(path: &Path) -> CliError {
    let message = "is no checkpoint; name another file by --checkpoint";
    CliError::Input(format!("{}: {message}", path.display()))
}

/// What is in a checkpoint.
pub struct Restored {
    /// The tiles, in their order.
    pub tiles: Vec<Tile>,
    /// The time that they took.
    pub elapsed: Duration,
}

impl Restored {
    /// Reads a checkpoint of the render that `head` is about.
    fn read(path: &Path, head: &Head) -> Result<Self, CliError> {
        let part = Part::open(path).map_err(|error| match error {
            PartError::NotAPart(path) => no_checkpoint(&path),
            error => error.into(),
        })?;
        let differences = differences(&part.head, head);
        if !differences.is_empty() {
            let lines = list_differences(&differences);
            let shown = path.display();
            return Err(CliError::Input(format!(
                "{shown}: is the checkpoint of another render (it first, this second):{lines}"
            )));
        }
        let tiles: Result<Vec<Tile>, PartError> =
            (0..part.windows().len()).map(|tile| part.read(tile)).collect();
        let elapsed = Duration::try_from_secs_f64(part.head.render_s).unwrap_or_default();
        Ok(Self { tiles: tiles?, elapsed })
    }
}

/// What makes it impossible to go on from the samples of `then` to those of `now`.
pub fn differences(then: &Head, now: &Head) -> Vec<Difference> {
    let mut found = then.differences(now);
    let mut compare = |key: &str, values: [String; 2]| {
        if values[0] != values[1] {
            found.push(Difference { key: key.to_owned(), values: values.map(Some) });
        }
    };
    compare("--crop", [then.crop(), now.crop()].map(|crop| crop.to_string()));
    compare("the first sample", [then, now].map(|head| head.samples().start.to_string()));
    let (had, wanted) = (then.samples().end, now.samples().end);
    if had > wanted {
        compare("the last sample", [had, wanted].map(|end| end.to_string()));
    }
    found
}
