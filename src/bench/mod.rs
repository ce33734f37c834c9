//! Ray sets to measure and compare structures with.

pub mod ray_sets;
