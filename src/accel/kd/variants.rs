//! The rows of the table.

use fearless_simd::Level;

use super::build::OPTIONS;
use super::layout::{Basic, Clustered, Compact, Layout, Treelet, TreeletFilled};
use super::packet::{Algorithm, PacketKdTree};
use super::ropes::{PacketRopes, RopeTrees, Ropes};
use super::tree::KdTree;
use super::walk::backtrack::{Backtrack, EveryNode, EveryNth};
use super::walk::branchless::Branchless;
use super::walk::front_to_back::{ByDirection, ByOrigin, Classify, FrontToBack};
use super::walk::leaf_by_leaf::{FromRoot, LeafByLeaf};
use super::walk::plane_points::PlanePoints;
use super::walk::prefetch::Prefetch;
use super::walk::todo::{Full, Nothing, Ring, Spill, Todo};
use super::walk::wide::WideWalk;
use super::walk::{Walk, Walked};
use crate::accel::narrowing::PC;
use crate::accel::packet::SIZE;
use crate::accel::{Accel, BuildError, BuildInput, OptionSpec, Options, Value, Values, Variant};

/// A walk over a tree that is there already, so that several can share one.
pub type OverTree = fn(&KdTree, &Options, Level) -> Result<Box<dyn Accel>, BuildError>;

type Built = Result<Box<dyn Accel>, BuildError>;

const fn integer_option(
    name: &'static str,
    summary: &'static str,
    range: [u64; 2],
    default: u64,
) -> OptionSpec {
    let values = Values::Integer(range[0], range[1]);
    OptionSpec { name, summary, values, default: Value::Integer(default) }
}

/// The option of those that walk on every layout.
pub const LAYOUT: OptionSpec = OptionSpec {
    name: "layout",
    summary: "how nodes lie in memory",
    values: Values::Choice(&["compact", "basic", "treelet", "treelet-filled", "clustered"]),
    default: Value::Choice("compact"),
};

const fn options_with(option: OptionSpec) -> [OptionSpec; 6] {
    [OPTIONS[0], OPTIONS[1], OPTIONS[2], OPTIONS[3], OPTIONS[4], option]
}

const WITH_LAYOUT: [OptionSpec; 6] = options_with(LAYOUT);
const WITH_ENTRIES: [OptionSpec; 6] =
    options_with(integer_option("entries", "entries of the short stack", [1, 64], 8));
const WITH_EVERY: [OptionSpec; 6] =
    options_with(integer_option("every", "levels from one box to the next", [1, 32], 4));
const WITH_RAYS: [OptionSpec; 6] =
    options_with(integer_option("rays", "rays in flight", [1, 64], 16));

const WITH_SIZE: [OptionSpec; 6] = options_with(SIZE);
const WITH_SIZE_AND_PC: [OptionSpec; 7] =
    [OPTIONS[0], OPTIONS[1], OPTIONS[2], OPTIONS[3], OPTIONS[4], SIZE, PC];
const WITH_TILES: [OptionSpec; 6] = options_with(OptionSpec {
    name: "tiles",
    summary: "rays along a side of a tile, or divided until it is simple",
    values: Values::Choice(&["adaptive", "16", "8", "4", "2"]),
    default: Value::Choice("adaptive"),
});
/// Options with the defaults that suit vectors: leaves for eight triangles, and cheap tests.
const FOR_WIDE: [OptionSpec; 5] = [
    OPTIONS[0],
    OptionSpec { default: Value::Number(0.1), ..OPTIONS[1] },
    OPTIONS[2],
    OPTIONS[3],
    OptionSpec { default: Value::Integer(8), ..OPTIONS[4] },
];

fn build(input: &BuildInput<'_>, over: OverTree) -> Built {
    over(&KdTree::build(&input.source, input.options, input.steps)?, input.options, input.level)
}

fn box_walk<W: Walk + 'static>(tree: &KdTree, level: Level, walk: W) -> Box<dyn Accel> {
    Box::new(Walked::new(tree, walk, level))
}

