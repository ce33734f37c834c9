//! Ropes: links from the faces of leaves to what lies behind them.

use super::layout::{Compact, Nodes, Packed};
use super::tree::{KdTree, LeafId, Node, split_cell};
use super::walk::leaf_by_leaf::Next;
use crate::accel::Event;
use crate::math::{Aabb, NodeId};

/// A leaf's cell and its ropes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct RopedLeaf {
    cell: Aabb,
    /// Per axis, what is behind the lower and the upper face.
    ropes: [[NodeId; 2]; 3],
}

/// Ropes, or neighbour links: one node a face, the deepest that covers all of it. A leaf is a
/// direct rope, an inner node an indirect one.
///
/// - D. MacDonald, K. Booth, "Heuristics for ray tracing using space subdivision", 1990.
/// - V. Havran, J. Bittner, J. Žára, "Ray tracing with rope trees", 1998.
/// - S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007:
///   made on the way down, each rope pushed down as far as it goes.
pub type Ropes = RopesTo<false>;

/// Rope trees: each indirect rope replaced by a tree of those leaves only that touch the face.
///
/// - V. Havran, J. Bittner, J. Žára, "Ray tracing with rope trees", 1998.
///
/// The planes of such a tree are those of the kd-tree that cross the face, so it has two axes. The
/// first nodes of the array are the leaves themselves, for direct ropes to lead to.
pub type RopeTrees = RopesTo<true>;

/// Ropes to nodes of the tree, or to trees of their own.
#[derive(Debug)]
pub struct RopesTo<const TREES: bool> {
    leaves: Vec<RopedLeaf>,
    /// Empty if ropes lead to nodes of the tree.
    trees: Compact,
}

impl<const TREES: bool> Next for RopesTo<TREES> {
    const EVENT: Option<Event> = None;

    fn new(tree: &KdTree) -> Self {
        let mut leaves = make_ropes(tree, Covering::Deepest);
        let trees = if TREES { make_trees(tree, &mut leaves) } else { Vec::new() };
        Self { leaves, trees: Compact::from_packed(trees) }
    }

    #[inline(always)]
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact {
        if TREES { &self.trees } else { main }
    }

    #[inline(always)]
    fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.leaves[leaf.index()].cell
    }

    #[inline(always)]
    fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.leaves[leaf.index()].ropes[axis][side]
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        let mut memory = vec![("ropes", size_of_val(&*self.leaves))];
        if TREES {
            memory.push(("rope trees", self.trees.bytes()));
        }
        memory
    }
}

/// Makes the trees of the leaves that touch each face, and ties the ropes to them.
fn make_trees(tree: &KdTree, leaves: &mut [RopedLeaf]) -> Vec<Packed> {
    let pack_leaf = |node: &Node| match *node {
        Node::Leaf(leaf) => Some(Packed::leaf(leaf)),
        Node::Inner { .. } => None,
    };
    let mut nodes: Vec<Packed> = tree.nodes.iter().filter_map(pack_leaf).collect();
    for RopedLeaf { cell, ropes } in leaves {
        for (axis, ropes) in ropes.iter_mut().enumerate() {
            for (side, rope) in ropes.iter_mut().enumerate() {
                if *rope == NodeId::NONE {
                    continue;
                }
                *rope = match tree.nodes[rope.index()] {
                    Node::Leaf(leaf) => NodeId::from_index(leaf.index()),
                    Node::Inner { .. } => {
                        let root = NodeId::from_index(nodes.len());
                        Face { cell: *cell, axis, side }.add_touching(tree, *rope, &mut nodes);
                        root
                    }
                };
            }
        }
    }
    nodes
}

/// Ropes for packets: one node a face, all that lies behind it, not pushed down at all.
///
/// S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007. Each
/// is the sibling of an ancestor of the leaf, or of the leaf itself.
#[derive(Debug)]
pub struct PacketRopes {
    leaves: Vec<RopedLeaf>,
    /// Depths of all nodes.
    depths: Vec<u8>,
}

impl PacketRopes {
    /// Derives them from a tree, of at most 255 levels.
    pub fn new(tree: &KdTree) -> Self {
        let mut depths = vec![0; tree.nodes.len()];
        tree.for_each_cell(KdTree::SPACE, |at, _, depth| depths[at.index()] = depth as u8);
        Self { leaves: make_ropes(tree, Covering::Highest), depths }
    }

