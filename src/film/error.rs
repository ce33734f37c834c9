//! Errors of pictures and their files.

use std::io;
use std::path::{Path, PathBuf};

use crate::files::why_unread;

/// An error of this module. The message names the file; an operating system's reason is the source.
#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    /// The file is not there or cannot be read.
    #[error("{}: {}", path.display(), why_unread(source))]
    Read {
        /// As the caller names it.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The file cannot be written; what stood at its place is untouched.
    #[error("{}: cannot be written", path.display())]
    Write {
        /// The file that was to be written.
        /// As the caller names it.
        path: PathBuf,
        /// The operating system's reason.
        source: io::Error,
    },
    /// The file's contents are damaged, not supported or not what is needed.
    #[error("{}: {message}", path.display())]
    Invalid {
        /// As the caller names it.
        path: PathBuf,
        /// What is wrong with it, and what would do.
        message: String,
    },
    /// Two pictures that were to be compared differ in size.
    #[error(
        "sizes differ: {} is {}x{}, {} is {}x{}; render both with the same --resolution and --crop",
        .0.0, .0.1, .0.2, .1.0, .1.1, .1.2
    )]
    Sizes((String, usize, usize), (String, usize, usize)),
    /// A word on the command line that names no metric, or a bad number after it.
    #[error("{0}")]
    Usage(String),
    /// Standard output cannot be written.
    #[error("standard output cannot be written")]
    Stdout(#[source] io::Error),
}

impl FilmError {
    /// A file that could not be read.
    pub fn read(path: &Path, source: io::Error) -> Self {
        Self::Read { path: path.to_owned(), source }
    }

    /// A file that could not be written.
    pub fn write(path: &Path, source: io::Error) -> Self {
        Self::Write { path: path.to_owned(), source }
    }

    /// A file with contents that cannot be used.
    pub fn invalid(path: &Path, message: impl Into<String>) -> Self {
        Self::Invalid { path: path.to_owned(), message: message.into() }
    }

    /// The exit status of a command that ends with this error: 2 usage, 3 input, 4 output.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Read { .. } | Self::Invalid { .. } | Self::Sizes(..) => 3,
            Self::Write { .. } | Self::Stdout(_) => 4,
        }
    }
}
