//! What can go wrong when a scene is loaded.

use std::fmt;
use std::io;
use std::path::Path;

use super::choice::absent;
use crate::scene::Notice;

/// Why a scene could not be loaded. Every message names the file and the place in it.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// A file could not be read at all.
    #[error("{file}: {source}")]
    Read {
        /// As the caller or the scene names it.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// The contents are wrong: `scenes/a.gltf: /accessors/3: …`, or `scenes/a.gltf: …` where the
    /// file as a whole is meant.
    #[error("{file}: {}{message}", Prefix(place))]
    Invalid {
        /// As the caller or the scene names it.
        file: String,
        /// A JSON pointer, or empty.
        place: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// The contents of a text file are wrong: `scenes/a.obj:17: …`.
    #[error("{file}:{line}: {message}")]
    Line {
        /// As the caller or the scene names it.
        file: String,
        /// Counted from 1.
        line: usize,
        /// What is wrong and what to do.
        message: String,
    },
    /// Extensions without which the file must not be drawn.
    #[error(
        "{file}: requires {}, which dapple does not support{}",
        list(extensions),
        remedy(extensions)
    )]
    Extensions {
        /// As the caller or the scene names it.
        file: String,
        /// Their names.
        extensions: Vec<String>,
    },
    /// Files that the scene refers to, or pictures within it, are missing or broken: all of them.
    #[error("{}", BrokenList(file, broken))]
    References {
        /// The scene's file.
        file: String,
        /// All that cannot be used.
        broken: Vec<Broken>,
    },
    /// There is no scene, camera or variant of the name or number asked for.
    #[error("{file}: {}", absent(what, wanted, names))]
    NoSuch {
        /// As the caller or the scene names it.
        file: String,
        /// What was asked for: `scene`, `camera`, `variant`.
        what: &'static str,
        /// Its name or number.
        wanted: String,
        /// The names of all there are; empty where they have none.
        names: Vec<String>,
    },
    /// Neither the ending nor the first bytes tell the format.
    #[error("{file}: not a scene that dapple reads (.gltf, .glb, .obj, .ply, .toml)")]
    UnknownFormat {
        /// As the caller or the scene names it.
        file: String,
    },
    /// `strict` was asked for and there are notices.
    #[error("{}refused because of --strict", Notices(notices))]
    Strict {
        /// The notices.
        notices: Vec<Notice>,
    },
}

impl LoadError {
    /// [`LoadError::NoSuch`] for a path.
    pub fn no_such<'a>(
        file: &Path,
        what: &'static str,
        wanted: &str,
        names: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let names = names.into_iter().map(str::to_owned).collect();
        Self::NoSuch { file: file.display().to_string(), what, wanted: wanted.to_owned(), names }
    }

    /// [`LoadError::Read`] for a path; a file that is not there is said to be missing.
    pub fn read(file: &Path, source: io::Error) -> Self {
        Self::Read { file: file.display().to_string(), source: simplify_error(source) }
    }

    /// [`LoadError::Invalid`] for a path; `place` is a JSON pointer or empty.
    pub fn invalid(file: &Path, place: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Invalid {
            file: file.display().to_string(),
            place: place.into(),
            message: message.into(),
        }
    }

    /// [`LoadError::Line`] for a path; `line` counts from 1.
    pub fn line(file: &Path, line: usize, message: impl Into<String>) -> Self {
        Self::Line { file: file.display().to_string(), line, message: message.into() }
    }
}

/// Something that a scene refers to and that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Broken {
    /// The file's name as the scene spells it; empty where the data are inside the scene's file.
    pub name: String,
    /// Where the scene refers to it: a JSON pointer, or `file:line`.
    pub place: String,
    /// What is the matter.
    pub reason: String,
    /// Whether it is a texture, without which one can go on.
    pub texture: bool,
}

struct Prefix<'a>(&'a str);

impl fmt::Display for Prefix<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, "{}: ", self.0) }
    }
}

/// What the system says of a file, in plain words where there is none.
fn simplify_error(source: io::Error) -> io::Error {
    let missing = source.kind() == io::ErrorKind::NotFound && source.raw_os_error().is_some();
    if missing { io::Error::new(io::ErrorKind::NotFound, "no such file") } else { source }
}

/// The scene's file, and what of it cannot be used.
struct BrokenList<'a>(&'a str, &'a [Broken]);

