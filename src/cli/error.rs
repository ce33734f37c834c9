//! What a command may fail with, and the exit code that says so.

use std::process::ExitCode;

use crate::accel::BuildError;
use crate::film::FilmError;
use crate::scene::LoadError;
use crate::scene::npy::NpyError;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// The words make no sense together.
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
    /// The input is not what it should be.
    #[error("{0}")]
    Input(String),
    /// An output could not be written.
    #[error("{0}")]
    Output(String),
}

impl CliError {
    /// 2 usage, 3 input, 4 output, 5 a limit.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Self::Usage(_) | Self::Build(BuildError::NoSuchIsa { .. }) => 2,
            Self::Load(_) | Self::Npy(_) | Self::Input(_) => 3,
            Self::Film(error) => error.exit_code(),
            Self::Output(_) => 4,
            Self::Build(_) => 5,
        })
    }
}
