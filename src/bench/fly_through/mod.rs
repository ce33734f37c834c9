//! Many rays at once, over flights of a camera: the tables of J. Barczak, "An improved multi-level
//! raytracing algorithm", measured.
//!
//! All on the calling thread, rays made beforehand: traversal alone. A picture is one region, which
//! the tracer enters; its 8 by 8 tiles are slices, which structures narrow for themselves and cut
//! into packets of 16 by 16 rays: the paper's hierarchy. All answers are held against those of
//! `bvh-packet` first; then the structures take turns, picture by picture
//! ([`super::measure::time_interleaved`]).

mod bench;
mod figures;
pub mod frame;
mod json;
mod lights;
mod measure;
mod node_worth;
pub mod paper;
mod structures;
mod tables;
#[cfg(test)]
mod tests;

pub use bench::FlyThroughBenchSettings;
pub use json::to_json;
pub use measure::measure;
pub use tables::{draw_plots, make_tables};
