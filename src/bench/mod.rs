//! Ray sets to measure and compare structures with.

pub mod agreement;
pub mod bars;
pub mod kd;
pub mod ray_sets;
