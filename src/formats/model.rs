//! A model: a file that holds shapes, whatever its format.

use std::path::Path;

use super::{LoadError, LoadOptions, gltf, obj, ply, read_file, texture_range};
use crate::scene::Scene;
use crate::texture::add_levels;

/// Loads a file of one of the formats that hold shapes, on its own or as a part of a TOML scene.
/// The format is told by the ending, else by the first bytes. Notices are never an error here.
pub(super) fn load_model(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    let mut scene = load_format(path, options)?;
    texture_range::restrict(&mut scene, path, &options.textures)?;
    if options.textures.wants_levels() {
        add_levels(&mut scene.textures, &options.textures);
    }
    Ok(scene)
}

fn load_format(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
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
