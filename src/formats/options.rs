//! How to load a scene.

use std::path::Path;
use std::sync::Arc;

use super::LoadError;
use crate::files::Meter;
use crate::texture::TextureStore;

/// What to do about a texture that is missing or broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MissingTexture {
    /// An error that lists all of them.
    #[default]
    Error,
    /// Paint it magenta, or leave it out where it holds no colours, and say so in a notice.
    Magenta,
}

/// What `d` and `Tr` of a material of an OBJ file mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MtlTransparency {
    /// `d` is the opacity; where there is none, `Tr` is, as old exporters had it.
    D,
    /// `Tr` is the transparency; where there is none, `d` is the opacity.
    Tr,
    /// `d` is the opacity; where there is none, `Tr` is the transparency. Whatever that hides.
    File,
}

/// How to load a scene.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Whether any notice is an error.
    pub strict: bool,
    /// What to do about a texture that is missing or broken.
    pub missing_texture: MissingTexture,
    /// What transparency means in an OBJ file; none: as [`MtlTransparency::File`] has it, but a
    /// file of which all would be invisible is opaque.
    pub mtl_transparency: Option<MtlTransparency>,
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
    /// How long the shutter is open from that time on, seconds, while what is animated moves; none:
    /// an instant.
    pub shutter: Option<f32>,
    /// What decodes and keeps the images of textures; by default a new one without a limit, and
    /// without smaller versions of images. Scenes that are loaded with the same one share their
    /// images.
    pub textures: Arc<TextureStore>,
    /// Who is told how much of the reading is done, in bytes.
    pub meter: Arc<Meter>,
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
