//! The log of a run: a file to which lines with the time are appended.

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use crate::cli::clock;

/// The log of this process, if it has one: what is said goes there, from wherever it is said.
static LOG: Mutex<Option<Log>> = Mutex::new(None);

/// Begins the log of this process at the end of a file.
///
/// # Errors
/// The system's reason why the file cannot be opened.
pub fn open(path: &Path) -> io::Result<()> {
    *log() = Some(Log::open(path)?);
    Ok(())
}

/// Adds a text to the log, if there is one. A full disk is no reason to stop.
pub fn write(text: &str) {
    if let Some(log) = &mut *log() {
        let _ = log.write(text, SystemTime::now());
    }
}

fn log() -> MutexGuard<'static, Option<Log>> {
    LOG.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Log {
    file: File,
}

impl Log {
    fn open(path: &Path) -> io::Result<Self> {
        Ok(Self { file: OpenOptions::new().append(true).create(true).open(path)? })
    }

    /// Each line of the text with the time before it, all in one write: lines of several processes
    /// do not mix.
    fn write(&mut self, text: &str, time: SystemTime) -> io::Result<()> {
        let time = clock::format_utc(time);
        let mut lines = Vec::new();
        for line in text.lines() {
            writeln!(lines, "{time} {line}")?;
        }
        self.file.write_all(&lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_appended_each_with_its_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.log");
        for text in ["first", "error: this\nand that"] {
            let mut log = Log::open(&path).expect("opened");
            log.write(text, SystemTime::UNIX_EPOCH).expect("written");
        }
        let text = std::fs::read_to_string(&path).expect("there");
        let time = "1970-01-01T00:00:00.000Z";
        assert_eq!(text, format!("{time} first\n{time} error: this\n{time} and that\n"));
        assert!(Log::open(folder.path()).is_err());
    }
}
