//! Top-down construction with the surface area heuristic over equal bins of centroids.
//!
//! I. Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007. Ours bins all
//! three axes in one pass, and in parallel near the root; sums of counts and unions of boxes do not
//! depend on the order, so the tree does not depend on the threads.

use rayon::prelude::*;

use super::prims::Prim;
use super::sah::{Cost, DEPTH_OF_MIDDLE_SPLITS, Split};
use super::{BinaryNode, BinaryTree};
use crate::math::{Aabb, Vec3};

const BINS: usize = 32;
/// From here on fewer bins do: there is less to gain.
const FEW_PRIMS: usize = 64;
const FEW_BINS: usize = 16;
/// Nodes with more than this are binned by all threads.
const PARALLEL_BINNING: usize = 1 << 16;
/// Subtrees with fewer are built by one thread.
const PARALLEL_SUBTREES: usize = 1 << 13;

/// Builds a tree; `prims` are sorted by leaves as a side effect.
pub fn build(prims: &mut [Prim], cost: Cost) -> BinaryTree {
    if prims.is_empty() {
        return BinaryTree::default();
    }
    // Subtrees below a fraction of the whole are one task; gluing tasks together copies nodes.
    let task = (prims.len() / 64).max(PARALLEL_SUBTREES);
    let builder = Builder { cost, task };
    let mut nodes = Vec::new();
    builder.build(prims, 0, 0, &mut nodes);
    BinaryTree { nodes, order: prims.iter().map(|prim| prim.id).collect() }
}

struct Builder {
    cost: Cost,
    task: usize,
}

impl Builder {
    /// Appends the subtree of `prims`, which start at place `first` of the whole.
    fn build(&self, prims: &mut [Prim], first: usize, depth: usize, nodes: &mut Vec<BinaryNode>) {
        let (bounds, keys) = boxes(prims);
        let Some(middle) = self.split(prims, bounds, keys, depth) else {
            let (first, count) = (first as u32, prims.len() as u32);
            return nodes.push(BinaryNode { bounds, first, count });
        };
        let parent = nodes.len();
        nodes.push(BinaryNode { bounds, first: 0, count: 0 });
        let parallel = prims.len() > self.task;
        let (left, right) = prims.split_at_mut(middle);
        if parallel {
            let (mut below, mut above) = (Vec::new(), Vec::new());
            rayon::join(
                || self.build(left, first, depth + 1, &mut below),
                || self.build(right, first + middle, depth + 1, &mut above),
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

    /// Parts `prims` in two and returns where the second part begins; `None` for a leaf.
    fn split(&self, prims: &mut [Prim], bounds: Aabb, keys: Aabb, depth: usize) -> Option<usize> {
        if prims.len() == 1 {
            return None;
        }
        let grid = Grid::new(keys, if prims.len() < FEW_PRIMS { FEW_BINS } else { BINS });
        let split =
            if depth < DEPTH_OF_MIDDLE_SPLITS { grid.best_split(prims) } else { Split::NONE };
        if self.cost.prefers_leaf(prims.len(), &bounds, split.area) {
            return None;
        }
        if split.cost.is_finite() {
            let in_left = |prim: &Prim| grid.bin(prim.key())[split.axis] <= split.at;
            return Some(partition(prims, in_left));
        }
        // All centroids in one bin, or too deep: halves, in the order of the longest axis.
        let (axis, middle) = (keys.longest_axis(), prims.len() / 2);
        prims.select_nth_unstable_by(middle, |a, b| {
            a.key()[axis].total_cmp(&b.key()[axis]).then(a.id.cmp(&b.id))
        });
        Some(middle)
    }
}

/// The box of all boxes, and that of all keys.
fn boxes(prims: &[Prim]) -> (Aabb, Aabb) {
    let of = |prims: &[Prim]| {
        prims.iter().fold((Aabb::EMPTY, Aabb::EMPTY), |(bounds, keys), prim| {
            (bounds.union(prim.bounds), keys.include(prim.key()))
        })
    };
    if prims.len() < PARALLEL_BINNING {
        return of(prims);
    }
    prims
        .par_chunks(PARALLEL_BINNING / 4)
        .map(of)
        .reduce(|| (Aabb::EMPTY, Aabb::EMPTY), |a, b| (a.0.union(b.0), a.1.union(b.1)))
}

/// Moves those for which `in_left` holds to the front; returns how many they are.
fn partition(prims: &mut [Prim], in_left: impl Fn(&Prim) -> bool) -> usize {
    let (mut low, mut high) = (0, prims.len());
    loop {
        while low < high && in_left(&prims[low]) {
            low += 1;
        }
        while low < high && !in_left(&prims[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        prims.swap(low, high - 1);
    }
}

/// Equal bins along each axis.
struct Grid {
    low: Vec3,
    /// Bins per unit; zero for an axis on which all keys are alike.
    scale: Vec3,
    bins: usize,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: usize,
}

type Bins = [[Bin; BINS]; 3];

const NO_BINS: Bins = [[Bin { bounds: Aabb::EMPTY, count: 0 }; BINS]; 3];

impl Grid {
    fn new(keys: Aabb, bins: usize) -> Self {
        let scale = Vec3::splat(bins as f32) / keys.extent();
        let usable = |s: f32| if s.is_finite() { s } else { 0.0 };
        Self { low: keys.min, scale: scale.map(usable), bins }
    }

    #[inline(always)]
    fn bin(&self, key: Vec3) -> [usize; 3] {
        let bin = (key - self.low) * self.scale;
        // A cast of a float saturates.
        let last = self.bins - 1;
        [(bin.x as usize).min(last), (bin.y as usize).min(last), (bin.z as usize).min(last)]
    }

    fn fill(&self, prims: &[Prim]) -> Bins {
        let mut bins = NO_BINS;
        for prim in prims {
            let at = self.bin(prim.key());
            for axis in 0..3 {
                let bin = &mut bins[axis][at[axis]];
                bin.bounds = bin.bounds.union(prim.bounds);
                bin.count += 1;
            }
        }
        bins
    }

    fn best_split(&self, prims: &[Prim]) -> Split {
        let bins = if prims.len() < PARALLEL_BINNING {
            self.fill(prims)
        } else {
            prims
                .par_chunks(PARALLEL_BINNING / 4)
                .map(|part| self.fill(part))
                .reduce(|| NO_BINS, |a, b| merge(a, &b))
        };
        (0..3)
            .filter(|&axis| self.scale[axis] > 0.0)
            .fold(Split::NONE, |best, axis| best.min(best_of_axis(axis, &bins[axis][..self.bins])))
    }
}

fn merge(mut a: Bins, b: &Bins) -> Bins {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        a.bounds = a.bounds.union(b.bounds);
        a.count += b.count;
    }
    a
}

/// The best split after one of the bins of an axis.
fn best_of_axis(axis: usize, bins: &[Bin]) -> Split {
    let mut above = [(0.0, 0); BINS];
    let (mut bounds, mut count) = (Aabb::EMPTY, 0);
    for at in (1..bins.len()).rev() {
        bounds = bounds.union(bins[at].bounds);
        count += bins[at].count;
        above[at - 1] = (bounds.half_area(), count);
    }
    let mut best = Split::NONE;
    let (mut bounds, mut count) = (Aabb::EMPTY, 0);
    for at in 0..bins.len() - 1 {
        bounds = bounds.union(bins[at].bounds);
        count += bins[at].count;
        if count > 0 && above[at].1 > 0 {
            best = best.min(Split::new(axis, at, (bounds.half_area(), count), above[at]));
        }
    }
    best
}
