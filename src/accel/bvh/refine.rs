//! Refinement of a finished tree: subtrees move to where they make boxes smaller.
//!
//! D. Meister and J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization",
//! 2018. In each round the best new places of the largest nodes are sought by branch and bound, all
//!    at once; then the moves are made one by one, the best first, but for those that touch what
//!    was touched in the round before them. Leaves move as they are: full ones stay full. Searches
//!    only read and moves are in a total order, so that the threads do not show.

use rayon::prelude::*;

use super::{BinaryNode, BinaryTree, sah};
use crate::accel::Steps;
use crate::math::Aabb;

/// Twice as many rounds give one percent more.
const ROUNDS: usize = 8;
/// One in so many nodes is looked at in a round, the largest. All would give one percent more.
const SHARE: usize = 6;

/// A node; the two children of one are neighbours.
#[derive(Clone, Copy)]
struct Pair {
    bounds: Aabb,
    /// The first child of two, or a leaf's first place.
    first: u32,
    /// Triangles of a leaf, zero of an inner node.
    count: u32,
}

/// Nodes with siblings side by side: the root, then pairs.
struct Pairs {
    nodes: Vec<Pair>,
    parents: Vec<u32>,
}

/// A move of a subtree to the place beside another.
#[derive(Clone, Copy)]
struct Move {
    from: usize,
    to: usize,
    /// How much less half area all boxes have then, about.
    gain: f64,
}

/// Moves subtrees about. A tree that would get too deep or not cheaper stays as it is.
pub fn refine(tree: BinaryTree, steps: &Steps<'_>) -> BinaryTree {
    // Three nodes have nothing to move.
    if tree.nodes.len() <= 3 {
        return tree;
    }
    let mut pairs = Pairs::new(&tree);
    for _ in 0..ROUNDS {
        pairs.run_round();
        steps.refine(tree.order.len(), ROUNDS);
    }
    let refined = pairs.into_tree(&tree);
    let (before, after) = (tree.report(), refined.report());
    let better = after.max_depth <= sah::MAX_DEPTH && after.sah_cost < before.sah_cost;
    if better { refined } else { tree }
}

/// The other of two children.
fn sibling(node: usize) -> usize {
    ((node + 1) ^ 1) - 1
}

impl Pairs {
    fn new(tree: &BinaryTree) -> Self {
        let root = Pair { bounds: tree.nodes[0].bounds, first: 0, count: tree.nodes[0].count };
        let mut nodes = Vec::with_capacity(tree.nodes.len());
        nodes.push(root);
        let mut parents = Vec::with_capacity(tree.nodes.len());
        parents.push(0);
        // Where each node of the new order came from.
        let mut sources = vec![0_usize];
        let mut at = 0;
        while at < nodes.len() {
            let old = &tree.nodes[sources[at]];
            nodes[at] = Pair { bounds: old.bounds, first: old.first, count: old.count };
            if !old.is_leaf() {
                nodes[at].first = nodes.len() as u32;
                for child in [sources[at] + 1, old.first as usize] {
                    nodes.push(root);
                    parents.push(at as u32);
                    sources.push(child);
                }
            }
            at += 1;
        }
        Self { nodes, parents }
    }

    fn area(&self, node: usize) -> f64 {
        self.nodes[node].bounds.half_area()
    }

    fn parent(&self, node: usize) -> usize {
        self.parents[node] as usize
    }

