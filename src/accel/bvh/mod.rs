//! Bounding volume hierarchies.
//!
//! Builders ([`binned`], [`sweep`], [`early`], [`sbvh`]) make a plain [`BinaryTree`], which
//! structures lay out as they traverse it; one makes [`wide`] trees at once. All boxes are unions
//! of [`crate::geom::own_box`]es, which is what makes culling exact (see [`crate::accel`]), or of
//! boxes of parts of triangles, which [`parts`] makes as good. A finished tree may be refined
//! ([`refine`]).

pub mod binary;
pub mod binned;
mod bins;
mod build;
pub mod early;
mod leaves;
pub mod link;
mod objects;
pub mod packet;
pub mod parts;
mod prims;
pub mod refine;
pub mod sah;
pub mod sbvh;
pub mod spatial;
pub mod sweep;
#[cfg(test)]
mod tests;
mod tree;
pub mod wide;

pub use build::BUILD;
pub use parts::Parts;
pub use tree::{BinaryNode, BinaryTree};
