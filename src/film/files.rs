//! Pictures to files and back, and against each other.

use std::path::Path;

use super::compare::{self, Comparison, FlipKind, Named};
use super::{FilmError, Picture, Tonemap, exr, png};

impl Picture {
    /// Reads a picture: PNG by its extension, EXR else.
    ///
    /// # Errors
    /// [`FilmError`], which names the file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, FilmError> {
        compare::read(path.as_ref())
    }

    /// Writes all channels as an EXR: one part, scanlines, ZIP, float32. The file is whole or not
    /// there.
    ///
    /// # Errors
    /// [`FilmError`], which names the file.
    pub fn write_exr(&self, path: impl AsRef<Path>) -> Result<(), FilmError> {
        exr::write(path.as_ref(), self)
    }

    /// The bytes of the file that [`Picture::write_exr`] writes.
    ///
    /// # Errors
    /// [`FilmError::Invalid`] for what the format cannot hold.
    pub fn encode_exr(&self) -> Result<Vec<u8>, FilmError> {
        exr::encode(self).map_err(|message| FilmError::invalid(Path::new("the picture"), message))
    }

    /// Writes the colours as a PNG of 8 bits a channel, brightened by `exposure` stops.
    ///
    /// # Errors
    /// [`FilmError`], which names the file.
    pub fn write_png(
        &self,
        path: impl AsRef<Path>,
        tonemap: Tonemap,
        exposure: f32,
    ) -> Result<(), FilmError> {
        png::write(path.as_ref(), self, tonemap, exposure, None)
    }
}

/// Compares the colours of a picture with those of a reference of the same size: errors, FLIP over
/// a range of exposures, and a z-test where the pictures tell the variance of their pixels.
///
/// # Examples
/// ```
/// use dapple::{Picture, Window, diff};
///
/// let frame = Window::of_size(2, 1);
/// let mut picture = Picture::new(frame, frame);
/// picture.set_aov("", "RGB", &[[0.5; 3], [1.0; 3]]);
/// assert_eq!(diff(&picture, &picture)?.flip, 0.0);
/// # Ok::<(), dapple::FilmError>(())
/// ```
///
/// # Errors
/// [`FilmError::Sizes`]; [`FilmError::Invalid`] if one has no colours.
pub fn diff(picture: &Picture, reference: &Picture) -> Result<Comparison, FilmError> {
    let image = Named { path: Path::new("the picture"), picture };
    let reference = Named { path: Path::new("the reference"), picture: reference };
    compare::compare(image, reference, FlipKind::Hdr)
}