    /// Seeks new places for the largest nodes and moves them there.
    fn run_round(&mut self) {
        let mut largest: Vec<_> = (1..self.nodes.len()).map(|i| (self.area(i), i)).collect();
        let count = (largest.len() / SHARE).max(1);
        largest.select_nth_unstable_by(count - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut moves: Vec<_> = largest[..count]
            .par_iter()
            .filter_map(|&(_, node)| self.find_best_move(node))
            .collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.from.cmp(&b.from)));
        let mut touched = vec![false; self.nodes.len()];
        for Move { from, to, .. } in moves {
            let touches = [from, to, sibling(from), self.parent(from), self.parent(to)];
            if touches.iter().all(|&node| !touched[node]) {
                for node in touches {
                    touched[node] = true;
                }
                self.make_move(from, to);
            }
        }
    }

    /// The best new place of a node. Taken out, its parent's box is gone and those above shrink to
    /// what is left in them (`pivot`); put beside another, boxes from there on grow by it.
    fn find_best_move(&self, node: usize) -> Option<Move> {
        let (bounds, area) = (self.nodes[node].bounds, self.area(node));
        let mut best = Move { from: node, to: 0, gain: 0.0 };
        let parent = self.parent(node);
        let (mut pivot, mut beside) = (parent, sibling(node));
        let mut rest = self.nodes[beside].bounds;
        let mut gain = self.area(parent);
        let mut stack = Vec::with_capacity(64);
        loop {
            stack.push((gain, beside));
            while let Some((gain, to)) = stack.pop() {
                if gain - area <= best.gain {
                    continue;
                }
                let there = &self.nodes[to];
                let gained = gain - there.bounds.union(bounds).half_area();
                if gained > best.gain {
                    best = Move { to, gain: gained, ..best };
                }
                if there.count == 0 {
                    let gain = gained + there.bounds.half_area();
                    stack.extend([there.first, there.first + 1].map(|c| (gain, c as usize)));
                }
            }
            if pivot != parent {
                rest = rest.union(self.nodes[beside].bounds);
                gain += self.area(pivot) - rest.half_area();
            }
            if pivot == 0 {
                break;
            }
            beside = sibling(pivot);
            pivot = self.parent(pivot);
        }
        let stays = best.to == 0 || best.to == sibling(node) || best.to == parent;
        (!stays).then_some(best)
    }

    /// Its sibling takes its parent's place, the pair moves to `to`, which becomes its sibling.
    fn make_move(&mut self, from: usize, to: usize) {
        let (beside, parent) = (sibling(from), self.parent(from));
        // A subtree can't move into itself: an earlier move may have brought `to` below it.
        let mut above = to;
        while above != 0 {
            if above == from {
                return;
            }
            above = self.parent(above);
        }
        let (kept, there) = (self.nodes[beside], self.nodes[to]);
        self.nodes[to] = Pair { first: from.min(beside) as u32, count: 0, ..there };
        self.nodes[beside] = there;
        self.nodes[parent] = kept;
        for node in [beside, parent] {
            let Pair { first, count, .. } = self.nodes[node];
            if count == 0 {
                self.parents[first as usize] = node as u32;
                self.parents[first as usize + 1] = node as u32;
            }
        }
        self.parents[beside] = to as u32;
        self.parents[from] = to as u32;
        self.refit(to);
        self.refit(parent);
    }

    /// Makes boxes from a node upwards what their children are.
    fn refit(&mut self, mut node: usize) {
        loop {
            let Pair { first, count, .. } = self.nodes[node];
            if count == 0 {
                let [a, b] = [first, first + 1].map(|child| self.nodes[child as usize].bounds);
                self.nodes[node].bounds = a.union(b);
            }
            if node == 0 {
                return;
            }
            node = self.parent(node);
        }
    }

    /// The tree in depth-first order, triangles moved along.
    fn into_tree(self, old: &BinaryTree) -> BinaryTree {
        let mut nodes: Vec<BinaryNode> = Vec::with_capacity(self.nodes.len());
        let mut order = Vec::with_capacity(old.order.len());
        // Nodes to come, second children with their new parents.
        let mut stack = vec![(0_u32, None)];
        while let Some((at, parent)) = stack.pop() {
            let Pair { bounds, first, count } = self.nodes[at as usize];
            let place = nodes.len() as u32;
            if let Some(parent) = parent {
                let parent: &mut BinaryNode = &mut nodes[parent as usize];
                parent.first = place;
            }
            if count > 0 {
                nodes.push(BinaryNode { bounds, first: order.len() as u32, count });
                order.extend_from_slice(&old.order[first as usize..][..count as usize]);
            } else {
                nodes.push(BinaryNode { bounds, first: 0, count });
                stack.extend([(first + 1, Some(place)), (first, None)]);
            }
        }
        BinaryTree { nodes, order, parts: old.parts }
    }
}
