//! An offline Monte Carlo path tracer, and a grove of ray-shooting structures behind one trait.
//!
//! The layers, each of which uses only those below it (`tests/architecture.rs` holds this):
//!
//! | floor | modules |
//! |---|---|
//! | 7 | `cli` |
//! | 6 | [`render`], [`mod@bench`] |
//! | 5 | [`integrator`] |
//! | 4 | [`world`], [`formats`] |
//! | 3 | [`scene`], [`generate`] |
//! | 2 | [`accel`], [`material`], [`light`], [`camera`], [`texture`] |
//! | 1 | [`geom`], [`sampling`], [`film`] |
//! | 0 | [`files`], [`math`], [`names`], [`simd`] |
//!
//! A picture is a function of the scene, the settings and the version alone: the acceleration
//! structure, the number of threads and the instruction set change the time that it takes and not
//! one bit of it. Why that holds is told in [`accel`].

pub mod accel;
pub mod bench;
pub mod camera;
pub mod cli;
pub mod files;
pub mod film;
pub mod formats;
pub mod generate;
pub mod geom;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod names;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod simd;
pub mod texture;
pub mod world;
