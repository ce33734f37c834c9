//! Why a picture is not denoised.

use std::path::PathBuf;

/// Why a picture is not denoised.
#[derive(Debug, thiserror::Error)]
pub enum DenoiseError {
    /// The library is nowhere.
    #[error(
        "Open Image Denoise is not installed: `pip install pyoidn`, or let DAPPLE_OIDN name its \
         library, or the folder that holds it"
    )]
    Absent,
    /// `DAPPLE_OIDN` names nothing that could be the library.
    #[error("DAPPLE_OIDN={}: {}", path.display(), message)]
    Misnamed {
        /// What it names.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// A library is there and cannot be used.
    #[error("{}: {message}", path.display())]
    Unusable {
        /// The library's file, or its name for the loader.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// The library could not do its work.
    #[error("Open Image Denoise failed: {0}")]
    Failed(String),
    /// The picture has no colours.
    #[error(transparent)]
    Picture(#[from] crate::film::FilmError),
}

impl DenoiseError {
    /// The exit status of a command that ends with this error: 3 an input that is missing or
    /// invalid, as the library is one; 5 a limit, such as memory.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Absent | Self::Misnamed { .. } | Self::Unusable { .. } => 3,
            Self::Failed(_) => 5,
            Self::Picture(error) => error.exit_code(),
        }
    }
}
