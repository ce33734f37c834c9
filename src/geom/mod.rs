//! Meshes and triangles.

pub mod block;
mod clip;
mod mesh;
pub mod slab;
mod source;
mod tangents;
pub mod verdict;

pub use block::{BlockRef, TriangleBlock};
pub use clip::clipped_bounds;
pub use mesh::Mesh;
pub use slab::{SlabRay, own_box};
pub use source::{Triangle, TriangleList, TriangleSource};
pub use tangents::add_tangents;
pub use verdict::{ShearRay, verdict};