/// Calls a function that is generic over layouts with the one that was chosen.
macro_rules! in_layout {
    ($function:ident::<$($policy:ty),*>($tree:expr, $options:expr, $level:expr)) => {
        match $options.choice("layout") {
            "basic" => $function::<Basic, $($policy),*>($tree, $level),
            "treelet" => $function::<Treelet, $($policy),*>($tree, $level),
            "treelet-filled" => $function::<TreeletFilled, $($policy),*>($tree, $level),
            "clustered" => $function::<Clustered, $($policy),*>($tree, $level),
            _ => $function::<Compact, $($policy),*>($tree, $level),
        }
    };
}

fn build_stack<L: Layout + 'static, K: Classify + 'static>(tree: &KdTree, level: Level) -> Built {
    Ok(box_walk(tree, level, FrontToBack::<L, K, Full>::new(tree, 0)?))
}

fn build_plane_points<L: Layout + 'static>(tree: &KdTree, level: Level) -> Built {
    Ok(box_walk(tree, level, PlanePoints::<L>::new(tree)?))
}

fn build_branchless<L: Layout + 'static>(tree: &KdTree, level: Level) -> Built {
    Ok(box_walk(tree, level, Branchless::<L>::new(tree)?))
}

fn build_with_todo<T: Todo + 'static>(tree: &KdTree, level: Level, entries: usize) -> Built {
    Ok(box_walk(tree, level, FrontToBack::<Compact, ByDirection, T>::new(tree, entries)?))
}

/// Packets, of the size that was chosen.
fn build_packets(tree: &KdTree, algorithm: Algorithm, options: &Options, level: Level) -> Built {
    Ok(Box::new(PacketKdTree::new(tree, algorithm, options.integer("size"), level)?))
}

fn build_tiles(tree: &KdTree, options: &Options, level: Level) -> Built {
    let side = options.choice("tiles").parse();
    let algorithm = Algorithm::EntryPoint { adaptive: side.is_err() };
    Ok(Box::new(PacketKdTree::new(tree, algorithm, side.unwrap_or(16), level)?))
}

fn read_entries(options: &Options) -> usize {
    options.integer("entries") as usize
}

/// A row's walk by packets.
macro_rules! packets {
    ($algorithm:expr) => {
        |tree, options, level| build_packets(tree, $algorithm, options, level)
    };
}

