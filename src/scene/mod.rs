//! What a scene is: meshes placed by instances, materials with textures, lights and cameras.

mod at_times;
pub mod defaults;
mod digest;
pub(crate) mod frustum;
mod instance;
mod material;
mod material_layers;
mod memory;
mod motion;
pub mod placement;
mod scattering;
#[allow(clippy::module_inception)] // what a reader looks for
mod scene;
mod survey;
mod texture_ref;
mod triangles;
mod volume;

pub use digest::are_comparable;
pub use instance::{Instance, Transform};
pub use material::{AlphaMode, DEFAULT_GREY, Material};
pub use material_layers::MaterialLayers;
pub use memory::SceneMemory;
pub use motion::{MovingLight, SceneMotion};
pub use scattering::{ScatterColor, Scattering};
pub use scene::{ClipPlanes, Contents, NamedCamera, Notice, Scene, UsedExtension};
pub use survey::Survey;
pub use texture_ref::TextureRef;
pub use triangles::{TooManyPlacements, Triangles};
pub use volume::Volume;
