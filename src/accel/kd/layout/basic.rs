//! Two child pointers, axis and split: 13 bytes of content in 16 (figure 9a of the review).

use super::nodes::{Layout, Nodes, View};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::math::NodeId;

/// Nodes in depth-first order with both children named.
#[derive(Clone, Debug)]
pub struct Basic {
    nodes: Vec<Full>,
}

#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
struct Full {
    /// The split's bits, or the leaf's number.
    split: u32,
    /// 3 for a leaf.
    axis: u32,
    children: [NodeId; 2],
}

const LEAF: u32 = 3;

impl Layout for Basic {
    fn new(tree: &KdTree) -> Self {
        let nodes = tree.nodes.iter().enumerate().map(|(i, node)| match *node {
            Node::Inner { axis, split, above } => Full {
                split: split.to_bits(),
                axis: u32::from(axis),
                children: [NodeId::from_index(i + 1), above],
            },
            Node::Leaf(leaf) => Full { split: leaf.0, axis: LEAF, children: [NodeId::NONE; 2] },
        });
        Self { nodes: nodes.collect() }
    }
}

impl Nodes for Basic {
    #[inline(always)]
    fn root(&self) -> NodeId {
        NodeId(0)
    }

    #[inline(always)]
    fn view(&self, at: NodeId) -> View {
        let Full { split, axis, children } = self.nodes[at.index()];
        if axis == LEAF {
            return View::Leaf(LeafId(split));
        }
        View::Inner { axis: axis as usize, split: f32::from_bits(split), children }
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
    }
}
