//! BSDFs in lanes: those that most paths meet, for as many paths at once as a vector has lanes.
//!
//! They have the bits of the BSDFs beside which they stand; a test holds them to that.

mod bsdf;
mod lambert;
mod metallic_roughness;

pub use bsdf::{BSDF_ROWS, BsdfLanes, BsdfRows, BsdfSamples};
pub use lambert::LambertLanes;
pub(super) use metallic_roughness::MIN_SPECULAR_PROBABILITY;
pub use metallic_roughness::MetallicRoughnessLanes;
