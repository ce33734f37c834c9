//! The way in: from a path to a scene.

use std::io;
use std::path::Path;

use super::{LoadError, Scene, gltf, obj, ply, texture_range, toml};
use crate::files;

/// What to do about a texture that is missing or broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingTexture {
    /// An error that lists all of them.
    #[default]
    Error,
    /// Paint it magenta, or leave it out where it holds no colours, and say so in a notice.
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
    /// Which of the file's animations is posed, by its name or else its number from 0; none: the
    /// first.
    pub animation: Option<String>,
    /// The time at which animations are posed, seconds; none: all is in its rest pose.
    pub time: Option<f32>,
}

impl LoadOptions {
    /// For formats that hold one scene alone: refuses to choose among several.
    ///
    /// # Errors
    /// [`LoadError::NoSuch`].
    pub(super) fn refuse_choices(&self, path: &Path) -> Result<(), LoadError> {
        let choices =
            [("scene", &self.scene), ("variant", &self.variant), ("animation", &self.animation)];
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
    let mut scene = load_format(path, options)?;
    texture_range::restrict(&mut scene, path)?;
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::film::{Picture, Window, exr};
    use crate::scene::{Material, TextureRef};

    /// A one-pixel EXR file.
    fn write_exr(path: &Path, color: [f32; 3]) {
        let window = Window::of_size(1, 1);
        let mut picture = Picture::new(window, window);
        picture.set_layer("", "RGB", &[color]);
        exr::write(path, &picture).expect("written");
    }

    /// Pictures of floats are textures as others are, linear, and emit all that they hold; but
    /// nothing reflects more than it gets.
    #[test]
    fn open_exr_and_radiance_files_are_textures() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |name: &str| folder.path().join(name);
        write_exr(&place("a.exr"), [0.5, 4.0, 0.25]);
        let pixels = [image::Rgb([8.0_f32, 2.0, 1.0])];
        let file = fs::File::create(place("a.hdr")).expect("created");
        image::codecs::hdr::HdrEncoder::new(file).encode(&pixels, 1, 1).expect("written");
        let text = "newmtl m\nmap_Kd a.exr\nKe 1 1 1\nmap_Ke a.hdr\nmap_Pr a.exr\n";
        fs::write(place("a.mtl"), text).expect("written");
        let text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
        fs::write(place("a.obj"), text).expect("written");

        let scene = load(&place("a.obj"), &LoadOptions::default()).expect("loads");
        let found = scene.materials.iter().find(|material| material.name == "m");
        let material: &Material = found.expect("it is used");
        let color = |slot: Option<TextureRef>| {
            let texture = &scene.textures[slot.expect("a texture").texture.index()];
            texture.texel(0, 0).truncate().to_array()
        };
        assert_eq!(color(material.base_color_texture), [0.5, 1.0, 0.25]);
        assert_eq!(color(material.emissive_texture), [8.0, 2.0, 1.0]);
        let said: Vec<_> = scene.notices.iter().map(|notice| &*notice.message).collect();
        assert!(said.len() == 1 && said[0].starts_with("\"a.exr\" holds values"), "{said:?}");
        let strict = LoadOptions { strict: true, ..LoadOptions::default() };
        assert!(load(&place("a.obj"), &strict).is_err());
    }
}
