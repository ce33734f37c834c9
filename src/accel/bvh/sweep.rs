//! Top-down construction with the surface area heuristic over every split of the sorted centroids.
//!
//! The primitives are sorted once along each axis; a split parts the three lists in their order, so
//! that the whole takes O(N log N). Equal centroids are in the order of their ids.

use rayon::prelude::*;

use super::prims::Prim;
use super::sah::{Costs, DEPTH_OF_MIDDLE_SPLITS, Split};
use super::{BinaryNode, BinaryTree};
use crate::accel::Steps;
use crate::math::Aabb;

/// Subtrees with fewer are built by one thread.
const PARALLEL_SUBTREES: usize = 1 << 13;

/// Builds a tree.
pub fn build(prims: &[Prim], costs: Costs, steps: &Steps<'_>) -> BinaryTree {
    if prims.is_empty() {
        return BinaryTree::default();
    }
    let mut lists = [0, 1, 2].map(|axis| {
        let mut list: Vec<u32> = (0..prims.len() as u32).collect();
        list.par_sort_unstable_by(|&a, &b| {
            let (ka, kb) = (prims[a as usize].key()[axis], prims[b as usize].key()[axis]);
            ka.total_cmp(&kb).then(a.cmp(&b))
        });
        list
    });
    let mut scratch = vec![0_u32; prims.len()];
    let task = (prims.len() / 64).max(PARALLEL_SUBTREES);
    let builder = Builder { prims, costs, task, steps };
    let mut nodes = Vec::new();
    let [x, y, z] = &mut lists;
    builder.build(Lists { axes: [x, y, z], scratch: &mut scratch }, 0, 0, &mut nodes);
    let order = lists[0].iter().map(|&i| prims[i as usize].id).collect();
    BinaryTree { nodes, order, parts: None }
}

struct Builder<'a> {
    prims: &'a [Prim],
    costs: Costs,
    task: usize,
    steps: &'a Steps<'a>,
}

/// The primitives of a node in the order of each axis, and room as large.
struct Lists<'a> {
    axes: [&'a mut [u32]; 3],
    scratch: &'a mut [u32],
}

impl Lists<'_> {
    fn len(&self) -> usize {
        self.scratch.len()
    }

    fn split_at(self, middle: usize) -> (Self, Self) {
        let [x, y, z] = self.axes;
        let ((xl, xr), (yl, yr), (zl, zr)) =
            (x.split_at_mut(middle), y.split_at_mut(middle), z.split_at_mut(middle));
        let (sl, sr) = self.scratch.split_at_mut(middle);
        (Self { axes: [xl, yl, zl], scratch: sl }, Self { axes: [xr, yr, zr], scratch: sr })
    }
}

impl Builder<'_> {
    /// The nodes of a subtree; one that is a task is told of.
    fn build_part(&self, lists: Lists<'_>, first: usize, depth: usize) -> Vec<BinaryNode> {
        let (mut nodes, count) = (Vec::new(), lists.len());
        self.build(lists, first, depth, &mut nodes);
        if count <= self.task {
            self.steps.place(count);
        }
        nodes
    }

    fn build(&self, mut lists: Lists<'_>, first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) {
        let bounds_of = |i: &u32| self.prims[*i as usize].bounds;
        let bounds = lists.axes[0].iter().map(bounds_of).fold(Aabb::EMPTY, Aabb::union);
        let count = lists.len();
        let split = if self.costs.must_be_leaf(count) {
            Split::NONE
        } else if depth < DEPTH_OF_MIDDLE_SPLITS {
            self.find_best_split(&lists)
        } else {
            let at = self.costs.nearest_place(count, count / 2);
            Split { axis: bounds.longest_axis(), at, ..Split::NONE }
        };
        if self.costs.prefers_leaf(count, &bounds, split.area) {
            // All three lists hold the same triangles; the first one is the tree's order.
            return nodes.push(BinaryNode { bounds, first: first as u32, count: count as u32 });
        }
        self.partition(&mut lists, split.axis, split.at);

        let parent = nodes.len();
        nodes.push(BinaryNode { bounds, first: 0, count: 0 });
        let (left, right) = lists.split_at(split.at);
        if count > self.task {
            let (below, above) = rayon::join(
                || self.build_part(left, first, depth + 1),
                || self.build_part(right, first + split.at, depth + 1),
            );
            BinaryTree::append_nodes(nodes, &below);
            nodes[parent].first = nodes.len() as u32;
            BinaryTree::append_nodes(nodes, &above);
        } else {
            self.build(left, first, depth + 1, nodes);
            nodes[parent].first = nodes.len() as u32;
            self.build(right, first + split.at, depth + 1, nodes);
        }
    }

    /// Tries every place in every list where the cost allows a split.
    fn find_best_split(&self, lists: &Lists<'_>) -> Split {
        let count = lists.len();
        let mut above = vec![0.0_f64; count];
        let mut best = Split::NONE;
        for axis in 0..3 {
            let list = &lists.axes[axis];
            let mut bounds = Aabb::EMPTY;
            for at in (1..count).rev() {
                bounds = bounds.union(self.prims[list[at] as usize].bounds);
                above[at] = bounds.half_area();
            }
            let mut bounds = Aabb::EMPTY;
            for at in 1..count {
                bounds = bounds.union(self.prims[list[at - 1] as usize].bounds);
                if !self.costs.allows(count, at) {
                    continue;
                }
                let (left, right) = ((bounds.half_area(), at), (above[at], count - at));
                best = best.min(Split::new(axis, at, left, right));
            }
        }
        best
    }

    /// Parts all lists so that the first `at` of list `axis` come first in each.
    fn partition(&self, lists: &mut Lists<'_>, axis: usize, at: usize) {
        let key = |i: u32| self.prims[i as usize].key()[axis];
        let pivot = lists.axes[axis][at];
        // Keys and, where they are equal, indices: exactly the order that the list is in.
        let in_left = |i: u32| key(i).total_cmp(&key(pivot)).then(i.cmp(&pivot)).is_lt();
        for other in (0..3).filter(|&other| other != axis) {
            let list = &mut lists.axes[other];
            let (mut left, mut right) = (0, at);
            for &i in list.iter() {
                let place = if in_left(i) { &mut left } else { &mut right };
                lists.scratch[*place] = i;
                *place += 1;
            }
            list.copy_from_slice(lists.scratch);
        }
    }
}
