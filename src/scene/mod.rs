//! Scenes: meshes placed by instances, materials with textures, lights and cameras.

mod alpha;
mod choice;
pub mod defaults;
mod digest;
mod environment;
mod error;
pub mod generate;
pub mod gltf;
mod instance;
mod layered_point;
mod light_choice;
mod lights;
mod load;
mod material;
mod material_layers;
pub mod npy;
pub mod obj;
mod placement;
pub mod ply;
mod repair;
mod shading_normal;
mod sky;
mod surface;
mod survey;
mod texture;
mod texture_file;
mod texture_image;
mod texture_range;
pub mod toml;
mod triangles;
mod triangulate;
mod uri;
mod world;

use std::sync::Arc;

pub use alpha::AlphaFilter;
pub use choice::chosen;
pub use environment::{EnvironmentImage, EnvironmentSource};
pub use error::{Broken, LoadError};
pub use instance::{Instance, Transform};
pub use light_choice::{LightChoice, UnknownChoice};
pub use lights::{LightSample, Lights};
pub use load::{LoadOptions, MissingTexture, load, read_file};
pub use material::{AlphaMode, Material, TextureRef, Volume};
pub use material_layers::MaterialLayers;
pub use sky::{Sky, sun_direction};
pub use surface::{Attributes, Surface};
pub use survey::Survey;
pub use texture::{ColorSpace, Filter, Texture, Wrap, srgb_to_linear};
pub use texture_file::ImageError;
pub use texture_image::{Image, Texels};
pub use triangles::Triangles;
pub use world::World;

use crate::camera::Camera;
use crate::geom::Mesh;
use crate::light::{Environment, Punctual};

/// A camera and what the file calls it.
#[derive(Clone, Debug)]
pub struct NamedCamera {
    /// The file's name for it, or empty.
    pub name: String,
    /// Width over height that the file asks for.
    pub aspect: Option<f32>,
    /// The camera.
    pub camera: Camera,
}

/// Something that the file asks for and that is not honoured, or that looks like a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// File and place in it: a line, or a JSON pointer.
    pub place: String,
    /// What is the matter.
    pub message: String,
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
#[derive(Debug, Default)]
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
    /// What shines from infinitely far away.
    pub environment: Option<Environment>,
    /// Cameras in the file's order.
    pub cameras: Vec<NamedCamera>,
    /// What could not be honoured.
    pub notices: Vec<Notice>,
    /// What else the file holds.
    pub contents: Contents,
}
