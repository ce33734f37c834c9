//! The picture that `--from` names: its header says how it was made.

use std::path::{Path, PathBuf};

use super::table::Table;
use crate::cli::error::CliError;
use crate::film::exr;
use crate::formats::toml::{self, Setting as Line, SettingValue};
use crate::scene::Notice;

/// A picture, and what is to be the same when it is made again.
#[derive(Clone, Debug)]
pub struct Origin {
    picture: PathBuf,
    /// The digest of its scene, if the scene is to be the same.
    pub digest: Option<String>,
    version: Option<String>,
}

/// What a picture's header says.
pub struct Header {
    /// The settings that made it.
    pub settings: Vec<Line>,
    /// The scene's file.
    pub scene_file: PathBuf,
    /// The picture itself.
    pub origin: Origin,
}

/// Reads the header of a picture.
///
/// # Errors
/// If it is no picture of dapple's.
pub fn read_header(table: &Table, picture: &Path) -> Result<Header, CliError> {
    let mut strings = exr::read(picture)?.strings;
    let mut take = |name: &str| strings.remove(&format!("dapple/{name}"));
    let (Some(settings), Some(scene)) = (take("settings"), take("scene")) else {
        let message = "its header does not tell how it was made: it is not dapple's";
        return Err(CliError::Input(format!("{}: {message}", picture.display())));
    };
    let mut settings = toml::settings_of_text(picture, &settings)?;
    for Line { key, value, .. } in &mut settings {
        if let SettingValue::Word(word) = value
            && table.names_file(key, word)
        {
            *word = locate(Path::new(word), picture).display().to_string();
        }
    }
    let (digest, version) = (take("scene-digest"), take("version"));
    let origin = Origin { picture: picture.to_owned(), digest, version };
    Ok(Header { settings, scene_file: locate(Path::new(&scene), picture), origin })
}

/// Where a file is that was named when a picture was made: seen from here, or else from the folder
/// of the picture, or from those around it.
fn locate(file: &Path, picture: &Path) -> PathBuf {
    let picture = std::path::absolute(picture).unwrap_or_else(|_| picture.to_owned());
    let folders = picture.ancestors().skip(1);
    let from_there = folders.map(|folder| folder.join(file)).find(|path| path.exists());
    match from_there {
        Some(path) if file.is_relative() && !file.exists() => path,
        _ => file.to_owned(),
    }
}

impl Origin {
    /// What is not as it was when the picture was made; `digest` is that of the scene now.
    pub fn list_changes(&self, digest: u64) -> Vec<Notice> {
        let place = || self.picture.display().to_string();
        let mut notices = Vec::new();
        if self.digest.as_ref().is_some_and(|then| *then != format!("{digest:016x}")) {
            let message = "the scene is not what it was when this was made".to_owned();
            notices.push(Notice { place: place(), message });
        }
        let now = env!("CARGO_PKG_VERSION");
        if let Some(then) = self.version.as_ref().filter(|then| *then != now) {
            let message = format!("was made by dapple {then}; this is {now}");
            notices.push(Notice { place: place(), message });
        }
        notices
    }
}
