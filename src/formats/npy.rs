//! NumPy's `.npy` files: tables of rays, hits and triangles.
//!
//! Read and written are two-dimensional little-endian `float32` arrays in C order; one-dimensional
//! `uint8` arrays are written. The header is a Python dictionary after the magic bytes and a
//! version; versions 1 to 3 differ in the width of its length and its encoding
//! (<https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html>).

mod header;
mod table;

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use header::{Header, HeaderError, header_bytes};
pub use table::Table;

use crate::files::{self, Flush};

/// What can be wrong with a file of numbers.
#[derive(Debug, thiserror::Error)]
pub enum NpyError {
    /// The file cannot be opened or read.
    #[error("{path}: {}", files::why_unread(source))]
    Read {
        /// As the caller names it.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("{path}: cannot be written")]
    Write {
        /// As the caller names it.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// It is no `.npy` file, or a broken one.
    #[error("{path}: not a valid .npy file: {problem}")]
    Format {
        /// As the caller names it.
        path: PathBuf,
        /// What is the matter.
        problem: String,
    },
    /// It holds an array of another shape or type.
    #[error("{path}: expected shape (N, {columns}) of float32, found {found}")]
    Shape {
        /// As the caller names it.
        path: PathBuf,
        /// The number of columns asked for.
        columns: usize,
        /// Shape and type of what is there.
        found: String,
    },
}

/// Reads an array of shape (N, `columns`), row by row.
///
/// # Errors
/// [`NpyError`], if the file cannot be read, is broken, or holds something else. The header is held
/// against the file's length before anything of its size is allocated.
pub fn read_f32(path: &Path, columns: usize) -> Result<Vec<f32>, NpyError> {
    let read_error = |source| NpyError::Read { path: path.into(), source };
    let (file, length) = files::open(path).map_err(read_error)?;
    read_f32_from(file, length, path, columns)
}

/// The same of `length` bytes from anywhere; `path` is for messages.
///
/// # Errors
/// As [`read_f32`].
pub fn read_f32_from(
    mut input: impl Read,
    length: u64,
    path: &Path,
    columns: usize,
) -> Result<Vec<f32>, NpyError> {
    let read_error = |source| NpyError::Read { path: path.into(), source };
    let format_error = |problem| NpyError::Format { path: path.into(), problem };
    let Header { array, bytes: before } =
        Header::read(&mut input).map_err(|error| match error {
            HeaderError::Io(source) if source.kind() == io::ErrorKind::UnexpectedEof => {
                format_error("it ends inside its header".into())
            }
            HeaderError::Io(source) => read_error(source),
            HeaderError::Problem(problem) => format_error(problem),
        })?;

    let rows = match &*array.shape {
        &[rows, found] if found == columns as u64 && array.descr == "<f4" => Some(rows),
        _ => None,
    };
    let Some(rows) = rows.filter(|_| !array.fortran_order) else {
        return Err(NpyError::Shape { path: path.into(), columns, found: array.to_string() });
    };
    let present = length.saturating_sub(before);
    if rows.checked_mul(columns as u64 * 4) != Some(present) {
        let problem = format!("its header promises {rows} rows, but {present} bytes follow");
        return Err(format_error(problem));
    }
    let mut values = vec![0.0_f32; rows as usize * columns];
    input.read_exact(bytemuck::cast_slice_mut(&mut values)).map_err(read_error)?;
    for value in &mut values {
        *value = f32::from_bits(u32::from_le(value.to_bits()));
    }
    Ok(values)
}

/// Writes `values`, row by row, as an array of shape (N, `columns`).
///
/// The file appears whole or not at all: it is written beside its place and renamed.
///
/// # Errors
/// [`NpyError::Write`].
///
/// # Panics
/// If `values` does not consist of whole rows.
pub fn write_f32(path: &Path, columns: usize, values: &[f32]) -> Result<(), NpyError> {
    assert!(columns > 0 && values.len().is_multiple_of(columns), "values are whole rows");
    let header = header_bytes("<f4", &format!("({}, {columns})", values.len() / columns));
    write_whole(path, |out| {
        out.write_all(&header)?;
        if cfg!(target_endian = "little") {
            return out.write_all(bytemuck::cast_slice(values));
        }
        values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
    })
}

/// Writes `values` as an array of shape (N,); otherwise like [`write_f32`].
///
/// # Errors
/// [`NpyError::Write`].
pub fn write_u8(path: &Path, values: &[u8]) -> Result<(), NpyError> {
    let header = header_bytes("|u1", &format!("({},)", values.len()));
    write_whole(path, |out| {
        out.write_all(&header)?;
        out.write_all(values)
    })
}

/// Unlike pictures, hits are not flushed to the disk: they are quick to make again, and whoever
/// times a run would time the disk.
fn write_whole(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), NpyError> {
    files::write(path, Flush::WhenIdle, |file| content(file))
        .map_err(|source| NpyError::Write { path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use proptest::prelude::*;

    use super::super::npy::header::MAGIC;
    use super::*;

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("the system's folder for temporary files is writable")
    }

    fn message_for(bytes: &[u8]) -> String {
        let folder = folder();
        let path = folder.path().join("rays.npy");
        fs::write(&path, bytes).unwrap();
        let error = read_f32(&path, 8).expect_err("the file is broken").to_string();
        error.replace(path.to_str().unwrap(), "rays.npy")
    }

    fn with_header(dictionary: &str, content: &[u8]) -> Vec<u8> {
        let length = (dictionary.len() as u16).to_le_bytes();
        [&MAGIC[..], &[1, 0], &length, dictionary.as_bytes(), content].concat()
    }

    #[test]
    fn what_numpy_writes_is_read() {
        // numpy.save of numpy.arange(4, dtype='f4').reshape(2, 2), version 1 and 2.
        let dictionary = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }  \n";
        let floats: Vec<u8> =
            [0.0_f32, 1.0, 2.0, 3.0].iter().flat_map(|f| f.to_le_bytes()).collect();
        let one = with_header(dictionary, &floats);
        let mut two = [&MAGIC[..], &[2, 0]].concat();
        two.extend((dictionary.len() as u32).to_le_bytes());
        two.extend(dictionary.as_bytes());
        two.extend(&floats);
        let folder = folder();
        let path = folder.path().join("a.npy");
        for bytes in [one, two] {
            fs::write(&path, bytes).unwrap();
            assert_eq!(read_f32(&path, 2).unwrap(), [0.0, 1.0, 2.0, 3.0]);
        }
    }

    #[test]
    fn another_shape_or_type_is_named() {
        let doubles = "{'descr': '<f8', 'fortran_order': False, 'shape': (10, 9), }";
        assert_eq!(
            message_for(&with_header(doubles, &[0; 720])),
            "rays.npy: expected shape (N, 8) of float32, found (10, 9) of float64"
        );
        let columns = "{'descr': '<f4', 'fortran_order': True, 'shape': (10, 8), }";
        assert_eq!(
            message_for(&with_header(columns, &[0; 320])),
            "rays.npy: expected shape (N, 8) of float32, found (10, 8) of float32, in Fortran order"
        );
        let flat = "{'descr': '>f4', 'fortran_order': False, 'shape': (8,), }";
        assert_eq!(
            message_for(&with_header(flat, &[0; 32])),
            "rays.npy: expected shape (N, 8) of float32, found (8,) of float32, big-endian"
        );
    }

    #[test]
    fn sizes_that_the_file_does_not_have_are_refused() {
        let huge = "{'descr': '<f4', 'fortran_order': False, 'shape': (2305843009213693952, 8), }";
        assert_eq!(
            message_for(&with_header(huge, &[0; 32])),
            "rays.npy: not a valid .npy file: its header promises 2305843009213693952 rows, \
             but 32 bytes follow"
        );
        let longer = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 8), }";
        assert!(message_for(&with_header(longer, &[0; 33])).contains("33 bytes follow"));
        assert!(message_for(b"not numpy").contains("magic"));
        assert!(message_for(b"\x93NUMPY\x02\x00\xff\xff\xff\xff").contains("too long"));
    }

