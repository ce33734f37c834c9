//! What light a path brings back.
//!
//! The integrator sees one vertex of a path at a time: a ray and what it hit go in, the shadow ray
//! to a light and the ray to go on with come out. Who traces them, and how many together, is decided
//! one floor up, in [`crate::render`].

mod interior;
mod passes;
mod path;
mod weight;

pub use path::{FirstHit, Path, PathSample, PathTracer, ShadowRay, Step, Transport};
