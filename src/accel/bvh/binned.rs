//! Top-down construction with the surface area heuristic over equal bins of centroids.
//!
//! I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007. Ours bins all
//! three axes in one pass, and in parallel near the root; sums of counts and unions of boxes do not
//! depend on the order, so the tree does not depend on the threads.

use super::objects::{ObjectSplit, find_bounds};
use super::prims::Prim;
use super::sah::Costs;
use super::{BinaryNode, BinaryTree};
use crate::accel::Steps;

/// Subtrees with fewer are built by one thread.
const PARALLEL_SUBTREES: usize = 1 << 13;

/// Builds a tree; `prims` are sorted by leaves as a side effect.
pub fn build(prims: &mut [Prim], costs: Costs, steps: &Steps<'_>) -> BinaryTree {
    if prims.is_empty() {
        return BinaryTree::default();
    }
    // Subtrees below a fraction of the whole are one task; gluing tasks together copies nodes.
    let task = (prims.len() / 64).max(PARALLEL_SUBTREES);
    let builder = Builder { costs, task, steps };
    let mut nodes = Vec::new();
    builder.build(prims, 0, 0, &mut nodes);
    BinaryTree { nodes, order: prims.iter().map(|prim| prim.id).collect(), parts: None }
}

struct Builder<'a> {
    costs: Costs,
    task: usize,
    steps: &'a Steps<'a>,
}

impl Builder<'_> {
    /// The nodes of a subtree; one that is a task is told of.
    fn build_part(&self, prims: &mut [Prim], first: usize, depth: usize) -> Vec<BinaryNode> {
        let (mut nodes, count) = (Vec::new(), prims.len());
        self.build(prims, first, depth, &mut nodes);
        if count <= self.task {
            self.steps.place(count);
        }
        nodes
    }

    /// Appends the subtree of `prims`, which start at place `first` of the whole.
    fn build(&self, prims: &mut [Prim], first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) {
        let (bounds, keys) = find_bounds(prims);
        let split = (!self.costs.must_be_leaf(prims.len()))
            .then(|| ObjectSplit::find_best(prims, keys, depth, &self.costs))
            .filter(|s| !self.costs.prefers_leaf(prims.len(), &bounds, s.split().area));
        let Some(split) = split else {
            let (first, count) = (first as u32, prims.len() as u32);
            return nodes.push(BinaryNode { bounds, first, count });
        };
        let middle = split.apply(prims, &self.costs);
        let parent = nodes.len();
        nodes.push(BinaryNode { bounds, first: 0, count: 0 });
        let parallel = prims.len() > self.task;
        let (left, right) = prims.split_at_mut(middle);
        if parallel {
            let (below, above) = rayon::join(
                || self.build_part(left, first, depth + 1),
                || self.build_part(right, first + middle, depth + 1),
            );
            BinaryTree::append_nodes(nodes, &below);
            nodes[parent].first = nodes.len() as u32;
            BinaryTree::append_nodes(nodes, &above);
        } else {
            self.build(left, first, depth + 1, nodes);
            nodes[parent].first = nodes.len() as u32;
            self.build(right, first + middle, depth + 1, nodes);
        }
    }
}