    #[test]
    fn every_truncation_is_an_error() {
        let folder = folder();
        let (path, cut) = (folder.path().join("a.npy"), folder.path().join("cut.npy"));
        write_f32(&path, 4, &[1.5; 12]).unwrap();
        let whole = fs::read(&path).unwrap();
        assert_eq!(whole.len() % 64, 48);
        for length in 0..whole.len() {
            fs::write(&cut, &whole[..length]).unwrap();
            assert!(read_f32(&cut, 4).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn writing_replaces_the_file_and_leaves_nothing_else() {
        let folder = folder();
        let path = folder.path().join("hits.npy");
        write_f32(&path, 4, &[0.0; 4]).unwrap();
        write_u8(&path, &[1, 0, 1]).unwrap();
        let bytes = fs::read(&path).unwrap();
        assert_eq!(&bytes[bytes.len() - 3..], [1, 0, 1]);
        assert_eq!((bytes.len() - 3) % 64, 0);
        assert!(String::from_utf8_lossy(&bytes).contains("'|u1', 'fortran_order': False"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);

        let nowhere = folder.path().join("missing/hits.npy");
        assert!(matches!(write_u8(&nowhere, &[]), Err(NpyError::Write { .. })));
    }

    proptest! {
        #[test]
        fn numbers_come_back_bit_for_bit(
            bits in proptest::collection::vec(any::<u32>(), 0..300),
            columns in 1_usize..10,
        ) {
            let rows = bits.len() / columns;
            let values: Vec<f32> =
                bits[..rows * columns].iter().map(|&bits| f32::from_bits(bits)).collect();
            let folder = folder();
            let path = folder.path().join("a.npy");
            write_f32(&path, columns, &values).unwrap();
            let back = read_f32(&path, columns).unwrap();
            prop_assert_eq!(
                back.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), &bits[..rows * columns]
            );
        }
    }
}
