//! Clusters of nodes that are likely to be needed together.
//!
//! - S.-E. Yoon, D. Manocha, "Cache-efficient layouts of bounding volume hierarchies", 2006, as
//!   the review tells it (section 6.3): the probability that a node is read is the surface area of
//!   its parent over that of its grandparent; clusters are made to have the largest sum of
//!   probabilities; clusters that are close in space are close in memory.
//!
//! Siblings always lie side by side, so a node needs one pointer and eight bytes. Pairs are
//! clustered greedily, the likeliest next, first into pages and then, within a page, into cache
//! lines; what hangs below a cluster follows in depth-first order. Theirs goes on to smaller and
//! larger blocks to be good for any cache; ours stops at these two sizes.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::nodes::{Layout, Nodes, View};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::math::NodeId;

/// Nodes by pairs of siblings; the root is the second of the first pair.
#[derive(Clone, Debug)]
pub struct Clustered {
    nodes: Vec<Packed>,
}

/// As [`super::compact`]'s, but what is named is the child below, and the one above follows it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(8))]
struct Packed {
    split: u32,
    below: u32,
}

const LEAF: u32 = 3;
/// Pairs of a cache line and of a page.
const LINE: usize = 4;
const PAGE: usize = 256;

/// The pair of a node's children, by how likely it is read once the cluster's first is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pair {
    probability: f64,
    parent: NodeId,
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        // The lower id first of equals.
        self.probability.total_cmp(&other.probability).then(other.parent.cmp(&self.parent))
    }
}

/// Areas of the nodes' cells, and the order in the making.
struct Order<'a> {
    tree: &'a KdTree,
    areas: Vec<f64>,
    /// Parents of pairs, in the order of the layout.
    pairs: Vec<NodeId>,
}

impl Order<'_> {
    fn children(&self, at: NodeId) -> Option<[NodeId; 2]> {
        match self.tree.nodes[at.index()] {
            Node::Inner { above, .. } => Some([NodeId(at.0 + 1), above]),
            Node::Leaf(_) => None,
        }
    }

    /// The likeliest pairs below that of `first`, at most `size`, of those that `allowed` lets in;
    /// and those that hang below them.
    fn cluster(
        &self,
        first: NodeId,
        size: usize,
        allowed: impl Fn(NodeId) -> bool,
    ) -> (Vec<NodeId>, Vec<NodeId>) {
        let mut heap = BinaryHeap::from([Pair { probability: 1.0, parent: first }]);
        let mut members = Vec::with_capacity(size);
        let mut outside = Vec::new();
        while members.len() < size
            && let Some(Pair { probability, parent }) = heap.pop()
        {
            members.push(parent);
            for child in self.children(parent).into_iter().flatten() {
                if self.children(child).is_none() {
                    continue;
                }
                // The pair's parent over its grandparent.
                let share = self.areas[child.index()] / self.areas[parent.index()];
                let share = if share.is_finite() { share } else { 1.0 };
                if allowed(child) {
                    heap.push(Pair { probability: probability * share, parent: child });
                } else {
                    outside.push(child);
                }
            }
        }
        outside.extend(heap.into_iter().map(|pair| pair.parent));
        // Depth-first order, the last to be taken first.
        outside.sort_unstable_by(|a, b| b.cmp(a));
        (members, outside)
    }

    fn run(&mut self) {
        let mut pages = vec![NodeId(0)];
        let mut page_of = vec![0_u32; self.tree.nodes.len()];
        let mut page = 0;
        while let Some(first) = pages.pop() {
            page += 1;
            let (members, outside) = self.cluster(first, PAGE, |_| true);
            pages.extend(outside);
            for member in &members {
                page_of[member.index()] = page;
            }
            let mut line_roots = vec![first];
            while let Some(first) = line_roots.pop() {
                let allowed = |parent: NodeId| page_of[parent.index()] == page;
                let (members, outside) = self.cluster(first, LINE, allowed);
                self.pairs.extend(members);
                line_roots.extend(outside.into_iter().filter(|&parent| allowed(parent)));
            }
        }
    }
}

impl Layout for Clustered {
    fn new(tree: &KdTree) -> Self {
        let mut areas = vec![0.0; tree.nodes.len()];
        tree.for_each_cell(tree.base.bounds, |at, cell, _| areas[at.index()] = cell.half_area());
        let mut order = Order { tree, areas, pairs: Vec::new() };
        if order.children(NodeId(0)).is_some() {
            order.run();
        }

        // The place of each node: the root's first, then two a pair.
        let mut places = vec![0_u32; tree.nodes.len()];
        places[0] = 1;
        for (pair, &parent) in order.pairs.iter().enumerate() {
            for (side, child) in order.children(parent).into_iter().flatten().enumerate() {
                places[child.index()] = (2 * pair + 2 + side) as u32;
            }
        }
        let mut nodes = vec![Packed { split: 0, below: LEAF }; tree.nodes.len() + 1];
        for (at, node) in tree.nodes.iter().enumerate() {
            nodes[places[at] as usize] = match *node {
                Node::Leaf(leaf) => Packed { split: leaf.0, below: LEAF },
                Node::Inner { axis, split, .. } => {
                    Packed { split: split.to_bits(), below: places[at + 1] << 2 | u32::from(axis) }
                }
            };
        }
        Self { nodes }
    }
}

impl Nodes for Clustered {
    #[inline(always)]
    fn root(&self) -> NodeId {
        NodeId(1)
    }

    #[inline(always)]
    fn view(&self, at: NodeId) -> View {
        let Packed { split, below } = self.nodes[at.index()];
        if below & 3 == LEAF {
            return View::Leaf(LeafId(split));
        }
        let child = below >> 2;
        View::Inner {
            axis: (below & 3) as usize,
            split: f32::from_bits(split),
            children: [NodeId(child), NodeId(child + 1)],
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
    }
}
