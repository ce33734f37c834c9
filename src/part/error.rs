//! What can be wrong with parts.

use std::fmt::{self, Write as _};
use std::io;
use std::path::{Path, PathBuf};

use crate::files::why_unread;
use crate::film::Window;

/// Why a part cannot be read, or parts cannot be added up.
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The system's reason.
    #[error("{}: {}", path.display(), why_unread(source))]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Another kind of file.
    #[error("{}: is neither a part of a picture nor a checkpoint; name a file that \
             `dapple render` wrote by --partial or --checkpoint", .0.display())]
    NotAPart(PathBuf),
    /// A kind of part that this version does not know.
    #[error("{}: is a part of format {found}; this version of dapple reads format {known}",
            path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The number that it tells.
        found: String,
        /// The number that is known.
        known: String,
    },
    /// Its bytes are not those that were written.
    #[error("{}: is damaged: {chunk}: {reason}; remove it and run the command that made it again",
            path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What cannot be read: the head, the index, a tile.
        chunk: String,
        /// Why.
        reason: String,
    },
    /// Two parts are not of the same picture.
    #[error("{} and {} are not parts of one picture:{}",
            a.display(), b.display(), list(differences))]
    OtherPicture {
        /// One.
        a: PathBuf,
        /// The other.
        b: PathBuf,
        /// What differs, and both values.
        differences: Vec<Difference>,
    },
    /// Two parts have the same samples with other values.
    #[error("{} and {} differ in the same samples, at pixel {x},{y}; render both again",
            a.display(), b.display())]
    Differ {
        /// One.
        a: PathBuf,
        /// The other.
        b: PathBuf,
        /// Column of the first pixel that differs.
        x: u32,
        /// Its row.
        y: u32,
    },
    /// Two parts have some samples in common, and others not.
    #[error("{} and {} overlap: both have samples {samples} of the pixels {window}; \
             leave one of them out, and the merge tells what is missing then",
            a.display(), b.display())]
    Overlap {
        /// One.
        a: PathBuf,
        /// The other.
        b: PathBuf,
        /// As `--samples` takes them.
        samples: String,
        /// As `--crop` takes them.
        window: Window,
    },
    /// Samples are missing.
    #[error("{0}")]
    Gap(String),
}

/// What differs between the pictures of two parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// A setting, or `version`, or `scene`.
    pub key: String,
    /// The two values; none: it is not set.
    pub values: [Option<String>; 2],
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.values;
        let show = |value: &Option<String>| value.clone().unwrap_or_else(|| "not set".to_owned());
        write!(f, "{}: {} and {}", self.key, show(a), show(b))
    }
}

/// A line for each difference.
pub fn list(differences: &[Difference]) -> String {
    let mut lines = String::new();
    for difference in differences {
        let _ = write!(lines, "\n  {difference}");
    }
    lines
}

impl PartError {
    /// 1 a difference, 2 an overlap, 3 all else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Differ { .. } => 1,
            Self::Overlap { .. } => 2,
            _ => 3,
        }
    }

    pub(super) fn damaged(path: &Path, chunk: &str, reason: impl Into<String>) -> Self {
        let (chunk, reason) = (chunk.to_owned(), reason.into());
        Self::Damaged { path: path.to_owned(), chunk, reason }
    }
}
