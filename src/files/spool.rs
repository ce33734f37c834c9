//! A temporary file for what memory has no room for.

use std::fs::File;
use std::io;
#[cfg(not(unix))]
use std::io::{Read, Seek, SeekFrom, Write};
use std::sync::Mutex;

/// A file in the system's folder for such (`TMPDIR`) that no one else sees and that is gone with
/// the process, however that ends. Threads may write and read at once.
#[derive(Debug)]
pub struct Spool {
    file: File,
    /// Where the next bytes go; held while they are written where a file has but one position.
    end: Mutex<u64>,
}

impl Spool {
    /// An empty one.
    ///
    /// # Errors
    /// The system's reason why there can be none.
    pub fn new() -> io::Result<Self> {
        Ok(Self { file: tempfile::tempfile()?, end: Mutex::new(0) })
    }

    /// Adds bytes at the end and says where they are.
    ///
    /// # Errors
    /// What the system says: the disk is full, for instance.
    #[cfg(unix)]
    pub fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        use std::os::unix::fs::FileExt;
        let start = {
            let mut end = self.end.lock().map_err(|_| poisoned())?;
            let start = *end;
            *end += bytes.len() as u64;
            start
        };
        self.file.write_all_at(bytes, start)?;
        Ok(start)
    }

    /// Reads bytes from where they are.
    ///
    /// # Errors
    /// What the system says.
    #[cfg(unix)]
    pub fn read(&self, start: u64, bytes: &mut [u8]) -> io::Result<()> {
        use std::os::unix::fs::FileExt;
        self.file.read_exact_at(bytes, start)
    }

    /// Adds bytes at the end and says where they are.
    ///
    /// # Errors
    /// What the system says: the disk is full, for instance.
    #[cfg(not(unix))]
    pub fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        let mut end = self.end.lock().map_err(|_| poisoned())?;
        let start = *end;
        let mut file = &self.file;
        file.seek(SeekFrom::Start(start))?;
        file.write_all(bytes)?;
        *end += bytes.len() as u64;
        Ok(start)
    }

    /// Reads bytes from where they are.
    ///
    /// # Errors
    /// What the system says.
    #[cfg(not(unix))]
    pub fn read(&self, start: u64, bytes: &mut [u8]) -> io::Result<()> {
        let _end = self.end.lock().map_err(|_| poisoned())?;
        let mut file = &self.file;
        file.seek(SeekFrom::Start(start))?;
        file.read_exact(bytes)
    }
}

fn poisoned() -> io::Error {
    io::Error::other("another thread has failed")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_threads_write_is_read_where_it_is() {
        let spool = Spool::new().expect("a temporary file");
        std::thread::scope(|scope| {
            for number in 0..8_u8 {
                let spool = &spool;
                scope.spawn(move || {
                    let written = vec![number; 1000 + usize::from(number)];
                    let at = spool.append(&written).expect("written");
                    let mut read = vec![0; written.len()];
                    spool.read(at, &mut read).expect("read");
                    assert_eq!(read, written);
                });
            }
        });
        let mut beyond = [0; 16];
        assert!(spool.read(8 * 1000 + 28, &mut beyond).is_err());
    }
}
