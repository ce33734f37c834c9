//! Where the library may lie.

use std::collections::HashSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use super::error::DenoiseError;

/// The names of the library's file, of which the first that is there is taken.
#[cfg(target_os = "windows")]
const NAMES: &[&str] = &["OpenImageDenoise.dll"];
#[cfg(target_vendor = "apple")]
const NAMES: &[&str] = &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"];
#[cfg(not(any(target_os = "windows", target_vendor = "apple")))]
const NAMES: &[&str] = &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"];

/// Where the wheel `pyoidn` puts the library, below a folder of packages.
const WHEEL: &str = "pyoidn/oidn";

/// What the process is told of where things are.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    /// `DAPPLE_OIDN`: the library, or a folder that holds it.
    pub chosen: Option<PathBuf>,
    /// `VIRTUAL_ENV`: the Python environment that is active.
    pub virtual_env: Option<PathBuf>,
    /// `PATH`.
    pub path: Option<OsString>,
    /// `HOME`.
    pub home: Option<PathBuf>,
}

/// A library to try.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Candidate {
    /// A name, which the system's loader looks for.
    Name(&'static str),
    /// A file that is there.
    File(PathBuf),
}

impl Surroundings {
    /// Those of this process.
    pub fn of_process() -> Self {
        let path = |name| std::env::var_os(name).filter(|it| !it.is_empty()).map(PathBuf::from);
        Self {
            chosen: path("DAPPLE_OIDN"),
            virtual_env: path("VIRTUAL_ENV"),
            path: std::env::var_os("PATH"),
            home: path("HOME"),
        }
    }

    /// The libraries to try, in order: the one that was chosen and no other; or else what the
    /// loader finds, then the wheel of the active Python environment, then that of the first
    /// `python3` on the path, then those of its kin: all versions of pyenv, those of the machine
    /// and of the user. Python is not run.
    ///
    /// # Errors
    /// [`DenoiseError::Misnamed`].
    pub fn candidates(&self) -> Result<Vec<Candidate>, DenoiseError> {
        if let Some(chosen) = &self.chosen {
            let misnamed = |message| DenoiseError::Misnamed { path: chosen.clone(), message };
            if chosen.is_file() {
                return Ok(vec![Candidate::File(chosen.clone())]);
            }
            if !chosen.exists() {
                return Err(misnamed("no such file or folder".to_owned()));
            }
            let found = library_in(chosen);
            let found =
                found.ok_or_else(|| misnamed(format!("holds no {}", NAMES.join(" and no "))))?;
            return Ok(vec![Candidate::File(found)]);
        }
        let names = NAMES.iter().copied().map(Candidate::Name);
        let wheels = self.pythons().into_iter().flat_map(|root| wheels_below(&root));
        Ok(names.chain(wheels.map(Candidate::File)).collect())
    }

    /// The folders that hold `lib/python3.…`, of the Pythons that are near.
    fn pythons(&self) -> Vec<PathBuf> {
        let mut roots: Vec<PathBuf> = self.virtual_env.iter().cloned().collect();
        let folders = self.path.iter().flat_map(std::env::split_paths);
        let mut folders = folders.filter(|it| it.is_absolute());
        let python = folders.find_map(|folder| {
            let files = ["python3", "python.exe"].map(|name| folder.join(name));
            files.into_iter().find(|file| file.is_file())
        });
        // An environment's interpreter is a link to one that lies elsewhere. On Windows it lies in
        // the root, elsewhere one below. That of pyenv is a script beside the versions.
        for file in python.iter().flat_map(|it| [Ok(it.clone()), it.canonicalize()]).flatten() {
            for root in file.ancestors().skip(1).take(2) {
                roots.push(root.to_owned());
                let versions = root.join("versions");
                roots.extend(names_in(&versions).iter().map(|name| versions.join(name)));
            }
        }
        roots.push(PathBuf::from("/usr/local"));
        roots.extend(self.home.iter().map(|home| home.join(".local")));
        let mut seen = HashSet::new();
        roots.retain(|root| seen.insert(root.clone()));
        roots
    }
}

