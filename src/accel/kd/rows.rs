//! The rows of the table.

use fearless_simd::Level;

use super::build;
use super::layout::Compact;
use super::links::Ropes;
use super::tree::KdTree;
use super::walk::front_to_back::FrontToBack;
use super::walk::neighbours::Neighbours;
use super::walk::stack::Full;
use super::walk::{Walk, Walked};
use crate::accel::{Accel, BuildError, BuildInput, Options, Variant};

/// A walk over a tree that is there already, so that several can share one.
pub type OverTree = fn(&KdTree, &Options, Level) -> Result<Box<dyn Accel>, BuildError>;

fn walked<W: Walk + 'static>(
    tree: &KdTree,
    level: Level,
    walk: W,
) -> Result<Box<dyn Accel>, BuildError> {
    Ok(Box::new(Walked::new(tree.base.clone(), walk, level, tree.report.clone())))
}

fn build(input: &BuildInput<'_>, over: OverTree) -> Result<Box<dyn Accel>, BuildError> {
    over(&KdTree::build(&input.source, input.options)?, input.options, input.level)
}

fn stack_direction(tree: &KdTree, _: &Options, level: Level) -> Result<Box<dyn Accel>, BuildError> {
    walked(tree, level, FrontToBack::<Compact, Full>::new(tree)?)
}

fn ropes(tree: &KdTree, _: &Options, level: Level) -> Result<Box<dyn Accel>, BuildError> {
    walked(tree, level, Neighbours::<Ropes>::new(tree))
}

/// Declares rows: the constants that [`crate::accel::VARIANTS`] lists, and the same by id for those
/// who have a tree already.
macro_rules! rows {
    ($($(#[$doc:meta])* $name:ident: $id:literal, $options:expr, $over:expr, $summary:literal, $paper:literal;)*) => {
        $(
            $(#[$doc])*
            pub const $name: Variant = Variant {
                id: $id,
                summary: $summary,
                paper: $paper,
                options: $options,
                build: |input| build(input, $over),
            };
        )*

        /// All kd-trees by id.
        pub const OVER: &[(&str, OverTree)] = &[$(($id, $over)),*];
    };
}

rows! {
    /// The textbook's way: a stack of far children. Fast, needs nothing beside the nodes.
    STACK_DIRECTION: "kd-stack-direction", &build::OPTIONS, stack_direction,
        "kd-tree, stack of far children; near and far by the ray's direction",
        "Keller 1997; Wald 2004; review by Hapala and Havran 2011, 3.2";
    /// Links from leaf to leaf: fewer nodes, no stack, some 50 bytes more a leaf.
    ROPES: "kd-ropes", &build::OPTIONS, ropes,
        "kd-tree, links between neighbouring leaves instead of a stack",
        "MacDonald and Booth 1990; Popov et al. 2007; review, 3.3";
}
