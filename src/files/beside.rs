//! Output files that are whole or not there.
//!
//! The bytes go to a temporary file in the target's own folder and take the target's name in one
//! step. Whoever looks sees the old file or the new one; a full disk or an error half-way leaves
//! the old one and no temporary. A process that ends without unwinding calls [`remove_pending`]
//! first; after `kill -9` or a power cut a temporary may stay (`.name.process-number.tmp`).

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Whether a file is on the disk once it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flush {
    /// It is, with its folder: a power cut does not lose it.
    ToDisk,
    /// The system writes it when it likes: for what is quick to make again.
    WhenIdle,
}

/// Writes a file by `fill`, beside `path` and then renamed to it.
///
/// A `path` that is a symbolic link keeps being one: what it points at is replaced. Something that
/// is no regular file (a pipe, `/dev/stdout`) is written to directly.
///
/// # Errors
/// The system's reason, with what stood at `path` untouched.
pub fn write(
    path: &Path,
    flush: Flush,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let Some(target) = target(path)? else {
        let mut file = BufWriter::new(OpenOptions::new().write(true).open(path)?);
        fill(&mut file)?;
        return file.flush();
    };
    let (temporary, file) = Temporary::beside(&target)?;
    let mut file = BufWriter::with_capacity(1 << 16, file);
    fill(&mut file)?;
    let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
    if flush == Flush::ToDisk {
        file.sync_all()?;
    }
    drop(file);
    temporary.rename_to(&target, flush)
}

/// Whether [`write()`] could begin at `path`: makes the temporary file and removes it.
///
/// # Errors
/// The system's reason. A pipe or device is not opened, which might wait for its other end.
pub fn probe(path: &Path) -> io::Result<()> {
    match target(path)? {
        Some(target) => Temporary::beside(&target).map(drop),
        None => Ok(()),
    }
}

/// Removes the temporaries of all writes that have not ended: for a process that is about to end
/// without unwinding.
pub fn remove_pending() {
    // Not waited for: the thread that holds it may be the one that is ending the process.
    if let Ok(mut pending) = PENDING.try_lock() {
        for path in pending.drain(..) {
            let _ = fs::remove_file(path);
        }
    }
}

/// The file to replace; none if what is there is to be written into.
fn target(path: &Path) -> io::Result<Option<PathBuf>> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => Ok(None),
        Ok(_) => fs::canonicalize(path).map(Some),
        Err(_) => Ok(Some(path.to_owned())),
    }
}

/// All temporaries that are there now.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending() -> std::sync::MutexGuard<'static, Vec<PathBuf>> {
    PENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file that is removed unless it is renamed.
struct Temporary {
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    fn beside(target: &Path) -> io::Result<(Self, File)> {
        // Distinct among the threads of this process; the process number does the rest.
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?;
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{number}.tmp", std::process::id()));
        let path = target.with_file_name(hidden);
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        pending().push(path.clone());
        Ok((Self { path, renamed: false }, file))
    }

    fn rename_to(mut self, target: &Path, flush: Flush) -> io::Result<()> {
        fs::rename(&self.path, target)?;
        self.renamed = true;
        if flush == Flush::ToDisk {
            // The new name is in the folder, which has to reach the disk too; where folders cannot
            // be opened (not on Unix) there is nothing to flush.
            let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
            if let Ok(folder) = File::open(folder.unwrap_or(Path::new("."))) {
                let _ = folder.sync_all();
            }
        }
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            let _ = fs::remove_file(&self.path);
        }
        pending().retain(|path| *path != self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
        write(path, Flush::ToDisk, |file| file.write_all(bytes))
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.exr");
        write_bytes(&path, b"old").expect("written");
        probe(&path).expect("it could be written");
        assert_eq!(fs::read(&path).expect("there"), b"old");
        write(&path, Flush::WhenIdle, |file| file.write_all(b"new")).expect("written");
        assert_eq!(fs::read(&path).expect("there"), b"new");
        assert_eq!(names(folder.path()), ["out.exr"]);
        assert!(!pending().iter().any(|pending| pending.starts_with(folder.path())));
    }

    #[test]
    fn a_failure_half_way_leaves_the_old_file_and_no_temporary() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.exr");
        write_bytes(&path, b"old").expect("written");
        let error = write(&path, Flush::ToDisk, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("the disk is full"))
        });
        assert_eq!(error.expect_err("must fail").to_string(), "the disk is full");
        assert_eq!(fs::read(&path).expect("there"), b"old");
        assert_eq!(names(folder.path()), ["out.exr"]);
    }

    #[test]
    fn a_panic_half_way_leaves_no_temporary() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.exr");
        let outcome =
            std::panic::catch_unwind(|| write(&path, Flush::ToDisk, |_| panic!("on purpose")));
        assert!(outcome.is_err());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn an_end_without_unwinding_leaves_no_temporary() {
        // Alone in a process: pending files are those of all its threads.
        const FOLDER: &str = "DAPPLE_TEST_PENDING";
        if let Some(folder) = std::env::var_os(FOLDER) {
            let path = Path::new(&folder).join("out.exr");
            let _ = write(&path, Flush::ToDisk, |file| {
                file.write_all(b"half")?;
                file.flush()?;
                assert_eq!(names(Path::new(&folder)).len(), 1);
                remove_pending();
                std::process::exit(0)
            });
        }
        let folder = tempfile::tempdir().expect("a folder");
        let name = "an_end_without_unwinding_leaves_no_temporary";
        let status = std::process::Command::new(std::env::current_exe().expect("this test"))
            .args([name, "--nocapture"])
            .env(FOLDER, folder.path())
            .status();
        assert!(status.expect("it runs").success());
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_missing_folder_and_a_folder_as_target_are_errors() {
        let folder = tempfile::tempdir().expect("a folder");
        for path in [&folder.path().join("no/out.exr"), folder.path()] {
            assert!(write_bytes(path, b"x").is_err());
            assert!(probe(path).is_err());
        }
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_keeps_being_a_link() {
        let folder = tempfile::tempdir().expect("a folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        write_bytes(&real, b"old").expect("written");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        write_bytes(&link, b"new").expect("written");
        assert!(fs::symlink_metadata(&link).expect("there").file_type().is_symlink());
        assert_eq!(fs::read(&real).expect("there"), b"new");
    }
}
