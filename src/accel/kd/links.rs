//! Links from the faces of leaves to what lies behind them.

use super::layout::{Compact, Nodes, Packed};
use super::tree::{KdTree, LeafId, Node, halves};
use super::walk::leaf_by_leaf::Next;
use crate::accel::Event;
use crate::math::{Aabb, NodeId};

/// A leaf's place among its neighbours.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Place {
    cell: Aabb,
    /// Per axis, what is behind the lower and the upper face.
    links: [[NodeId; 2]; 3],
}

/// Neighbour links, or ropes: one node a face, the deepest that covers all of it. A leaf is a
/// direct link, an inner node an indirect one.
///
/// - D. MacDonald, K. Booth, "Heuristics for ray tracing using space subdivision", 1990.
/// - V. Havran, J. Bittner, J. Žára, "Ray tracing with rope trees", 1998.
/// - S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007:
///   made on the way down, each link pushed down as far as it goes.
#[derive(Debug)]
pub struct Ropes {
    places: Vec<Place>,
}

impl Next for Ropes {
    const EVENT: Option<Event> = None;

    fn new(tree: &KdTree) -> Self {
        Self { places: places(tree, Covering::Deepest) }
    }

    #[inline(always)]
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact {
        main
    }

    #[inline(always)]
    fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.places[leaf.index()].cell
    }

    #[inline(always)]
    fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.places[leaf.index()].links[axis][side]
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        vec![("links", size_of_val(&*self.places))]
    }
}

/// Rope trees: each indirect link replaced by a tree of those leaves only that touch the face.
///
/// - V. Havran, J. Bittner, J. Žára, "Ray tracing with rope trees", 1998.
///
/// The planes of such a tree are those of the kd-tree that cross the face, so it has two axes.
/// The first nodes of the array are the leaves themselves, for direct links to lead to.
#[derive(Debug)]
pub struct RopeTrees {
    places: Vec<Place>,
    trees: Compact,
}

impl Next for RopeTrees {
    const EVENT: Option<Event> = None;

    fn new(tree: &KdTree) -> Self {
        let mut places = places(tree, Covering::Deepest);
        let leaf = |node: &Node| match *node {
            Node::Leaf(leaf) => Some(Packed::leaf(leaf)),
            Node::Inner { .. } => None,
        };
        let mut nodes: Vec<Packed> = tree.nodes.iter().filter_map(leaf).collect();
        for place in &mut places {
            for axis in 0..3 {
                for side in 0..2 {
                    let link = &mut place.links[axis][side];
                    if *link != NodeId::NONE {
                        *link = match tree.nodes[link.index()] {
                            Node::Leaf(leaf) => NodeId::from_index(leaf.index()),
                            Node::Inner { .. } => {
                                let face = Face { cell: place.cell, axis, side };
                                let root = NodeId::from_index(nodes.len());
                                face.touch(tree, *link, &mut nodes);
                                root
                            }
                        };
                    }
                }
            }
        }
        Self { places, trees: Compact::from_packed(nodes) }
    }

    #[inline(always)]
    fn nodes<'a>(&'a self, _: &'a Compact) -> &'a Compact {
        &self.trees
    }

    #[inline(always)]
    fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.places[leaf.index()].cell
    }

    #[inline(always)]
    fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.places[leaf.index()].links[axis][side]
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        vec![("links", size_of_val(&*self.places)), ("rope trees", self.trees.bytes())]
    }
}

/// Links for packets: one node a face, all that lies behind it, not pushed down at all.
///
/// S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007. Each
/// is the sibling of an ancestor of the leaf, or of the leaf itself.
#[derive(Debug)]
pub struct PacketRopes {
    places: Vec<Place>,
    /// Depths of all nodes.
    depths: Vec<u8>,
}

impl PacketRopes {
    /// Derives them from a tree, of at most 255 levels.
    pub fn new(tree: &KdTree) -> Self {
        let mut depths = vec![0; tree.nodes.len()];
        tree.for_each_cell(KdTree::SPACE, |at, _, depth| depths[at.index()] = depth as u8);
        Self { places: places(tree, Covering::Highest), depths }
    }

    /// A leaf's cell; planes at the rim are infinite.
    #[inline(always)]
    pub fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.places[leaf.index()].cell
    }

    /// The node behind the lower (0) or upper (1) face along an axis; [`NodeId::NONE`] at the rim.
    #[inline(always)]
    pub fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.places[leaf.index()].links[axis][side]
    }

    /// The depth of a node; the root's is 0.
    #[inline(always)]
    pub fn depth(&self, node: NodeId) -> usize {
        usize::from(self.depths[node.index()])
    }

    /// Bytes by part.
    pub fn memory(&self) -> [(&'static str, usize); 2] {
        [("links", size_of_val(&*self.places)), ("depths", size_of_val(&*self.depths))]
    }
}

/// Which of the nodes behind a face that cover all of it a link leads to.
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
    fn cover(&self, tree: &KdTree, mut at: NodeId) -> NodeId {
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
    fn touch(&self, tree: &KdTree, at: NodeId, nodes: &mut Vec<Packed>) {
        let at = self.cover(tree, at);
        match tree.nodes[at.index()] {
            Node::Leaf(leaf) => nodes.push(Packed::leaf(leaf)),
            Node::Inner { axis, split, above } => {
                let (axis, place) = (axis as usize, nodes.len());
                nodes.push(Packed::leaf(LeafId(u32::MAX)));
                let [low, high] = halves(&self.cell, axis, split);
                Face { cell: low, ..*self }.touch(tree, NodeId(at.0 + 1), nodes);
                let above_place = NodeId::from_index(nodes.len());
                Face { cell: high, ..*self }.touch(tree, above, nodes);
                nodes[place] = Packed::inner(axis, split, above_place);
            }
        }
    }
}

/// The places of all leaves, in their order.
fn places(tree: &KdTree, covering: Covering) -> Vec<Place> {
    let mut places = Vec::with_capacity(tree.base.leaves.count());
    let root = Place { cell: KdTree::SPACE, links: [[NodeId::NONE; 2]; 3] };
    let mut todo = vec![(NodeId(0), root)];
    while let Some((at, mut place)) = todo.pop() {
        if covering == Covering::Deepest {
            push_down(tree, &mut place);
        }
        let Node::Inner { axis, split, above } = tree.nodes[at.index()] else {
            // Depth-first order is the order of the leaves.
            places.push(place);
            continue;
        };
        let axis = axis as usize;
        let below = NodeId(at.0 + 1);
        let [low, high] = halves(&place.cell, axis, split);
        let (mut low, mut high) = (Place { cell: low, ..place }, Place { cell: high, ..place });
        low.links[axis][1] = above;
        high.links[axis][0] = below;
        todo.push((above, high));
        todo.push((below, low));
    }
    places
}

/// Moves each link down to the deepest node that covers the whole face.
fn push_down(tree: &KdTree, place: &mut Place) {
    for axis in 0..3 {
        for side in 0..2 {
            let link = place.links[axis][side];
            if link != NodeId::NONE {
                let face = Face { cell: place.cell, axis, side };
                place.links[axis][side] = face.cover(tree, link);
            }
        }
    }
}
