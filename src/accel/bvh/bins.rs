//! Equal bins along each axis, filled by the middles of boxes.

use rayon::prelude::*;

use super::prims::Prim;
use super::sah::Split;
use crate::math::{Aabb, Vec3};

/// Nodes with more than this are binned by all threads.
pub const PARALLEL_BINNING: usize = 1 << 16;

/// Equal bins along each axis.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
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

type Bins = [[Bin; Grid::MOST]; 3];

const NO_BINS: Bins = [[Bin { bounds: Aabb::EMPTY, count: 0 }; Grid::MOST]; 3];

impl Grid {
    /// Bins along an axis, at most.
    pub const MOST: usize = 32;

    /// Bins over the box of all keys.
    pub fn new(keys: Aabb, bins: usize) -> Self {
        let scale = Vec3::splat(bins as f32) / keys.extent();
        let usable = |s: f32| if s.is_finite() { s } else { 0.0 };
        Self { low: keys.min, scale: scale.map(usable), bins }
    }

    /// The bins of a point, axis by axis; monotone in each coordinate.
    #[inline(always)]
    pub fn bin(&self, key: Vec3) -> [usize; 3] {
        let bin = (key - self.low) * self.scale;
        // A cast of a float saturates.
        let last = self.bins - 1;
        [(bin.x as usize).min(last), (bin.y as usize).min(last), (bin.z as usize).min(last)]
    }

    /// The bin of a primitive along an axis.
    #[inline(always)]
    pub fn bin_along(&self, axis: usize, prim: &Prim) -> usize {
        self.bin(prim.key())[axis]
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

    /// The best split after one of the bins of any axis.
    pub fn find_best_split(&self, prims: &[Prim]) -> Split {
        let bins = if prims.len() < PARALLEL_BINNING {
            self.fill(prims)
        } else {
            prims
                .par_chunks(PARALLEL_BINNING / 4)
                .map(|part| self.fill(part))
                .reduce(|| NO_BINS, |a, b| merge(a, &b))
        };
        (0..3).filter(|&axis| self.scale[axis] > 0.0).fold(Split::NONE, |best, axis| {
            best.min(find_best_on_axis(axis, &bins[axis][..self.bins]))
        })
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
fn find_best_on_axis(axis: usize, bins: &[Bin]) -> Split {
    let mut above = [(0.0, 0); Grid::MOST];
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
