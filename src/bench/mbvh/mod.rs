//! Binary and multi bounding volume hierarchies side by side: the tables of M. Ernst and
//! G. Greiner, "Multi bounding volume hierarchies", 2008, measured.
//!
//! All on the calling thread, in a pool of one. The rays run between random points of the scene's
//! box. The structures of a scene are built first and held against `bvh2`; then passes are timed by
//! turns ([`super::measure::time_interleaved`]), each with a fresh tracer, so that caches begin
//! empty.

mod figures;
mod json;
mod measure;
pub mod paper;
mod structures;
mod tables;
#[cfg(test)]
mod tests;

pub use figures::Scene;
pub use json::to_json;
pub use measure::{MbvhBenchSettings, measure};
pub use tables::{draw_incoherence, draw_scaling, make_tables};
