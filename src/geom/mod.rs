//! Meshes and triangles.

pub mod block;
pub mod bundle;
mod clip;
mod heading;
mod intersect_bundle;
pub mod intersect_triangle;
mod mesh;
pub mod shaft;
pub mod slab;
mod source;
mod tangents;

pub use block::{BlockRef, TriangleBlock};
pub use bundle::{FilterTriangle, RayBundle};
pub use clip::clip_bounds;
pub use heading::Heading;
pub use intersect_bundle::BundleHits;
pub use intersect_triangle::{ShearRay, intersect_triangle};
pub use mesh::Mesh;
pub use shaft::Shaft;
pub use slab::{SlabRay, own_box};
pub use source::{Corners, Triangle, TriangleList, TriangleSource};
pub use tangents::add_tangents;