    /// A leaf's cell; planes at the rim are infinite.
    #[inline(always)]
    pub fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.leaves[leaf.index()].cell
    }

    /// The node behind the lower (0) or upper (1) face along an axis; [`NodeId::NONE`] at the rim.
    #[inline(always)]
    pub fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.leaves[leaf.index()].ropes[axis][side]
    }

    /// The depth of a node; the root's is 0.
    #[inline(always)]
    pub fn depth(&self, node: NodeId) -> usize {
        usize::from(self.depths[node.index()])
    }

    /// Bytes by part.
    pub fn memory(&self) -> [(&'static str, usize); 2] {
        [("ropes", size_of_val(&*self.leaves)), ("depths", size_of_val(&*self.depths))]
    }
}

/// Which of the nodes behind a face that cover all of it a rope leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Covering {
    Deepest,
    Highest,
}

/// A side of a leaf's cell.
struct Face {
    cell: Aabb,
    axis: usize,
    side: usize,
}

impl Face {
    /// Below `at`, a node behind the face, the deepest node that covers all of it.
    fn find_cover(&self, tree: &KdTree, mut at: NodeId) -> NodeId {
        while let Node::Inner { axis, split, above } = tree.nodes[at.index()] {
            let (axis, below) = (axis as usize, NodeId(at.0 + 1));
            at = if axis == self.axis {
                // The child at the face: beyond an upper one it is the one below.
                if self.side == 1 { below } else { above }
            } else if split <= self.cell.min[axis] {
                above
            } else if split >= self.cell.max[axis] {
                below
            } else {
                break;
            };
        }
        at
    }

    /// Adds the leaves below `at` that touch the face, as a tree.
    fn add_touching(&self, tree: &KdTree, at: NodeId, nodes: &mut Vec<Packed>) {
        let at = self.find_cover(tree, at);
        match tree.nodes[at.index()] {
            Node::Leaf(leaf) => nodes.push(Packed::leaf(leaf)),
            Node::Inner { axis, split, above } => {
                let (axis, place) = (axis as usize, nodes.len());
                nodes.push(Packed::leaf(LeafId(u32::MAX)));
                let [low, high] = split_cell(&self.cell, axis, split);
                Face { cell: low, ..*self }.add_touching(tree, NodeId(at.0 + 1), nodes);
                let above_place = NodeId::from_index(nodes.len());
                Face { cell: high, ..*self }.add_touching(tree, above, nodes);
                nodes[place] = Packed::inner(axis, split, above_place);
            }
        }
    }
}

/// Ties the ropes of all leaves, in their order.
fn make_ropes(tree: &KdTree, covering: Covering) -> Vec<RopedLeaf> {
    let mut leaves = Vec::with_capacity(tree.base.leaves.count());
    let root = RopedLeaf { cell: KdTree::SPACE, ropes: [[NodeId::NONE; 2]; 3] };
    let mut todo = vec![(NodeId(0), root)];
    while let Some((at, mut leaf)) = todo.pop() {
        if covering == Covering::Deepest {
            push_down(tree, &mut leaf);
        }
        let Node::Inner { axis, split, above } = tree.nodes[at.index()] else {
            // Depth-first order is the order of the leaves.
            leaves.push(leaf);
            continue;
        };
        let axis = axis as usize;
        let below = NodeId(at.0 + 1);
        let [low, high] = split_cell(&leaf.cell, axis, split);
        let (mut low, mut high) =
            (RopedLeaf { cell: low, ..leaf }, RopedLeaf { cell: high, ..leaf });
        low.ropes[axis][1] = above;
        high.ropes[axis][0] = below;
        todo.push((above, high));
        todo.push((below, low));
    }
    leaves
}

/// Moves each rope down to the deepest node that covers the whole face.
fn push_down(tree: &KdTree, leaf: &mut RopedLeaf) {
    for axis in 0..3 {
        for side in 0..2 {
            let rope = leaf.ropes[axis][side];
            if rope != NodeId::NONE {
                let face = Face { cell: leaf.cell, axis, side };
                leaf.ropes[axis][side] = face.find_cover(tree, rope);
            }
        }
    }
}