impl fmt::Display for BrokenList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(file, all) = *self;
        match all {
            // Of a text file the place is `file:line`, and that is enough.
            [one] if in_file(&one.place, file) => Line(one).fmt(f)?,
            [one] => write!(f, "{file}: {}", Line(one))?,
            _ => {
                write!(f, "{file}: {} references cannot be used:", all.len())?;
                for broken in all {
                    write!(f, "\n  {}", Line(broken))?;
                }
            }
        }
        if !all.is_empty() && all.iter().all(|broken| broken.texture) {
            let joint = if all.len() == 1 { "; " } else { "\n" };
            write!(f, "{joint}--missing-texture magenta goes on without")?;
        }
        Ok(())
    }
}

/// Whether a place is a line of `file`.
fn in_file(place: &str, file: &str) -> bool {
    place.strip_prefix(file).is_some_and(|rest| rest.starts_with(':'))
}

struct Line<'a>(&'a Broken);

impl fmt::Display for Line<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Broken { name, place, reason, .. } = self.0;
        if name.is_empty() {
            write!(f, "{place}: {reason}")
        } else {
            write!(f, "{place}: {name:?}: {reason}")
        }
    }
}

struct Notices<'a>(&'a [Notice]);

impl fmt::Display for Notices<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|notice| writeln!(f, "{}: {}", notice.place, notice.message))
    }
}

fn list(names: &[String]) -> String {
    match names {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// What helps where the extension packs textures in a way that is not read.
fn remedy(extensions: &[String]) -> &'static str {
    let packed = ["EXT_texture_avif", "MSFT_texture_dds"];
    if extensions.iter().any(|name| packed.contains(&name.as_str())) {
        "; export it again with other textures"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_where_and_what() {
        let file = Path::new("scenes/a.gltf");
        assert_eq!(
            LoadError::invalid(file, "/accessors/3", "its count is 0").to_string(),
            "scenes/a.gltf: /accessors/3: its count is 0"
        );
        assert_eq!(LoadError::invalid(file, "", "empty").to_string(), "scenes/a.gltf: empty");
        assert_eq!(
            LoadError::line(Path::new("a.obj"), 17, "face refers to vertex 9 of 8").to_string(),
            "a.obj:17: face refers to vertex 9 of 8"
        );
    }

    #[test]
    fn all_broken_references_are_listed() {
        let broken = |name: &str| Broken {
            name: name.to_owned(),
            place: "/images/0".to_owned(),
            reason: "no such file".to_owned(),
            texture: true,
        };
        let file = "a.gltf".to_owned();
        let two = LoadError::References { file, broken: vec![broken("x.png"), broken("y.png")] };
        assert_eq!(
            two.to_string(),
            "a.gltf: 2 references cannot be used:\n  /images/0: \"x.png\": no such file\n  \
             /images/0: \"y.png\": no such file\n--missing-texture magenta goes on without"
        );
    }

    #[test]
    fn one_broken_reference_does_not_name_its_file_twice() {
        let said = |place: &str| {
            let broken = Broken {
                name: "b.obj".to_owned(),
                place: place.to_owned(),
                reason: "no such file".to_owned(),
                texture: false,
            };
            let file = "s.toml".to_owned();
            LoadError::References { file, broken: vec![broken] }.to_string()
        };
        assert_eq!(said("s.toml:7"), "s.toml:7: \"b.obj\": no such file");
        assert_eq!(said("b.mtl:7"), "s.toml: b.mtl:7: \"b.obj\": no such file");
        assert_eq!(said("/images/0"), "s.toml: /images/0: \"b.obj\": no such file");
    }

    #[test]
    fn a_missing_file_is_said_to_be_missing() {
        let said = |source| LoadError::read(Path::new("a.obj"), source).to_string();
        // ENOENT, as the system gives it.
        assert_eq!(said(io::Error::from_raw_os_error(2)), "a.obj: no such file");
        let other = io::Error::new(io::ErrorKind::NotFound, "no such file, nor a colour");
        assert_eq!(said(other), "a.obj: no such file, nor a colour");
    }

    #[test]
    fn packed_files_come_with_a_remedy() {
        let extensions = vec!["EXT_texture_avif".to_owned(), "X".to_owned()];
        let error = LoadError::Extensions { file: "a.glb".to_owned(), extensions };
        assert_eq!(
            error.to_string(),
            "a.glb: requires EXT_texture_avif and X, which dapple does not support; \
             export it again with other textures"
        );
    }
}
