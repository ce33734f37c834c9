//! A kd-tree as a hierarchy of boxes: its cells.

use crate::accel::kd::layout::{Compact, Nodes, View};
use crate::accel::kd::tree::split_cell;
use crate::accel::narrowing::Hierarchy;
use crate::math::{Aabb, NodeId};

/// A node and its cell, as far as that lies in the root's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The node.
    pub node: NodeId,
    /// The box.
    pub bounds: Aabb,
}

/// The cells of a tree. A node does not know its own: that is found on the way down.
#[derive(Clone, Copy)]
pub struct Cells<'a>(pub &'a Compact);

impl Hierarchy for Cells<'_> {
    type Place = Cell;

    #[inline(always)]
    fn bounds(&self, cell: Cell) -> Aabb {
        cell.bounds
    }

    #[inline(always)]
    fn children(&self, cell: Cell) -> Option<[Cell; 2]> {
        let View::Inner { axis, split, children } = self.0.view(cell.node) else { return None };
        let [low, high] = split_cell(&cell.bounds, axis, split);
        Some([Cell { node: children[0], bounds: low }, Cell { node: children[1], bounds: high }])
    }

    #[inline(always)]
    fn is_empty(&self, cell: Cell) -> bool {
        matches!(self.0.view(cell.node), View::Leaf(leaf) if leaf.is_empty())
    }
}
