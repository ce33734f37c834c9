//! Top-down construction with object splits and spatial splits.
//!
//! M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009. A
//! plane is tried wherever the children of the best object split overlap by more than 1e-4 of the
//! root's surface (4.5, where it is 1e-5: that takes twice the time for no better a tree), and
//! taken where it is cheaper.
//!
//! What a node may add to the references is shared out between its children by their numbers, not
//! raced for, so that the tree does not depend on the threads. Where leaves must be full
//! ([`Fill::Full`]), planes are tried in large nodes only, since each may leave one more leaf that
//! is not.

use super::objects::{ObjectSplit, find_bounds};
use super::parts::Cutter;
use super::prims::Prim;
use super::sah::{Costs, DEPTH_OF_MIDDLE_SPLITS, Fill};
use super::spatial::SpatialSplit;
use super::{BinaryNode, BinaryTree};
use crate::accel::Steps;
use crate::math::{Aabb, PrimId};

/// References may be so many times the triangles more.
const MORE: f64 = 0.5;
/// Overlap of children, as a share of the root's surface, from which on planes are tried.
const OVERLAP: f64 = 1e-4;
/// Where leaves must be full, nodes of fewer leaves than this are not cut.
const LEAVES_TO_CUT: usize = 16;
/// Subtrees with fewer are built by one thread.
const PARALLEL_SUBTREES: usize = 1 << 11;

/// Builds a tree.
pub fn build(prims: Vec<Prim>, cutter: &Cutter<'_>, costs: Costs, steps: &Steps<'_>) -> BinaryTree {
    if prims.is_empty() {
        return BinaryTree::default();
    }
    let budget = (prims.len() as f64 * MORE) as usize;
    let overlap = cutter.bounds().half_area() * OVERLAP;
    let builder = Builder { cutter, costs, overlap, steps };
    let mut subtree = Subtree::default();
    builder.build(prims, budget, 0, &mut subtree);
    BinaryTree { nodes: subtree.nodes, order: subtree.order, parts: Some(cutter.parts()) }
}

/// Nodes and the triangles of their leaves, both counted from its own beginning.
#[derive(Default)]
struct Subtree {
    nodes: Vec<BinaryNode>,
    order: Vec<PrimId>,
}

impl Subtree {
    fn append(&mut self, other: Self) {
        let (nodes, places) = (self.nodes.len() as u32, self.order.len() as u32);
        self.nodes.extend(other.nodes.into_iter().map(|node| {
            let offset = if node.is_leaf() { places } else { nodes };
            BinaryNode { first: node.first + offset, ..node }
        }));
        self.order.extend(other.order);
    }
}

struct Builder<'a> {
    cutter: &'a Cutter<'a>,
    costs: Costs,
    overlap: f64,
    steps: &'a Steps<'a>,
}

impl Builder<'_> {
    /// A subtree of its own; one that is a task is told of.
    fn build_part(&self, prims: Vec<Prim>, budget: usize, depth: usize) -> Subtree {
        let (mut subtree, count) = (Subtree::default(), prims.len());
        self.build(prims, budget, depth, &mut subtree);
        if count <= PARALLEL_SUBTREES {
            self.steps.place(count);
        }
        subtree
    }

    /// Appends the subtree of `prims`, with at most `budget` references more than they are.
    fn build(&self, mut prims: Vec<Prim>, budget: usize, depth: usize, out: &mut Subtree) {
        let (bounds, keys) = find_bounds(&prims);
        let count = prims.len();
        let Some(parts) = self.split(&mut prims, bounds, keys, budget, depth) else {
            let (first, count) = (out.order.len() as u32, count as u32);
            out.order.extend(prims.iter().map(|prim| prim.id));
            return out.nodes.push(BinaryNode { bounds, first, count });
        };
        drop(prims);
        let [left, right] = parts;
        let sum = left.len() + right.len();
        let budget = budget - sum.saturating_sub(count);
        let of_left = (budget as u128 * left.len() as u128 / sum as u128) as usize;
        let of_right = budget - of_left;
        let parent = out.nodes.len();
        out.nodes.push(BinaryNode { bounds, first: 0, count: 0 });
        if count > PARALLEL_SUBTREES {
            let (below, above) = rayon::join(
                || self.build_part(left, of_left, depth + 1),
                || self.build_part(right, of_right, depth + 1),
            );
            out.append(below);
            out.nodes[parent].first = out.nodes.len() as u32;
            out.append(above);
        } else {
            self.build(left, of_left, depth + 1, out);
            out.nodes[parent].first = out.nodes.len() as u32;
            self.build(right, of_right, depth + 1, out);
        }
    }

    /// What goes left and what goes right; `None` for a leaf.
    fn split(
        &self,
        prims: &mut [Prim],
        bounds: Aabb,
        keys: Aabb,
        budget: usize,
        depth: usize,
    ) -> Option<[Vec<Prim>; 2]> {
        let count = prims.len();
        if self.costs.must_be_leaf(count) {
            return None;
        }
        let objects = ObjectSplit::find_best(prims, keys, depth, &self.costs);
        let may_cut = depth < DEPTH_OF_MIDDLE_SPLITS
            && budget > 0
            && (self.costs.fill == Fill::Any || count >= LEAVES_TO_CUT * self.costs.width)
            && objects.find_overlap(prims).half_area() > self.overlap;
        let space = may_cut.then(|| SpatialSplit::find_best(prims, &bounds, self.cutter)).flatten();
        let space = space.filter(|space| {
            let sum = space.sides[0].count + space.sides[1].count;
            space.cost() < objects.split().cost && sum <= count + budget
        });
        let area = space.as_ref().map_or(objects.split().area, SpatialSplit::area);
        if self.costs.prefers_leaf(count, &bounds, area) {
            return None;
        }
        if let Some(parts) = space.and_then(|space| space.apply(prims, self.cutter)) {
            // Boxes are rounded: a few more may cross the plane than were counted.
            if parts[0].len() + parts[1].len() <= count + budget {
                return Some(parts);
            }
        }
        let middle = objects.apply(prims, &self.costs);
        let (left, right) = prims.split_at(middle);
        Some([left.to_vec(), right.to_vec()])
    }
}
