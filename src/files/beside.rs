//! Output files that are whole or not there.
//!
//! The bytes go to a temporary file in the target's own folder and take the target's name in one
//! step. Whoever looks sees the old file or the new one; a full disk or an error half-way leaves
//! the old one and no temporary. A process that ends without unwinding calls [`remove_pending`]
//! first. After `kill -9` or a power cut a temporary may stay; the next process that is to write
//! the same file removes it: temporaries are locked for as long as someone writes them. Their names
//! hold a random number, so that processes on many hosts do not clash in a shared folder.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
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

/// Whether [`write()`] could begin at `path`: makes the temporary file and removes it, and all that
/// processes which are no more have left there.
///
/// # Errors
/// The system's reason. A pipe or device is not opened, which might wait for its other end.
pub fn probe(path: &Path) -> io::Result<()> {
    match target(path)? {
        Some(target) => {
            remove_left(&target);
            Temporary::beside(&target).map(drop)
        }
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

/// What temporaries end with.
const ENDING: &str = ".tmp";

/// What the names of the temporaries of a file begin with.
fn prefix(target: &Path) -> Option<OsString> {
    let mut prefix = OsString::from(".");
    prefix.push(target.file_name()?);
    prefix.push(".");
    Some(prefix)
}

/// Removes the temporaries of a file that no one is writing.
fn remove_left(target: &Path) {
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = fs::read_dir(folder.unwrap_or(Path::new(".")));
    let Some(prefix) = prefix(target) else { return };
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name();
        let rest = name.as_encoded_bytes().strip_prefix(prefix.as_encoded_bytes());
        let random = rest.and_then(|rest| rest.strip_suffix(ENDING.as_bytes()));
        let is_ours =
            random.is_some_and(|it| it.len() == 16 && it.iter().all(u8::is_ascii_hexdigit));
        let is_left = || File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if is_ours && is_left() {
            let _ = fs::remove_file(entry.path());
        }
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
        let mut name = prefix(target).ok_or(io::ErrorKind::InvalidInput)?;
        // Keyed at random by the system, anew for each thread and call.
        let random = RandomState::new().hash_one(std::process::id());
        name.push(format!("{random:016x}{ENDING}"));
        let path = target.with_file_name(name);
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        // Where files cannot be locked, what is left there stays.
        let _ = file.try_lock();
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
    fn what_the_dead_have_left_goes_and_what_the_living_write_stays() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.exr");
        let left = folder.path().join(".out.exr.0123456789abcdef.tmp");
        let other = folder.path().join(".out.exr.mine.tmp");
        for file in [&left, &other] {
            fs::write(file, b"half").expect("written");
        }
        write(&path, Flush::WhenIdle, |file| {
            probe(&path).expect("another process could write there");
            file.write_all(b"new")
        })
        .expect("what is being written stays");
        assert_eq!(names(folder.path()), [".out.exr.mine.tmp", "out.exr"]);
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
