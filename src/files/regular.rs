//! Inputs that end, and which paths lead to one file.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Opens a regular file for reading; its length comes with it.
///
/// # Errors
/// What the system says, or that it is no regular file: a pipe may never be opened or never end.
pub fn open(path: &Path) -> io::Result<(File, u64)> {
    // Asked before it is opened: opening a pipe waits for who writes to it.
    let metadata = fs::metadata(path).map_err(simplify)?;
    if metadata.is_dir() {
        return Err(io::Error::other("is a folder, not a file"));
    }
    if !metadata.is_file() {
        return Err(io::Error::other("is not a regular file"));
    }
    Ok((File::open(path)?, metadata.len()))
}

/// The words for a file that is not there.
const MISSING: &str = "no such file";

/// What the system says of a file, in plain words where there is none.
fn simplify(error: io::Error) -> io::Error {
    let missing = error.kind() == ErrorKind::NotFound && error.raw_os_error().is_some();
    if missing { io::Error::new(ErrorKind::NotFound, MISSING) } else { error }
}

/// What there is to say of a file that cannot be read: that there is none, or why.
pub fn why_unread(error: &io::Error) -> String {
    let missing = error.kind() == ErrorKind::NotFound && error.raw_os_error().is_some();
    let reason = error.to_string();
    if missing || reason == MISSING {
        MISSING.to_owned()
    } else {
        format!("cannot be read: {reason}")
    }
}

/// The contents of a regular file of up to `most` bytes.
///
/// # Errors
/// As [`open`], or that it is larger.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let (file, length) = open(path)?;
    let mut bytes = Vec::new();
    if length <= most {
        bytes.try_reserve_exact(length as usize).map_err(io::Error::other)?;
        // It may grow while it is read.
        file.take(most + 1).read_to_end(&mut bytes)?;
    }
    if length.max(bytes.len() as u64) > most {
        let (size, unit) = if most >= 1 << 30 { (most >> 30, "GiB") } else { (most >> 20, "MiB") };
        return Err(io::Error::other(format!("is larger than {size} {unit}")));
    }
    Ok(bytes)
}

/// Whether two paths lead to one regular file, or would once it is written.
///
/// Pipes and devices (`/dev/null`, `/dev/stdout`) can be written to twice and are never the same.
pub fn same(a: &Path, b: &Path) -> bool {
    let special = |path: &Path| fs::metadata(path).is_ok_and(|found| !found.is_file());
    !special(a) && !special(b) && place(a) == place(b)
}

/// Where a path leads, links resolved as far as it exists.
fn place(path: &Path) -> PathBuf {
    if let Ok(real) = fs::canonicalize(path) {
        return real;
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match (fs::canonicalize(folder.unwrap_or(Path::new("."))), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_regular_files_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        fs::write(&path, [7; 10]).expect("written");
        assert_eq!(open(&path).expect("there").1, 10);
        assert_eq!(read(&path, 10).expect("small enough"), [7; 10]);
        let large = fs::File::options().write(true).open(&path).expect("there");
        large.set_len((1 << 20) + 1).expect("it grows");
        let error = read(&path, 1 << 20).expect_err("too large").to_string();
        assert_eq!(error, "is larger than 1 MiB");
        assert_eq!(
            open(folder.path()).expect_err("a folder").to_string(),
            "is a folder, not a file"
        );
        assert!(open(&folder.path().join("b")).is_err());
        if cfg!(unix) {
            let error = open(Path::new("/dev/null")).expect_err("a device").to_string();
            assert_eq!(error, "is not a regular file");
        }
    }

    #[test]
    fn one_file_has_many_paths() {
        let folder = tempfile::tempdir().expect("a folder");
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        let round = folder.path().join("c/../a");
        fs::create_dir(folder.path().join("c")).expect("made");
        assert!(same(&a, &round) && !same(&a, &b), "neither is there yet");
        fs::write(&a, []).expect("written");
        assert!(same(&a, &round) && same(&a, &a) && !same(&a, &b));
        assert!(same(Path::new("no/such/a"), Path::new("no/such/a")));
        if cfg!(unix) {
            let null = Path::new("/dev/null");
            assert!(!same(null, null));
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_leads_to_its_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, []).expect("written");
        std::os::unix::fs::symlink(&real, &link).expect("linked");
        assert!(same(&real, &link));
    }

    #[test]
    fn a_file_that_is_not_there_is_told_in_one_way() {
        let missing = open(Path::new("no/such")).expect_err("not there");
        let folder = open(Path::new(".")).expect_err("a folder");
        assert_eq!(missing.to_string(), "no such file");
        assert_eq!(why_unread(&missing), "no such file");
        assert_eq!(why_unread(&io::Error::from_raw_os_error(2)), "no such file");
        assert_eq!(why_unread(&folder), "cannot be read: is a folder, not a file");
    }
}