/// The library in a folder, or in `lib` or `bin` there.
fn library_in(folder: &Path) -> Option<PathBuf> {
    let folders = ["", "lib", "bin"].map(|below| folder.join(below));
    let files = folders.iter().flat_map(|folder| NAMES.iter().map(|name| folder.join(name)));
    files.into_iter().find(|file| file.is_file())
}

/// The libraries of the wheels of a Python, those of later versions first.
fn wheels_below(root: &Path) -> Vec<PathBuf> {
    let mut packages = vec![root.join("Lib").join("site-packages")];
    for lib in ["lib", "lib64"].map(|name| root.join(name)) {
        for name in names_in(&lib).iter().filter(|name| name.starts_with("python3")) {
            let python = lib.join(name);
            packages.extend(["site-packages", "dist-packages"].map(|name| python.join(name)));
        }
    }
    packages.iter().filter_map(|folder| library_in(&folder.join(WHEEL))).collect()
}

/// The names of what is in a folder, later versions first; none if it cannot be read.
fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    // The order of a folder's entries is any. `python3.12` is later than `python3.9`.
    names.sort_by_key(|name| std::cmp::Reverse((name.len(), name.clone())));
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes an empty file, and the folders above it.
    fn touch(file: &Path) {
        std::fs::create_dir_all(file.parent().expect("below a folder")).expect("made");
        std::fs::write(file, []).expect("written");
    }

    #[test]
    fn the_one_that_was_chosen_is_the_only_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = folder.path().join("lib").join(NAMES[0]);
        touch(&library);
        let virtual_env = Some(folder.path().to_owned());
        for chosen in [&library, folder.path(), &folder.path().join("lib")] {
            let chosen = Some(chosen.to_owned());
            let of =
                Surroundings { chosen, virtual_env: virtual_env.clone(), ..Default::default() };
            assert_eq!(of.candidates().expect("it is there"), [Candidate::File(library.clone())]);
        }
    }

    #[test]
    fn a_choice_that_cannot_be_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        for (chosen, said) in [
            (folder.path().join("none"), "none: no such file or folder".to_owned()),
            (folder.path().to_owned(), format!(": holds no {}", NAMES[0])),
        ] {
            let of = Surroundings { chosen: Some(chosen), ..Default::default() };
            let error = of.candidates().expect_err("nothing there");
            let text = error.to_string();
            assert!(text.starts_with("DAPPLE_OIDN=") && text.contains(&said), "{text}");
            assert_eq!(error.exit_code(), 3);
        }
    }

    #[test]
    fn wheels_come_after_the_loader_and_the_active_environment_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        let wheel = |root: &Path, python: &str, packages: &str| {
            let place = root.join("lib").join(python).join(packages);
            let file = place.join(WHEEL).join("lib").join(NAMES[0]);
            touch(&file);
            file
        };
        let active = wheel(&place("venv"), "python3.13", "site-packages");
        let older = wheel(&place("usr"), "python3.9", "site-packages");
        let newer = wheel(&place("usr"), "python3.12", "dist-packages");
        let own = wheel(&place("home/.local"), "python3.12", "site-packages");
        let shim = wheel(&place("usr/versions/3.12.1"), "python3.12", "site-packages");
        wheel(&place("later"), "python3.12", "site-packages");
        for bin in ["usr/bin", "later/bin"] {
            touch(&place(bin).join("python3"));
        }
        let on_path = ["empty", "usr/bin", "later/bin"].map(place);
        let of = Surroundings {
            chosen: None,
            virtual_env: Some(place("venv")),
            path: Some(std::env::join_paths(on_path).expect("no colons")),
            home: Some(place("home")),
        };
        let found = of.candidates().expect("nothing was chosen");
        let (names, files) = found.split_at(NAMES.len());
        assert!(names.iter().zip(NAMES).all(|(it, name)| *it == Candidate::Name(name)));
        let files: Vec<_> = files
            .iter()
            .filter(|it| matches!(it, Candidate::File(file) if file.starts_with(folder.path())))
            .cloned()
            .collect();
        assert_eq!(files, [active, newer, older, shim, own].map(Candidate::File));
    }
}
