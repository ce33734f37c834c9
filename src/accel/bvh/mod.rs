//! Bounding volume hierarchies.
//!
//! Builders ([`binned`], [`sweep`], [`sbvh`]) make a plain [`BinaryTree`]; structures lay it out as
//! they traverse it and never see a builder. All boxes are unions of [`crate::geom::own_box`]es,
//! which is what makes culling exact (see [`crate::accel`]), or of boxes of parts of triangles,
//! which [`parts`] makes as good. A finished tree may be refined ([`refine`]).

pub mod binary;
pub mod binned;
mod bins;
pub mod coherent;
pub mod early;
mod leaves;
mod link;
mod objects;
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

pub use parts::Parts;
pub use tree::{BinaryNode, BinaryTree};

use std::time::Instant;

use parts::Cutter;

use crate::accel::{BuildInput, OptionSpec, Value, Values};
use crate::geom::TriangleSource;

/// The option that names the builder, for `build_tree`.
pub const BUILD: OptionSpec = OptionSpec {
    name: "build",
    summary: "binned SAH, a full sweep, binned after early split clipping, or spatial splits",
    values: Values::Choice(&["binned", "sweep", "esc", "sbvh"]),
    default: Value::Choice("binned"),
};

/// The option that says whether the tree is refined, for `build_tree_by`.
pub const REFINE: OptionSpec = OptionSpec {
    name: "refine",
    summary: "whether subtrees of the finished tree are moved to where boxes get smaller",
    values: Values::Choice(&["off", "on"]),
    default: Value::Choice("off"),
};

/// Builds a binary tree by the options [`BUILD`] and [`REFINE`]; see `build_tree`.
fn build_tree_by(
    input: &BuildInput<'_>,
    cost: sah::Cost,
) -> (BinaryTree, Vec<(&'static str, f64)>) {
    let (mut tree, mut phases) = build_tree(&*input.source, input.options.choice("build"), cost);
    if input.options.choice("refine") == "on" {
        let start = Instant::now();
        tree = refine::refine(tree);
        phases.push(("refinement", start.elapsed().as_secs_f64()));
    }
    (tree, phases)
}

/// Builds a binary tree by the builder of that name, and says how long each phase took.
///
/// The tree does not depend on the number of threads.
fn build_tree(
    source: &dyn TriangleSource,
    builder: &str,
    cost: sah::Cost,
) -> (BinaryTree, Vec<(&'static str, f64)>) {
    let mut phases = Vec::with_capacity(3);
    let mut start = Instant::now();
    let mut phase_ends = |name: &'static str| {
        phases.push((name, start.elapsed().as_secs_f64()));
        start = Instant::now();
    };
    let mut prims = prims::prims(source);
    let cutter = match builder {
        // None for scenes that can't be cut: they are built from whole triangles.
        "esc" | "sbvh" => Cutter::new(source, objects::boxes(&prims).0),
        _ => None,
    };
    phase_ends("boxes");
    let tree = match (builder, &cutter) {
        ("sweep", _) => sweep::build(&prims, cost),
        ("sbvh", Some(cutter)) => sbvh::build(prims, cutter, cost),
        ("esc", Some(cutter)) => {
            prims = early::split(prims, cutter);
            phase_ends("early splits");
            BinaryTree { parts: Some(cutter.parts()), ..binned::build(&mut prims, cost) }
        }
        _ => binned::build(&mut prims, cost),
    };
    phase_ends("tree");
    (tree, phases)
}
