//! The way in: from a path to a scene.

use std::io;
use std::path::Path;

use super::{LoadError, Scene, gltf, obj, ply, toml};
use crate::files;

/// What to do about a texture that is missing or broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingTexture {
    /// An error that lists all of them.
    #[default]
    Error,
    /// Paint it magenta and say so in a notice.
    Magenta,
}

/// How to load a scene.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Whether any notice is an error.
    pub strict: bool,
    /// What to do about a texture that is missing or broken.
    pub missing_texture: MissingTexture,
    /// Which of a file's scenes, by its name or else its number from 0; none: the file's default.
    pub scene: Option<String>,
    /// Which of the file's variants of materials (KHR_materials_variants), by its name or else its
    /// number from 0; none: the materials that it has without.
    pub variant: Option<String>,
    /// The time at which animations are posed, seconds; none: all is in its rest pose.
    pub time: Option<f32>,
}

impl LoadOptions {
    /// For formats that hold one scene alone: refuses to choose among several.
    ///
    /// # Errors
    /// [`LoadError::NoSuch`].
    pub(super) fn refuse_choices(&self, path: &Path) -> Result<(), LoadError> {
        let choices = [("scene", &self.scene), ("variant", &self.variant)];
        match choices.iter().find_map(|(what, wanted)| Some((*what, wanted.as_deref()?))) {
            Some((what, wanted)) => Err(LoadError::no_such(path, what, wanted, [])),
            None => Ok(()),
        }
    }
}

/// Loads a scene; its format is told by its ending, else by its first bytes.
///
/// # Errors
/// [`LoadError`], which names the file and the place in it. With `strict` any notice is an error.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    let scene =
        if toml::is_toml(path) { toml::load(path, options) } else { load_part(path, options) }?;
    if options.strict && !scene.notices.is_empty() {
        return Err(LoadError::Strict { notices: scene.notices });
    }
    Ok(scene)
}

/// The same of a file that may be part of a TOML scene; notices are none of its concern.
pub(super) fn load_part(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("obj") => obj::load(path, options),
        Some("ply") => ply::load(path, options),
        Some("gltf" | "glb") => gltf::load(path, options),
        _ => {
            let bytes = read_file(path)?;
            if gltf::is_gltf(&bytes) {
                gltf::parse(path, &bytes, options)
            } else if ply::is_ply(&bytes) {
                ply::parse(path, &bytes, options)
            } else {
                Err(LoadError::UnknownFormat { file: path.display().to_string() })
            }
        }
    }
}

/// The largest file that is read: a limit against special and sparse files, not against scenes.
const MAX_FILE_BYTES: u64 = 8 << 30;

/// The contents of a regular file.
///
/// # Errors
/// [`LoadError::Read`] with what the system says, or if it is no regular file (a pipe would never
/// end) or beyond 8 GiB.
pub fn read_file(path: &Path) -> Result<Vec<u8>, LoadError> {
    read_regular(path).map_err(|source| LoadError::read(path, source))
}

/// [`read_file`] with the bare reason.
pub(super) fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    files::read(path, MAX_FILE_BYTES)
}
