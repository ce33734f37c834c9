//! An offline Monte Carlo path tracer, and a grove of ray-shooting structures behind one trait.
//!
//! A picture is a function of the scene, the settings and the version alone: the acceleration
//! structure, the number of threads and the instruction set change the time that it takes and not
//! one bit of it. Why that holds is told in [`accel`].
//!
//! # From a file to a picture
#![doc = "```"]
#![doc = include_str!("../examples/render.rs")]
#![doc = "```"]
//!
//! # Rays of one's own
#![doc = "```"]
#![doc = include_str!("../examples/rays.rs")]
#![doc = "```"]
//!
//! # Rooms
//! Each room uses only those on floors below its own (`tests/architecture` holds this).
//!
//! | floor | rooms |
//! |---|---|
//! | 9 | `cli`: one file a command |
//! | 8 | `part`: sums of samples as files, and how they add up |
//! | 7 | [`mod@render`]: tiles, streams of paths · `bench` |
//! | 6 | [`integrator`]: the algorithm of path tracing |
//! | 5 | [`world`]: a scene ready to be shaded · [`formats`]: files to scenes · `export`: back |
//! | 4 | [`scene`]: what a scene is · [`generate`]: scenes by rule |
//! | 3 | [`accel`], [`material`], [`medium`], [`light`], [`camera`], [`texture`], [`denoise`] |
//! | 2 | [`geom`] · [`sampling`] · [`film`]: pictures and their comparison |
//! | 1 | `files` · [`math`] · [`motion`]: how things move while the shutter is open · `simd` |
//! | 0 | `names`: choices by name |
//!
//! # Words that are dapple's own
//! - **variant**: a row of the table of structures, [`accel::VARIANTS`]; its id is what `--accel`
//!   takes.
//! - **exact test**: the one ray-triangle test, in `f64`, that alone decides what is hit; all that
//!   stands before it only filters.
//! - **batch**: a slice of rays that are shot together, with a filter of hits and with hints, which
//!   never change a hit (Embree: a stream).
//! - **bundle**: eight rays side by side in the lanes of a vector (Embree: a packet); a *packet*
//!   here is up to 256 rays that walk together.
//! - **world**: a [`Scene`] with its triangles numbered, its lights tabled and its materials
//!   resolved as far as they are the same everywhere.
//! - **own box**: the box of one triangle, in which each of its hits lies.
//! - **block**: 16 samples of a pixel; sums are a tree over blocks, so that parts add up to the
//!   same bits.
//! - **notice**: what a file asks for and is not honoured, or looks like a mistake.
//! - **solid**: a closed mesh that light passes, of a priority where it overlaps others.

pub mod accel;
mod bench;
pub mod camera;
mod cli;
pub mod denoise;
mod export;
mod files;
pub mod film;
pub mod formats;
pub mod generate;
pub mod geom;
pub mod integrator;
pub mod light;
pub mod material;
pub mod math;
pub mod medium;
pub mod motion;
mod names;
mod part;
pub mod render;
pub mod sampling;
pub mod scene;
mod simd;
pub mod texture;
pub mod world;

pub use accel::{
    Accel, AccelSpec, AnyHit, Batch, BuildError, ClosestHit, SpecError, Tracer, VARIANTS, build,
};
pub use camera::Camera;
pub use camera::moving::MovingCamera;
pub use denoise::{DenoiseError, Denoiser};
pub use film::{Comparison, FilmError, Picture, PixelFilter, Tonemap, Window, diff};
pub use formats::{LoadError, LoadOptions, MissingTexture, load};
pub use integrator::Transport;
pub use material::BsdfForm;
pub use names::UnknownName;
pub use render::{
    Aov, Control, Film, NoiseReached, NoiseTarget, Progress, Rendered, Settings, render,
};
pub use sampling::SamplePattern;
pub use scene::{Notice, Scene, TooManyPlacements};
pub use simd::Isa;
pub use world::{LightSamplerKind, ShadingNormals, World};

/// The command `dapple`, with the arguments of the process: what `main` calls.
#[doc(hidden)]
pub fn run_command() -> std::process::ExitCode {
    cli::main()
}

/// What the tests of this crate share with its bench, and what its fuzz targets call.
#[doc(hidden)]
pub mod testing {
    pub use crate::bench::ray_sets::{Random, RaySet, Target};
    pub use crate::part::read_any as read_any_part;
}
