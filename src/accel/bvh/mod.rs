//! Bounding volume hierarchies.
//!
//! Builders ([`binned`], [`sweep`]) make a plain [`BinaryTree`]; structures lay it out as they
//! traverse it and never see a builder. All boxes are unions of [`crate::geom::own_box`]es, which
//! is what makes culling exact (see [`crate::accel`]).

pub mod binary;
pub mod binned;
mod leaves;
mod prims;
pub mod sah;
pub mod sweep;
mod tree;
pub mod wide;

pub use tree::{BinaryNode, BinaryTree};

use crate::geom::TriangleSource;
use std::time::Instant;

/// Builds a binary tree by the builder of that name, and says how long each phase took.
///
/// The tree does not depend on the number of threads.
fn build_tree(
    source: &dyn TriangleSource,
    builder: &str,
    cost: sah::Cost,
) -> (BinaryTree, Vec<(&'static str, f64)>) {
    let start = Instant::now();
    let mut prims = prims::prims(source);
    let gathered = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let tree = match builder {
        "sweep" => sweep::build(&prims, cost),
        _ => binned::build(&mut prims, cost),
    };
    (tree, vec![("boxes", gathered), ("tree", start.elapsed().as_secs_f64())])
}
