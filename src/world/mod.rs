//! A scene made ready to be shaded: surfaces, their scattering, and the lights.
//!
//! [`World`] stands on top; below it are functions over the scene alone: what a material is at a
//! point (`lookup`, `layers`), how a normal is bent (`shading_normal`), what shines (`lights`).

mod alpha;
mod bulge;
mod emitters;
mod in_media;
mod interpolation;
mod lamps;
pub mod lanes;
mod layers;
mod light_sampler;
mod lights;
mod lookup;
mod media;
mod prepared_material;
mod relight;
mod robust;
mod sample_light;
mod shading_normal;
mod surface;
#[allow(clippy::module_inception)] // what a reader looks for
mod world;

pub use alpha::AlphaFilter;
pub use interpolation::{Attributes, Further};
pub use light_sampler::LightSamplerKind;
pub use lights::Lights;
pub use prepared_material::BsdfClass;
pub use robust::ShadingNormals;
pub use sample_light::LightSample;
pub use surface::Surface;
pub use world::World;
