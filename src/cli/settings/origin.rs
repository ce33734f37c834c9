//! The picture that `--from` names: its header says how it was made.

use std::path::{Path, PathBuf};

use super::table::Table;
use crate::cli::error::CliError;
use crate::film::exr;
use crate::formats::toml::{self, Setting as Line, SettingValue};
use crate::scene::{Notice, are_comparable};

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
    /// Whether a scene has changed cannot be told by digests that were made in two ways.
    pub fn list_changes(&self, digest: &str) -> Vec<Notice> {
        let place = || self.picture.display().to_string();
        let mut notices = Vec::new();
        if let Some(then) = self.digest.as_ref().filter(|then| *then != digest) {
            let message = if are_comparable(then, digest) {
                "the scene is not what it was when this was made"
            } else {
                "whether the scene is what it was cannot be told: its digest was made otherwise"
            };
            notices.push(Notice { place: place(), message: message.to_owned() });
        }
        let now = env!("CARGO_PKG_VERSION");
        if let Some(then) = self.version.as_ref().filter(|then| *then != now) {
            let message = format!("was made by dapple {then}; this is {now}");
            notices.push(Notice { place: place(), message });
        }
        notices
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_scene_is_told_from_a_digest_that_was_made_otherwise() {
        let said = |then: &str| {
            let digest = Some(then.to_owned());
            let origin = Origin { picture: PathBuf::from("a.exr"), digest, version: None };
            origin.list_changes("0a0b-01").first().map(|notice| notice.message.clone())
        };
        assert_eq!(said("0a0b-01"), None);
        assert!(said("0a0b-02").is_some_and(|it| it.contains("is not what it was")));
        for early in ["0a0c-01", "01"] {
            assert!(said(early).is_some_and(|it| it.contains("cannot be told")), "{early}");
        }
    }
}
