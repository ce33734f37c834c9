//! The files of a folder of results.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::bench::results::files::{About, Bench, read_about};
use crate::bench::results::member::{Malformed, Member};
use crate::cli::error::CliError;
use crate::files;

/// A file that a bench wrote.
pub struct Kept {
    /// Which bench.
    pub bench: Bench,
    /// Where it lies.
    pub path: PathBuf,
    /// What it says of itself.
    pub about: About,
    /// All of it.
    pub json: Value,
}

impl Kept {
    /// An error about a member of it.
    pub fn wrong(&self, error: &Malformed) -> CliError {
        wrong(&self.path, error)
    }
}

/// Larger ones were not written by a bench.
const MAX_BYTES: u64 = 64 << 20;

/// Reads those files that are there.
///
/// # Errors
/// If there are none, or one is not what it should be.
pub fn read(folder: &Path) -> Result<Vec<Kept>, CliError> {
    let there = Bench::ALL.into_iter().map(|bench| (bench, folder.join(bench.file())));
    let there: Vec<_> = there.filter(|(_, path)| path.exists()).collect();
    if there.is_empty() {
        let names = Bench::ALL.map(Bench::file).join(", ");
        let message = format!("{}: there is none of {names}", folder.display());
        return Err(CliError::Input(message));
    }
    there.into_iter().map(|(bench, path)| read_file(bench, path)).collect()
}

fn read_file(bench: Bench, path: PathBuf) -> Result<Kept, CliError> {
    let shown = path.display();
    let bytes = files::read(&path, MAX_BYTES)
        .map_err(|error| CliError::Input(format!("{shown}: {}", files::why_unread(&error))))?;
    let json: Value = serde_json::from_slice(&bytes)
        .map_err(|error| CliError::Input(format!("{shown}: is not JSON: {error}")))?;
    let about = read_about(bench, &Member::root(&json)).map_err(|error| wrong(&path, &error))?;
    Ok(Kept { bench, path, about, json })
}

fn wrong(path: &Path, error: &Malformed) -> CliError {
    CliError::Input(format!("{}: {error}", path.display()))
}
