//! What a command may fail with, and the exit code that says so.

use std::error::Error;
use std::io;
use std::path::Path;

use crate::accel::BuildError;
use crate::bench::measure::BenchError;
use crate::denoise::DenoiseError;
use crate::film::FilmError;
use crate::formats::LoadError;
use crate::formats::npy::NpyError;
use crate::part::PartError;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The command line makes no sense.
    #[error("{0}")]
    Usage(String),
    /// A scene could not be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A table of numbers could not be read or written.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// A structure could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A picture could not be read, compared or written.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// A part of a picture could not be read, or parts do not add up.
    #[error(transparent)]
    Part(#[from] PartError),
    /// A picture could not be denoised.
    #[error(transparent)]
    Denoise(#[from] DenoiseError),
    /// The input is not what it should be.
    #[error("{0}")]
    Input(String),
    /// An output could not be written.
    #[error("{0}")]
    Output(String),
    /// A limit, such as memory, forbids it.
    #[error("{0}")]
    Limit(String),
    /// What was compared differs.
    #[error("{0}")]
    Differs(String),
    /// Several things went wrong, each a line.
    #[error("{}", join_lines(.0))]
    Several(Vec<CliError>),
}

impl CliError {
    /// 1 a difference, 2 usage, 3 input, 4 output, 5 a limit.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Differs(_) => 1,
            Self::Usage(_) | Self::Build(BuildError::NoSuchIsa { .. }) => 2,
            Self::Npy(NpyError::Write { .. }) | Self::Output(_) => 4,
            Self::Load(_) | Self::Npy(_) | Self::Input(_) => 3,
            Self::Film(error) => error.exit_code(),
            Self::Part(error) => error.exit_code(),
            Self::Denoise(error) => error.exit_code(),
            Self::Build(_) | Self::Limit(_) => 5,
            Self::Several(all) => all.iter().map(Self::exit_code).max().unwrap_or(0),
        }
    }

    /// An output that could not be written.
    pub fn not_written(path: &Path, source: &io::Error) -> Self {
        Self::Output(format!("{}: cannot be written: {source}", path.display()))
    }
}

impl From<BenchError> for CliError {
    fn from(error: BenchError) -> Self {
        match error {
            BenchError::Build(error) => Self::Build(error),
            wrong => Self::Differs(wrong.to_string()),
        }
    }
}

/// An error and its causes in a line, those left out that it has named itself.
pub fn format_chain(error: &dyn Error) -> String {
    let mut message = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let text = inner.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = inner.source();
    }
    message
}

fn join_lines(errors: &[CliError]) -> String {
    errors.iter().map(|error| format_chain(error)).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disagreement_is_a_difference() {
        let wrong = BenchError::Disagrees {
            spec: "kd-ropes".to_owned(),
            first: "kd-stack-direction".to_owned(),
            rays: 1,
            count: 10,
            set: "random",
        };
        assert_eq!(CliError::from(wrong).exit_code(), 1);
    }
}
