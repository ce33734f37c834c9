//! The rows of the table.

use super::wide_bvh::WideBvh;
use crate::accel::bvh::build::{BUILD, REFINE};
use crate::accel::bvh::leaves::{CACHE, TRIANGLES};
use crate::accel::flat::Flat;
use crate::accel::{Accel, BuildError, BuildInput, OptionSpec, Options, Value, Values, Variant};

/// Four lanes, as in the paper.
pub const MBVH4: Variant =
    row("mbvh4", "four children a node, leaves of four triangles", |input| {
        Ok(Box::new(WideBvh::<4>::build(input)?))
    });

/// Eight lanes.
pub const MBVH8: Variant =
    row("mbvh8", "eight children a node, leaves of eight triangles", |input| {
        Ok(Box::new(WideBvh::<8>::build(input)?))
    });

/// Sixteen lanes.
pub const MBVH16: Variant =
    row("mbvh16", "sixteen children a node, leaves of sixteen triangles", |input| {
        Ok(Box::new(WideBvh::<16>::build(input)?))
    });

/// What measures best: eight lanes, triangles in the leaves, and a tree that is refined, its leaves
/// as full as the heuristic likes them.
///
/// On an AVX2 machine, by slices of random rays, this is 2.5 to 5 times as fast as `bvh2`. Eight
/// lanes beat four by 10 to 40 % and sixteen, which are two vectors there, by 30 %. Leaves that
/// need not be full are worth 20 % in scenes of long thin triangles and nothing in scans. That they
/// share blocks spares 12 to 18 % of the memory and up to 5 % of the time, and nodes of the least
/// area in all another 2 to 6 % of both (Zen 4, slices of random and bounce rays, one thread).
/// Refinement is worth 20 % where triangles are long and thin, for up to a fifth of the build's
/// time. Spatial splits after that add 10 % in some scenes and take as much in others, for twice
/// the build's time, and are left to `build=sbvh`. Few triangles are faster without a tree
/// (`Flat`): in a box of 32, three times.
///
/// Beside Embree 4 in its default mode, whose hits may leak where ours may not, on a machine with
/// AVX-512 (Zen 4, one thread, geometric mean over scans, a kitchen and two robot cells of 69 to
/// 871 thousand triangles): 1.6 times its rate for slices of random, shadow and bounce rays; ray by
/// ray `mbvh8` has 0.84 and `mbvh4` 0.68.
///
/// Rays of a raster from one point go down the tree sixteen at a time: that is twice as fast as ray
/// by ray, and as fast as `bvh-packet`, which takes a tree of its own.
///
/// Measured and left out: boxes of eight bits (7 to 18 % slower), children by octant in place of
/// distance (`order=octant`: as fast in flight, 5 to 15 % slower ray by ray), any other order in
/// memory (nothing).
pub const AUTO: Variant = Variant {
    id: "auto",
    summary: "what measures best: mbvh8 of a refined tree, leaves as the heuristic likes them",
    paper: "see mbvh8",
    options: &[],
    build: |input| {
        if let Some(flat) = Flat::build(input) {
            return Ok(Box::new(flat));
        }
        let mut tree = build_auto_tree(input, 0)?;
        tree.side_by_side = input.source.boxes() == 0;
        Ok(Box::new(tree))
    },
};

/// The tree of [`AUTO`], with room as in [`WideBvh::build_with_room`].
pub fn build_auto_tree(input: &BuildInput<'_>, room: usize) -> Result<WideBvh<8>, BuildError> {
    let many_boxes = input.source.boxes() > MANY_BOXES;
    let choices =
        if many_boxes { "leaves=shared,build=direct" } else { "leaves=shared,collapse=optimal" };
    let options = Options::parse(MBVH8.id, MBVH8.options, choices);
    let options = &options.expect("declared by its row");
    let input = BuildInput { options, source: input.source.clone(), ..*input };
    WideBvh::<8>::build_with_room(&input, room)
}

/// More placements than this are put into a tree in one pass, which takes half the memory.
const MANY_BOXES: usize = 1_000_000;

const fn row(
    id: &'static str,
    summary: &'static str,
    build: fn(&BuildInput<'_>) -> Result<Box<dyn Accel>, BuildError>,
) -> Variant {
    const OPTIONS: &[OptionSpec] = &[BUILDS, REFINED, COLLAPSE, LEAVES, ORDER, TRIANGLES, CACHE];
    let paper = "Ernst and Greiner, Multi Bounding Volume Hierarchies, 2008";
    Variant { id, summary, paper, options: OPTIONS, build }
}

/// A binary tree's, or none in between.
const BUILDS: OptionSpec = OptionSpec {
    summary: "as for bvh2; or direct: binned in one pass without a binary tree, nor refinement",
    values: Values::Choice(&["binned", "sweep", "esc", "sbvh", "direct"]),
    ..BUILD
};

/// Refined unless said otherwise.
const REFINED: OptionSpec = OptionSpec { default: Value::Choice("on"), ..REFINE };

/// The option that says which nodes of a binary tree become nodes.
const COLLAPSE: OptionSpec = OptionSpec {
    name: "collapse",
    summary: "nodes out of a binary tree's: the largest opened until a node is full, or those of \
              the least area in all",
    values: Values::Choice(&["largest", "optimal"]),
    default: Value::Choice("largest"),
};

/// The option that says how full leaves are.
const LEAVES: OptionSpec = OptionSpec {
    name: "leaves",
    summary: "all full but one, as in the paper, or as the surface area heuristic likes them; \
              shared: those, small ones near each other in one block",
    values: Values::Choice(&["full", "any", "shared"]),
    default: Value::Choice("full"),
};

/// The option that says how a node's children are ordered.
const ORDER: OptionSpec = OptionSpec {
    name: "order",
    summary: "children by distance, or by octants as in the paper; in flight, for nearest hits \
              only",
    values: Values::Choice(&["distance", "octant"]),
    default: Value::Choice("distance"),
};
