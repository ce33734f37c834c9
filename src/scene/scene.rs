//! A scene: everything that a picture is made of.

use std::fmt;
use std::sync::Arc;

use super::{Instance, Material, SceneMotion};
use crate::camera::Camera;
use crate::geom::Mesh;
use crate::light::{Environment, Punctual};
use crate::medium::Medium;
use crate::texture::Texture;

/// Between which depths a file says that a camera sees. Nothing is cut there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClipPlanes {
    /// Metres.
    pub near: f32,
    /// Metres; none: no end.
    pub far: Option<f32>,
}

/// A camera and what the file calls it.
#[derive(Clone)]
pub struct NamedCamera {
    /// The file's name for it, or empty.
    pub name: String,
    /// Width over height that the file asks for.
    pub aspect: Option<f32>,
    /// The camera.
    pub camera: Camera,
    /// Where its file says that its sight begins and ends, for who writes it again.
    pub planes: Option<ClipPlanes>,
}

impl fmt::Debug for NamedCamera {
    /// Without the planes: a scene's digest is that of its picture, which they have no say in.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, aspect, camera, planes: _ } = self;
        let mut fields = formatter.debug_struct("NamedCamera");
        fields.field("name", name).field("aspect", aspect).field("camera", camera).finish()
    }
}

/// Something that the file asks for and that is not honoured, or that looks like a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// File and place in it: a line, or a JSON pointer.
    pub place: String,
    /// What is the matter.
    pub message: String,
}

impl Notice {
    /// What is said of a file whose animations nobody asked for.
    pub const REST_POSE: &str = "all is in its rest pose: --time poses animations";

    /// Whether something was asked for and not done, so that strictness refuses the scene. That a
    /// rest pose is shown, as the format has it, is none.
    pub fn is_refused(&self) -> bool {
        !self.is_rest_pose()
    }

    /// Whether it says that a file's animations are left as they rest.
    pub fn is_rest_pose(&self) -> bool {
        self.message.starts_with(Self::REST_POSE)
    }
}

/// An extension that a file uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UsedExtension {
    /// Its name.
    pub name: String,
    /// Whether all of it is done.
    pub honoured: bool,
}

/// What a file has to choose from, and what it asks for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contents {
    /// Names of its scenes, of which one is loaded; empty where they have none.
    pub scenes: Vec<String>,
    /// Names of its variants of materials.
    pub variants: Vec<String>,
    /// Extensions of its format, by their names.
    pub extensions: Vec<UsedExtension>,
}

/// Everything that a picture is made of.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Unique meshes.
    pub meshes: Vec<Arc<Mesh>>,
    /// Placed meshes; flat triangle ids count through them in this order.
    pub instances: Vec<Instance>,
    /// Materials; instances refer to them.
    pub materials: Vec<Material>,
    /// Textures; materials refer to them.
    pub textures: Vec<Texture>,
    /// Lights without extent.
    pub lights: Vec<Punctual>,
    /// What fills all space but the insides of solids.
    pub medium: Option<Medium>,
    /// What shines from infinitely far away.
    pub environment: Option<Environment>,
    /// Cameras in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// What moves while the shutter is open; all else stands where it is.
    pub motion: Option<Box<SceneMotion>>,
    /// What could not be honoured.
    pub notices: Vec<Notice>,
    /// What else the file holds.
    pub contents: Contents,
}

#[cfg(test)]
impl Scene {
    /// A mesh where it is, of the first material, which is not there.
    pub(crate) fn of_mesh(mesh: Mesh) -> Self {
        use super::Transform;
        use crate::math::{Affine3A, MaterialId, MeshId};
        let transform = Transform::new(Affine3A::IDENTITY);
        let instance = Instance { mesh: MeshId(0), material: MaterialId(0), transform };
        Self { meshes: vec![Arc::new(mesh)], instances: vec![instance], ..Self::default() }
    }
}
