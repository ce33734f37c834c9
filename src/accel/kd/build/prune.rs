//! Takes back what did not pay.
//!
//! Going down, a builder can't know whether a split that does not pay by itself will pay by those
//! below it: it is patient, and afterwards, from the bottom up, each subtree that costs as much as
//! a leaf with its triangles, or more, becomes that leaf.
//!
//! - L. Breiman et al., "Classification and regression trees", 1984, chapter 3: grow too large a
//!   tree, then prune it upward, rather than find the right rule to stop.

use super::arena::Arena;
use super::sah::Costs;
use crate::accel::kd::tree::{LeafId, Node, split_cell};
use crate::math::{Aabb, NodeId};

/// A tree of which nothing can be taken back any more.
#[derive(Debug)]
pub struct Pruned {
    /// The tree.
    pub arena: Arena,
    /// What a ray costs that crosses the bounds, times their area; infinite if the area is.
    pub cost: f64,
}

impl Pruned {
    /// The cheapest tree that is left of one when subtrees become leaves.
    pub fn new(arena: Arena, bounds: &Aabb, costs: &Costs) -> Self {
        if !bounds.half_area().is_finite() {
            return Self { arena, cost: f64::INFINITY };
        }
        let mut kept = Arena::default();
        let root = Pruner { arena: &arena, costs, kept: &mut kept }.copy_subtree(0, bounds);
        Self { arena: kept, cost: root.cost }
    }

    /// The cheaper of two trees over the same bounds; this one if they cost the same.
    pub fn or_cheaper(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }
}

struct Pruner<'a> {
    arena: &'a Arena,
    costs: &'a Costs,
    kept: &'a mut Arena,
}

/// What is known of a subtree.
struct Subtree {
    /// Its cost, times the area of its cell.
    cost: f64,
    /// It has at least so many different triangles.
    triangles: usize,
}

impl Pruner<'_> {
    /// Copies a subtree, which is no deeper than trees may be.
    fn copy_subtree(&mut self, at: usize, cell: &Aabb) -> Subtree {
        let area = cell.half_area();
        let (nodes, ids, leaves) =
            (self.kept.nodes.len(), self.kept.ids.len(), self.kept.ends.len());
        let (axis, split, above) = match self.arena.nodes[at] {
            Node::Inner { axis, split, above } => (axis, split, above),
            Node::Leaf(leaf) => {
                let list = self.arena.list(leaf);
                self.kept.add_leaf(list.iter().copied());
                let cost = area * self.costs.leaf_cost(list.len());
                return Subtree { cost, triangles: list.len() };
            }
        };
        self.kept.nodes.push(Node::Leaf(LeafId(u32::MAX)));
        let cells = split_cell(cell, axis as usize, split);
        let low = self.copy_subtree(at + 1, &cells[0]);
        let above_at = NodeId(self.kept.nodes.len() as u32);
        let high = self.copy_subtree(above.index(), &cells[1]);
        self.kept.nodes[nodes] = Node::Inner { axis, split, above: above_at };

        let cost = area * self.costs.traversal_cost + low.cost + high.cost;
        let triangles = low.triangles.max(high.triangles);
        if area * self.costs.leaf_cost(triangles) > cost {
            return Subtree { cost, triangles };
        }
        // The lists of a subtree lie one after the other. They are looked at only where a leaf may
        // be cheaper, which is where they are short.
        let mut all = self.kept.ids[ids..].to_vec();
        all.sort_unstable_by_key(|id| id.0);
        all.dedup();
        let (triangles, leaf) = (all.len(), area * self.costs.leaf_cost(all.len()));
        if leaf > cost {
            return Subtree { cost, triangles };
        }
        self.kept.nodes.truncate(nodes);
        self.kept.ids.truncate(ids);
        self.kept.ends.truncate(leaves);
        self.kept.add_leaf(all.into_iter());
        Subtree { cost: leaf, triangles }
    }
}
