//! The choice among builders.

use super::parts::Cutter;
use super::{BinaryTree, binned, early, objects, prims, refine, sah, sbvh, sweep};
use crate::accel::{BuildInput, OptionSpec, Phases, Steps, Value, Values};
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
pub fn build_tree_by(input: &BuildInput<'_>, costs: sah::Costs, phases: &mut Phases) -> BinaryTree {
    let builder = input.options.choice("build");
    let tree = build_tree(&*input.source, builder, costs, (phases, input.steps));
    if input.options.choice("refine") == "off" {
        return tree;
    }
    let refined = refine::refine(tree, input.steps);
    phases.end("refinement");
    refined
}

/// Builds a binary tree by the builder of that name.
///
/// The tree does not depend on the number of threads.
pub fn build_tree(
    source: &dyn TriangleSource,
    builder: &str,
    costs: sah::Costs,
    (phases, steps): (&mut Phases, &Steps<'_>),
) -> BinaryTree {
    let mut prims = prims::make_prims(source);
    let cutter = match builder {
        // None for scenes that can't be cut: they are built from whole triangles.
        "esc" | "sbvh" => Cutter::new(source, objects::find_bounds(&prims).0),
        _ => None,
    };
    phases.end("boxes");
    let tree = match (builder, &cutter) {
        ("sweep", _) => sweep::build(&prims, costs, steps),
        ("sbvh", Some(cutter)) => sbvh::build(std::mem::take(&mut prims), cutter, costs, steps),
        ("esc", Some(cutter)) => {
            prims = early::split(prims, cutter);
            phases.end("early splits");
            BinaryTree { parts: Some(cutter.parts()), ..binned::build(&mut prims, costs, steps) }
        }
        _ => binned::build(&mut prims, costs, steps),
    };
    // The builder gives its memory back; that takes time too.
    drop((prims, cutter));
    phases.end("tree");
    tree
}
