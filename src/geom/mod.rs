//! Meshes and triangles.

pub mod block;
pub mod bundle;
mod clip;
mod mesh;
pub mod shaft;
pub mod slab;
mod source;
mod tangents;
pub mod verdict;
mod verdicts;

pub use block::{BlockRef, TriangleBlock};
pub use bundle::{FilterTriangle, RayBundle};
pub use clip::clipped_bounds;
pub use mesh::Mesh;
pub use shaft::Shaft;
pub use slab::{SlabRay, own_box};
pub use source::{Corners, Triangle, TriangleList, TriangleSource};
pub use tangents::add_tangents;
pub use verdict::{ShearRay, verdict};
pub use verdicts::{Heading, Verdicts};
