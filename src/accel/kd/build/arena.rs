//! Parts of a tree, to be joined.

use crate::accel::kd::tree::{LeafId, Node, split_cell};
use crate::math::{Aabb, NodeId, PrimId};

/// Nodes in depth-first order, with the lists of their leaves.
#[derive(Clone, Debug, Default)]
pub struct Arena {
    /// The nodes, the part's root first.
    pub nodes: Vec<Node>,
    /// The lists of all leaves, one after the other.
    pub ids: Vec<PrimId>,
    /// Where each leaf's list ends.
    pub ends: Vec<usize>,
}

impl Arena {
    /// Adds a leaf.
    pub fn add_leaf(&mut self, ids: impl Iterator<Item = PrimId>) {
        let before = self.ids.len();
        self.ids.extend(ids);
        let is_empty = self.ids.len() == before;
        self.nodes.push(Node::Leaf(LeafId::new(self.ends.len(), is_empty)));
        self.ends.push(self.ids.len());
    }

    /// Adds a node with its children, which add themselves; both parts at once where `fork` says
    /// so, and either way the result is the same.
    pub fn add_inner(
        &mut self,
        axis: usize,
        split: f32,
        fork: bool,
        below: impl FnOnce(&mut Self) + Send,
        above: impl FnOnce(&mut Self) + Send,
    ) {
        // No negative zero: the distance from an origin in a plane has the sign of the direction.
        let split = split + 0.0;
        let at = self.nodes.len();
        self.nodes.push(Node::Leaf(LeafId(u32::MAX)));
        let above_at;
        if fork {
            let mut part = Self::default();
            rayon::join(|| below(self), || above(&mut part));
            above_at = self.nodes.len();
            self.append(part);
        } else {
            below(self);
            above_at = self.nodes.len();
            above(self);
        }
        self.nodes[at] = Node::Inner { axis: axis as u8, split, above: NodeId(above_at as u32) };
    }

    fn append(&mut self, part: Self) {
        let (nodes, ids, leaves) =
            (self.nodes.len() as u32, self.ids.len(), self.ends.len() as u32);
        self.nodes.extend(part.nodes.into_iter().map(|node| match node {
            Node::Inner { axis, split, above } => {
                Node::Inner { axis, split, above: NodeId(above.0 + nodes) }
            }
            Node::Leaf(leaf) => Node::Leaf(LeafId(leaf.0 + leaves)),
        }));
        self.ids.extend(part.ids);
        self.ends.extend(part.ends.into_iter().map(|end| end + ids));
    }

    /// A leaf's list.
    pub fn list(&self, leaf: LeafId) -> &[PrimId] {
        let begin = leaf.index().checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.ids[begin..self.ends[leaf.index()]]
    }

    /// Calls `visit` with each node, its cell and its depth.
    pub fn for_each_cell(&self, cell: Aabb, mut visit: impl FnMut(Node, &Aabb, usize)) {
        let mut todo = vec![(0, cell, 0)];
        while let Some((at, cell, depth)) = todo.pop() {
            visit(self.nodes[at], &cell, depth);
            if let Node::Inner { axis, split, above } = self.nodes[at] {
                let [low, high] = split_cell(&cell, axis as usize, split);
                todo.push((above.index(), high, depth + 1));
                todo.push((at + 1, low, depth + 1));
            }
        }
    }
}