/// Declares rows: the constants that [`crate::accel::VARIANTS`] lists, and the same by id for
/// those who have a tree already.
macro_rules! rows {
    ($($(#[$doc:meta])* $name:ident: $id:literal, $options:expr, $over:expr,
       $summary:literal, $paper:literal;)*) => {
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
        pub static OVER: &[(&str, OverTree)] = &[$(($id, $over)),*];
    };
}

rows! {
    /// Finds each leaf from the root. Needs no stack, only the leaves' boxes, and visits the most
    /// nodes of all: the measure of what the others save. Ours moves on by distances, not by an
    /// epsilon, so it can't loop.
    SEQUENTIAL: "kd-sequential", &OPTIONS,
        |tree, _, level| Ok(box_walk(tree, level, LeafByLeaf::<FromRoot>::new(tree))),
        "kd-tree, every leaf found anew from the root; no stack",
        "Kaplan 1985; review by Hapala and Havran 2011, 3.1";
    /// A stack of far children; the near child is the one with the ray's origin. Ours is correct
    /// with the origin in a plane. Take it to compare; direction is as good and simpler.
    STACK_ORIGIN: "kd-stack-origin", &WITH_LAYOUT,
        |tree, options, level| in_layout!(build_stack::<ByOrigin>(tree, options, level)),
        "kd-tree, stack of far children; near and far by the ray's origin",
        "Jansen 1986; Arvo 1988; review, 3.2";
    /// The textbook's way: a stack of far children, the near child by the sign of the direction.
    /// Needs nothing beside the nodes. Take it where memory is scarce.
    STACK_DIRECTION: "kd-stack-direction", &WITH_LAYOUT,
        |tree, options, level| in_layout!(build_stack::<ByDirection>(tree, options, level)),
        "kd-tree, stack of far children; near and far by the ray's direction",
        "Keller 1997; Wald 2004; review, 3.2";
    /// Havran's TA-rec-B: children by coordinates of points on planes, kept on the stack; two
    /// branches a node and a distance only where both children are crossed. Needs a larger stack.
    STACK_ROBUST: "kd-stack-robust", &WITH_LAYOUT,
        |tree, options, level| in_layout!(build_plane_points::<>(tree, options, level)),
        "kd-tree, stack of points on planes (TA-rec-B): two comparisons a node",
        "Havran et al. 1997; Havran 2000; review, 3.2";
    /// Writes both children and moves the stack pointer by comparisons: no branch to mispredict,
    /// but each step waits for the store before it. Pays on hardware without branch prediction.
    BRANCHLESS: "kd-branchless", &WITH_LAYOUT,
        |tree, options, level| in_layout!(build_branchless::<>(tree, options, level)),
        "kd-tree, stack pointer moved by comparisons instead of branches",
        "Hapala 2009; review, 5.5";
    /// Links from leaf to leaf: the fewest nodes, no stack, some 50 bytes more a leaf.
    ROPES: "kd-ropes", &OPTIONS,
        |tree, _, level| Ok(box_walk(tree, level, LeafByLeaf::<Ropes>::new(tree))),
        "kd-tree, links between neighbouring leaves instead of a stack",
        "MacDonald and Booth 1990; Popov et al. 2007; review, 3.3";
    /// Links lead to small trees of just the leaves at a face: fewer nodes again than ropes, for
    /// much more memory and a longer build.
    ROPE_TREES: "kd-rope-trees", &OPTIONS,
        |tree, _, level| Ok(box_walk(tree, level, LeafByLeaf::<RopeTrees>::new(tree))),
        "kd-tree, links to trees of the leaves that touch a face",
        "Havran, Bittner and Zara 1998; review, 3.3";
    /// Begins at the root after every leaf: constant memory and nothing derived, twice the nodes.
    RESTART: "kd-restart", &OPTIONS,
        |tree, _, level| build_with_todo::<Nothing<false>>(tree, level, 0),
        "kd-tree, begun again at the root after every leaf",
        "Foley and Sugerman 2005; review, 5.1";
    /// Goes up by parents until a box goes on, then down: fewer nodes than restart, 32 bytes more
    /// for every node.
    BACKTRACK: "kd-backtrack", &OPTIONS,
        |tree, _, level| Ok(box_walk(tree, level, Backtrack::<EveryNode>::new(tree, 1))),
        "kd-tree, back up by parents and boxes in every node",
        "Foley and Sugerman 2005; review, 5.1.1";
    /// The same with boxes on every Nth level: most of the gain for a fraction of the memory.
    SPARSE_BOXES: "kd-sparse-boxes", &WITH_EVERY,
        |tree, options, level| {
            let every = options.integer("every") as usize;
            Ok(box_walk(tree, level, Backtrack::<EveryNth>::new(tree, every)))
        },
        "kd-tree, back up by parents and boxes on some levels",
        "Havran and Bittner 2007; review, 5.1.2";
    /// Restart from the deepest node that holds all that is left of the ray.
    PUSH_DOWN: "kd-push-down", &OPTIONS,
        |tree, _, level| build_with_todo::<Nothing<true>>(tree, level, 0),
        "kd-tree, begun again at the deepest node that holds the rest of the ray",
        "Horn et al. 2007; review, 5.2";
    /// A stack of a few entries that forgets the oldest; push-down when it runs empty. As good as a
    /// full stack in less memory a ray, which only matters where memory a ray is dear.
    SHORT_STACK: "kd-short-stack", &WITH_ENTRIES,
        |tree, options, level| build_with_todo::<Ring>(tree, level, read_entries(options)),
        "kd-tree, short stack that forgets, and push-down",
        "Horn et al. 2007; review, 5.4";
    /// A short stack whose oldest entries spill to a large one: no restarts.
    SPILL: "kd-spill", &WITH_ENTRIES,
        |tree, options, level| build_with_todo::<Spill>(tree, level, read_entries(options)),
        "kd-tree, short stack that spills into a large one",
        "Novak 2009; review, 5.4";
    /// Several rays of a slice in flight, a line of nodes each in turn: hides memory latency in
    /// large trees. Twice the rate of the plain stack on a scanned dragon of 870,000 triangles, 1.1
    /// to 1.4 where most rays cross empty space. Wants slices of 64 rays or more; a single ray
    /// gains nothing.
    PREFETCH: "kd-prefetch", &WITH_RAYS,
        |tree, options, level| {
            Ok(Box::new(Prefetch::new(tree, options.integer("rays") as usize, level)?))
        },
        "kd-tree, several rays in flight to hide memory latency",
        "Benthin et al. 2006; Bittner et al. 2009; review, 6.4";
    /// Rays side by side walk together; a node is decided on once for all. For primary rays.
    PACKET: "kd-packet", &WITH_SIZE,
        packets!(Algorithm::Packet),
        "kd-tree, packets of up to 16 by 16 rays side by side",
        "Wald et al. 2001; review, 4.2 and 4.6";
    /// The same without a stack: links to all that is behind a face, where packets regroup.
    PACKET_ROPES: "kd-packet-ropes", &WITH_SIZE,
        |tree, options, level| {
            build_packets(tree, Algorithm::Ropes(PacketRopes::new(tree)), options, level)
        },
        "kd-tree, packets by links that are not pushed down; rays put to rest and woken again",
        "Popov et al. 2007; review, 5.3";
    /// Packets of rays that go any way; no early end.
    OMNIDIRECTIONAL: "kd-omnidirectional", &WITH_SIZE,
        packets!(Algorithm::Mixed { by_origin: false }),
        "kd-tree, packets of rays that go any way, near and far by each ray's direction",
        "Reshetov 2006; review, 4.7";
    /// The same for rays that fan out from one point.
    OMNIDIRECTIONAL_ORIGIN: "kd-omnidirectional-origin", &WITH_SIZE,
        packets!(Algorithm::Mixed { by_origin: true }),
        "kd-tree, packets of rays that go any way, near and far by each ray's origin",
        "Tsakok et al. 2008; review, 4.7";
    /// Four corners go through the tree for all rays of a packet that starts at one point.
    LCTS: "kd-lcts", &WITH_SIZE,
        packets!(Algorithm::Sequence { culls: false }),
        "kd-tree, packets behind their four corners, along the longest common traversal sequence",
        "Havran and Bittner 2000; review, 4.1";
    /// The same, and triangles that the corners show to be missed are not tested.
    RELEVANT_TRIANGLES: "kd-relevant-triangles", &WITH_SIZE,
        packets!(Algorithm::Sequence { culls: true }),
        "kd-tree, packets behind their four corners, which cull triangles as well",
        "Dmitriev et al. 2004; review, 4.3";
    /// Packets start at the deepest node that holds all leaves that matter.
    ENTRY_POINT: "kd-entry-point", &WITH_TILES, build_tiles,
        "kd-tree, packets from the deepest node that holds all leaves their shaft meets",
        "Reshetov et al. 2005; Fowler et al. 2009; review, 4.4 and 4.5";
    /// Packets in a tree of those nodes alone that a slice's shaft meets both sides of.
    PATH_COMPRESSION: "kd-path-compression", &WITH_SIZE_AND_PC,
        |tree, options, level| {
            let recursive = options.choice("pc") == "recursive";
            build_packets(tree, Algorithm::Compressed { recursive }, options, level)
        },
        "kd-tree, packets over a tree of those nodes alone that a slice's shaft meets both \
         sides of",
        "Barczak, An Improved Multi-Level Raytracing Algorithm, 3.4 and 5.1";
    /// Three levels at a step, by vector instructions: not in the review. Two to three times as
    /// fast as the plain stack, for two to three times its memory, since leaves store their
    /// triangles. Take it whenever it is speed that counts.
    WIDE: "kd-wide", &FOR_WIDE,
        |tree, _, level| Ok(Box::new(WideWalk::new(tree, level)?)),
        "kd-tree, three levels at a step by vector instructions",
        "Havran 1999; Szecsi 2003; Ernst and Greiner 2008";
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::VARIANTS;

    #[test]
    fn every_row_is_in_the_table() {
        let listed: Vec<_> =
            VARIANTS.iter().map(|v| v.id).filter(|id| OVER.iter().any(|o| o.0 == *id)).collect();
        let all: Vec<_> = OVER.iter().map(|(id, _)| *id).collect();
        assert_eq!(listed, all);
        assert_eq!(all.len(), 23);
    }
}
