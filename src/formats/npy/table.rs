//! Arrays of rows that stay as the file has them.

use super::header::{Header, HeaderError, MAGIC};

/// An array of `float32` or `float64`, whose numbers are read when they are asked for.
#[derive(Debug)]
pub struct Table {
    bytes: Vec<u8>,
    /// Where the numbers begin.
    start: usize,
    shape: Vec<u64>,
    /// Numbers of a row.
    columns: usize,
    /// Bytes of a number.
    size: usize,
}

impl Table {
    /// Whether a file's first bytes are those of such a file.
    pub fn is_table(bytes: &[u8]) -> bool {
        bytes.starts_with(MAGIC)
    }

    /// Reads a file's contents.
    ///
    /// # Errors
    /// What is wrong: the header, another type or order of numbers, fewer or more bytes than its
    /// shape takes.
    pub fn read(bytes: Vec<u8>) -> Result<Self, String> {
        let header = Header::read(&mut &bytes[..]).map_err(|error| match error {
            HeaderError::Io(_) => "it ends inside its header".to_owned(),
            HeaderError::Problem(problem) => problem,
        })?;
        let (array, start) = (header.array, header.bytes as usize);
        let size: usize = match array.descr.as_str() {
            "<f4" => 4,
            "<f8" => 8,
            _ => return Err(format!("is {array}, not of little-endian float32 or float64")),
        };
        if array.fortran_order || array.shape.len() < 2 {
            return Err(format!("is {array}, not an array of rows in C order"));
        }
        let product = |sizes: &[u64]| sizes.iter().try_fold(1_u64, |all, &it| all.checked_mul(it));
        let present = (bytes.len() - start) as u64;
        let promised = product(&array.shape).and_then(|all| all.checked_mul(size as u64));
        if promised != Some(present) {
            return Err(format!("its header promises {array}, but {present} bytes follow"));
        }
        let columns = product(&array.shape[1..]).unwrap_or(0) as usize;
        Ok(Self { bytes, start, shape: array.shape, columns, size })
    }

    /// The array's sizes, rows first; there are two or more.
    pub fn shape(&self) -> &[u64] {
        &self.shape
    }

    /// How many rows there are.
    pub fn rows(&self) -> u64 {
        self.shape[0]
    }

    /// Numbers of a row, those of further dimensions in a line.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Reads a row into as many numbers as it has.
    pub fn row(&self, row: u64, numbers: &mut [f64]) {
        let first = self.start + row as usize * self.columns * self.size;
        let bytes = &self.bytes[first..first + self.columns * self.size];
        for (number, bytes) in numbers.iter_mut().zip(bytes.chunks_exact(self.size)) {
            *number = match *bytes {
                [a, b, c, d] => f64::from(f32::from_le_bytes([a, b, c, d])),
                [a, b, c, d, e, f, g, h] => f64::from_le_bytes([a, b, c, d, e, f, g, h]),
                _ => unreachable!("numbers have 4 or 8 bytes"),
            };
        }
    }
}
