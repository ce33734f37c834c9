//! The way in: from a path to a scene.

use std::path::Path;

use super::model::load_model;
use super::{LoadError, LoadOptions, toml};
use crate::scene::{Notice, Scene};

/// Loads a scene; its format is told by its ending, else by its first bytes.
///
/// # Examples
/// ```
/// let scene = dapple::load("scenes/cornell.gltf", &dapple::LoadOptions::default())?;
/// assert_eq!(scene.cameras.len(), 1);
/// # Ok::<(), dapple::LoadError>(())
/// ```
///
/// # Errors
/// [`LoadError`], which names the file and the place in it. With `strict` any notice is an error,
/// but for one of a rest pose.
pub fn load(path: impl AsRef<Path>, options: &LoadOptions) -> Result<Scene, LoadError> {
    let path = path.as_ref();
    let scene =
        if toml::is_toml(path) { toml::load(path, options) } else { load_model(path, options) }?;
    if options.strict && scene.notices.iter().any(Notice::is_refused) {
        return Err(LoadError::Strict { notices: scene.notices });
    }
    Ok(scene)
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
        picture.set_aov("", "RGB", &[color]);
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

        let scene = load(place("a.obj"), &LoadOptions::default()).expect("loads");
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
        assert!(load(place("a.obj"), &strict).is_err());
    }
}
