//! The bytes of files.

use std::io;
use std::path::Path;

use super::LoadError;
use crate::files;

/// The largest file that is read: a limit against special and sparse files, not against scenes.
const MAX_FILE_BYTES: u64 = 8 << 30;

/// The contents of a regular file.
///
/// # Errors
/// [`LoadError::Read`] with what the system says, or if it is no regular file (a pipe would never
/// end) or beyond 8 GiB.
pub fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    read_regular(path).map_err(|source| LoadError::read(path, source))
}

/// [`read_file`] with the bare reason.
pub(super) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    files::read(path, MAX_FILE_BYTES)
}
