//! Object splits: whole primitives go left or right, by the middles of their boxes.

use rayon::prelude::*;

use super::bins::{Grid, PARALLEL_BINNING};
use super::prims::Prim;
use super::sah::{Costs, DEPTH_OF_MIDDLE_SPLITS, Fill, Split};
use crate::math::Aabb;

const BINS: usize = Grid::MOST;
/// From here on fewer bins do: there is less to gain.
const FEW_PRIMS: usize = 64;
const FEW_BINS: usize = 16;
/// Where leaves must be full, every place of nodes of at most so many leaves is tried: a boundary
/// between bins would be moved too far.
const FEW_LEAVES: usize = 8;

/// The box of all boxes, and that of all keys.
pub fn find_bounds(prims: &[Prim]) -> (Aabb, Aabb) {
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

/// A way to part primitives by their keys.
pub enum ObjectSplit {
    /// After a bin of an axis, or at the nearest place that the cost allows.
    AfterBin(Grid, Split),
    /// After the first few in the order of an axis.
    AfterFirst(Split),
}

impl ObjectSplit {
    /// The best for primitives whose keys have the box `keys`; their order may change.
    pub fn find_best(prims: &mut [Prim], keys: Aabb, depth: usize, costs: &Costs) -> Self {
        let count = prims.len();
        if depth < DEPTH_OF_MIDDLE_SPLITS {
            if costs.fill == Fill::Full && count <= FEW_LEAVES * costs.width {
                return Self::AfterFirst(find_best_place(prims, costs));
            }
            let grid = Grid::new(keys, if count < FEW_PRIMS { FEW_BINS } else { BINS });
            let split = grid.find_best_split(prims);
            if split.cost.is_finite() {
                return Self::AfterBin(grid, split);
            }
        }
        // All centroids in one bin, or too deep: halves, in the order of the longest axis.
        let at = costs.nearest_place(count, count / 2);
        Self::AfterFirst(Split { axis: keys.longest_axis(), at, ..Split::NONE })
    }

    /// What it costs, as far as it is known.
    pub fn split(&self) -> &Split {
        match self {
            Self::AfterBin(_, split) | Self::AfterFirst(split) => split,
        }
    }

    /// What the boxes of both sides have in common; the primitives' order may change.
    pub fn find_overlap(&self, prims: &mut [Prim]) -> Aabb {
        let (mut below, mut above) = (Aabb::EMPTY, Aabb::EMPTY);
        match *self {
            Self::AfterBin(ref grid, Split { axis, at, .. }) => {
                for prim in prims {
                    let is_below = grid.bin_along(axis, prim) <= at;
                    let side = if is_below { &mut below } else { &mut above };
                    *side = side.union(prim.bounds);
                }
            }
            Self::AfterFirst(Split { axis, at, .. }) => {
                select(prims, axis, at);
                (below, above) = (find_bounds(&prims[..at]).0, find_bounds(&prims[at..]).0);
            }
        }
        below.intersection(above)
    }

    /// Parts the primitives; returns where the second part begins.
    pub fn apply(&self, prims: &mut [Prim], costs: &Costs) -> usize {
        match *self {
            Self::AfterFirst(Split { axis, at, .. }) => {
                select(prims, axis, at);
                at
            }
            Self::AfterBin(ref grid, Split { axis, at, .. }) => {
                let middle = partition(prims, |prim| grid.bin_along(axis, prim) <= at);
                let place = costs.nearest_place(prims.len(), middle);
                move_boundary(prims, grid, axis, at, middle, place);
                place
            }
        }
    }
}

/// Moves a boundary between two sides from behind bin `bin` of an axis to another place.
fn move_boundary(
    prims: &mut [Prim],
    grid: &Grid,
    axis: usize,
    mut bin: usize,
    middle: usize,
    place: usize,
) {
    // Narrow it down to the bin with that place in it.
    let (mut low, mut high) = (middle, middle);
    while place < low {
        (low, high) = (partition(&mut prims[..low], |p| grid.bin_along(axis, p) < bin), low);
        bin = bin.saturating_sub(1);
    }
    while place > high {
        bin += 1;
        let count = partition(&mut prims[high..], |p| grid.bin_along(axis, p) <= bin);
        (low, high) = (high, high + count);
    }
    if low < place && place < high {
        select(&mut prims[low..high], axis, place - low);
    }
}

/// Brings the first `at` in the order of an axis to the front.
fn select(prims: &mut [Prim], axis: usize, at: usize) {
    prims.select_nth_unstable_by(at, |a, b| a.order(b, axis));
}

/// Tries every place that the cost allows along all axes; sorts the primitives.
fn find_best_place(prims: &mut [Prim], costs: &Costs) -> Split {
    let count = prims.len();
    let mut above = vec![0.0; count];
    let mut best = Split::NONE;
    for axis in 0..3 {
        prims.sort_unstable_by(|a, b| a.order(b, axis));
        let mut bounds = Aabb::EMPTY;
        for at in (1..count).rev() {
            bounds = bounds.union(prims[at].bounds);
            above[at] = bounds.half_area();
        }
        let mut bounds = Aabb::EMPTY;
        for at in 1..count {
            bounds = bounds.union(prims[at - 1].bounds);
            if costs.allows(count, at) {
                let (left, right) = ((bounds.half_area(), at), (above[at], count - at));
                best = best.min(Split::new(axis, at, left, right));
            }
        }
    }
    // Where areas overflow nothing is better than the middle.
    if best.cost.is_finite() {
        best
    } else {
        Split { at: costs.nearest_place(count, count / 2), ..best }
    }
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
