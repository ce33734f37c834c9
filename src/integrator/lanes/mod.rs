//! A vertex of many paths at once.
//!
//! The steps of [`PathTracer::advance`](super::PathTracer::advance) in the same order, for paths
//! that have met surfaces of one class: such as neither emit nor have layers, and scatter by one
//! BSDF. Arithmetic is done for all lanes at once and has the bits of `advance`; a test holds it to
//! that. Paths that turn out to need more are left to `advance`.
//!
//! | file | what it does |
//! |---|---|
//! | `shade` | the steps of a vertex, in order |
//! | `vertices` | the paths of a slice, and the rows that a block of them is computed from |
//! | `direct` | asks for the light that falls on a vertex |
//! | `scatter` | takes paths on in the directions that their BSDFs have chosen |
//! | `solids` | the solid that a path is inside of, and what it absorbs |
//! | `environment` | light for paths that leave the scene |

mod direct;
mod environment;
mod leaving;
mod scatter;
mod shade;
mod solids;
mod vertices;

pub use environment::add_environment_in_lanes;
pub use shade::shade_in_lanes;
pub use vertices::Vertices;
