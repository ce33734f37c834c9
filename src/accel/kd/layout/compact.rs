//! Eight bytes a node, in depth-first order (figure 9b of the review).

use super::{Layout, View};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::math::NodeId;

/// The child below a plane comes right after its parent; the other is named beside the axis.
#[derive(Clone, Debug)]
pub struct Compact {
    nodes: Vec<Packed>,
}

/// An inner node: the split, and the child above shifted left by two beside the axis. A leaf: its
/// number, and a 3.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Packed {
    split: u32,
    above: u32,
}

const LEAF: u32 = 3;

impl Layout for Compact {
    fn new(tree: &KdTree) -> Self {
        let nodes = tree.nodes.iter().map(|node| match *node {
            Node::Inner { axis, split, above } => {
                Packed { split: split.to_bits(), above: above.0 << 2 | u32::from(axis) }
            }
            Node::Leaf(leaf) => Packed { split: leaf.0, above: LEAF },
        });
        Self { nodes: nodes.collect() }
    }

    #[inline(always)]
    fn root(&self) -> NodeId {
        NodeId(0)
    }

    #[inline(always)]
    fn view(&self, at: NodeId) -> View {
        let Packed { split, above } = self.nodes[at.index()];
        if above & 3 == LEAF {
            return View::Leaf(LeafId(split));
        }
        View::Inner {
            axis: (above & 3) as usize,
            split: f32::from_bits(split),
            children: [NodeId(at.0 + 1), NodeId(above >> 2)],
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.nodes)
    }
}
