//! A scene made ready to be shaded: surfaces, their scattering, and the lights.

mod alpha;
mod layered_point;
mod light_choice;
mod lights;
mod shading_normal;
mod surface;
#[allow(clippy::module_inception)] // what a reader looks for
mod world;

pub use alpha::AlphaFilter;
pub use light_choice::{LightChoice, UnknownChoice};
pub use lights::{LightSample, Lights};
pub use surface::{Attributes, Surface};
pub use world::World;
