//! Meshes and triangles.

mod mesh;
mod source;

pub use mesh::Mesh;
pub use source::{Triangle, TriangleList, TriangleSource};
