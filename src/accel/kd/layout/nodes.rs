//! What walks see of a layout.

use crate::accel::kd::tree::{KdTree, LeafId};
use crate::math::NodeId;

/// What a walk sees of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Divides its cell.
    Inner {
        /// 0 to 2.
        axis: usize,
        /// Coordinate of the plane.
        split: f32,
        /// Below the plane, and above it.
        children: [NodeId; 2],
    },
    /// Holds triangles.
    Leaf(LeafId),
}

/// The nodes of a tree, in some order and form.
pub trait Nodes: Send + Sync {
    /// The root.
    fn root(&self) -> NodeId;

    /// Reads a node.
    fn view(&self, at: NodeId) -> View;

    /// Bytes of the nodes.
    fn bytes(&self) -> usize;
}

/// A way to lay nodes out.
pub trait Layout: Nodes + Sized {
    /// Lays the nodes of a tree out.
    fn new(tree: &KdTree) -> Self;
}
