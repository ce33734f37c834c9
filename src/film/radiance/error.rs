//! Errors of Radiance pictures.

use std::io;

/// Why a Radiance picture cannot be read; says what, not in which file.
#[derive(Debug, thiserror::Error)]
pub enum RadianceError {
    /// The system's words.
    #[error("cannot be read")]
    Read(#[from] io::Error),
    /// The header is malformed, or asks for what is not supported.
    #[error("{0}")]
    Header(String),
    /// The pixels end before they should, or are damaged.
    #[error("{problem} in {name} {number} of {count}")]
    Scanline {
        /// What is wrong.
        problem: &'static str,
        /// `row` or `column`.
        name: &'static str,
        /// Which one, in the file's order, from 1.
        number: usize,
        /// How many there are.
        count: usize,
    },
}
