//! Light sources: what they send where, and how a point to be lit chooses a direction to them.
//!
//! Three kinds: an [`Environment`] infinitely far away, which may have a [`Sun`], [`Punctual`] lights without extent, and
//! triangles that emit ([`sample_triangle`]). Which of them a scene has, and with what probability
//! each is chosen, is known one floor up, in [`crate::scene`].

mod area;
mod environment;
mod preetham;
mod punctual;
mod sun;

pub use area::{TriangleSample, area_to_solid_angle, sample_triangle};
pub use environment::{Environment, EnvironmentSample};
pub use preetham::Preetham;
pub use punctual::{Illumination, Punctual, PunctualKind};
pub use sun::Sun;
