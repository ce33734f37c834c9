//! BSDFs in lanes: those that most paths meet, for as many paths at once as a vector has lanes.
//!
//! They are the one form of the BSDFs beside which they stand, whose single rays are one lane; a
//! test holds all widths to the same bits.

mod absorption;
mod boundary;
mod bsdf;
mod lambert;
mod metallic_roughness;
mod smooth_glass;

pub use absorption::transmittance;
pub(super) use boundary::{SmoothBoundary, reflection_probability};
pub use bsdf::{BSDF_ROWS, BsdfLanes, BsdfRows, BsdfSamples};
pub use lambert::LambertLanes;
pub(super) use metallic_roughness::MIN_SPECULAR_PROBABILITY;
pub use metallic_roughness::MetallicRoughnessLanes;
pub use smooth_glass::SmoothGlassLanes;
