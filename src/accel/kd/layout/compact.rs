//! Eight bytes a node, in depth-first order (figure 9b of the review).

use super::nodes::{Layout, Nodes, View};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::math::NodeId;
use crate::simd::prefetch;

/// The child below a plane comes right after its parent; the other is named beside the axis.
#[derive(Clone, Debug)]
pub struct Compact {
    nodes: Vec<Packed>,
}

/// An inner node: the split, and the child above shifted left by two beside the axis. A leaf: its
/// number, and a 3.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(8))]
pub struct Packed {
    split: u32,
    above: u32,
}

const LEAF: u32 = 3;

impl Packed {
    /// A leaf.
    pub fn leaf(leaf: LeafId) -> Self {
        Self { split: leaf.0, above: LEAF }
    }

    /// An inner node.
    pub fn inner(axis: usize, split: f32, above: NodeId) -> Self {
        Self { split: split.to_bits(), above: above.0 << 2 | axis as u32 }
    }

    /// What it says if it is the node `at`.
    #[inline(always)]
    pub fn view(self, at: NodeId) -> View {
        let Self { split, above } = self;
        if above & 3 == LEAF {
            return View::Leaf(LeafId(split));
        }
        View::Inner {
            axis: (above & 3) as usize,
            split: f32::from_bits(split),
            children: [NodeId(at.0 + 1), NodeId(above >> 2)],
        }
    }
}

impl Compact {
    /// Nodes that are in order already.
    pub fn from_packed(nodes: Vec<Packed>) -> Self {
        Self { nodes }
    }

    /// Prefetches a node.
    #[inline(always)]
    pub fn prefetch(&self, at: NodeId) {
        prefetch(&self.nodes, at.index(), size_of::<Packed>());
    }

    /// Whether two nodes share a line of the cache, about.
    #[inline(always)]
    pub fn are_close(&self, a: NodeId, b: NodeId) -> bool {
        const NODES: u32 = 64 / size_of::<Packed>() as u32;
        a.0 / NODES == b.0 / NODES
    }
}

impl Layout for Compact {
    fn new(tree: &KdTree) -> Self {
        let nodes = tree.nodes.iter().map(|node| match *node {
            Node::Inner { axis, split, above } => Packed::inner(axis as usize, split, above),
            Node::Leaf(leaf) => Packed::leaf(leaf),
        });
        Self { nodes: nodes.collect() }
    }
}

impl Nodes for Compact {
    #[inline(always)]
    fn root(&self) -> NodeId {
        NodeId(0)
    }

    #[inline(always)]
    fn view(&self, at: NodeId) -> View {
        self.nodes[at.index()].view(at)
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
    }
}
