//! Light sources: their radiance, and how directions to them are sampled.
//!
//! Three kinds: an [`Environment`] infinitely far away, perhaps with a [`Sun`], [`Punctual`] lights
//! without extent, and triangles that emit ([`sample_triangle`]). Which of them a scene has is
//! known one floor up, in `world`. Where there are many, a [`LightTree`] samples one of them.

mod area;
mod bounds;
mod cone;
mod environment;
mod environment_image;
#[cfg(test)]
mod environment_lanes_tests;
#[cfg(test)]
mod environment_tests;
mod preetham;
mod punctual;
#[cfg(test)]
mod sampler_tests;
mod sky;
mod sun;
mod tree;

pub use area::{TriangleSample, area_to_solid_angle, sample_triangle};
pub use bounds::{LightBounds, LightSampleContext, Sides};
pub use cone::Cone;
pub use environment::{Environment, EnvironmentSample};
pub use environment_image::EnvironmentSamples;
pub use preetham::Preetham;
pub use punctual::{Illumination, Punctual, PunctualKind};
pub use sky::{Sky, sun_direction};
pub use sun::Sun;
pub use tree::LightTree;
