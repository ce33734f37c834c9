//! Early split clipping: large triangles are cut into parts before a tree is built.
//!
//! M. Ernst and G. Greiner, "Early Split Clipping for Bounding Volume Hierarchies", 2007: a box
//! whose surface is above a threshold is halved along its longest edge, both halves shrunk to what
//! they hold of the triangle, and so on. Any builder then works on the parts.
//!
//! Ours counts the empty part of a box only, as T. Karras and T. Aila do ("Fast Parallel
//! Construction of High-Quality Bounding Volume Hierarchies", 2013, 4.1): the surface less that of
//! infinitely many parts. And it bounds the number of parts: the threshold is halved from that of
//! the scene's box downwards, as long as parts may be added, and what is above it is cut all at
//! once; if that is too much, the largest only. So it does not depend on the threads.

use rayon::prelude::*;

use super::parts::Cutter;
use super::prims::Prim;
use crate::math::Aabb;

/// Parts may be so many times the triangles more.
const MORE: f64 = 0.5;
/// Threshold at which no more is gained, in mean surfaces of the boxes.
const SMALLEST: f64 = 1.0;

/// A primitive that may be worth cutting.
struct Candidate {
    prim: Prim,
    /// The share of its triangle's box that is empty.
    share: f64,
}

impl Candidate {
    fn new(prim: Prim, cutter: &Cutter<'_>) -> Self {
        // Of the triangle alone: half the surface that many small boxes have is that of its three
        // projections.
        let normal = cutter.whole(&prim).triangle.double_area().abs().as_dvec3();
        let least = (normal.x + normal.y + normal.z) * 0.5;
        let share = (1.0 - least / prim.bounds.half_area().max(f64::MIN_POSITIVE)).max(0.0);
        Self { prim, share }
    }

    fn waste(&self) -> f64 {
        self.prim.bounds.half_area() * self.share
    }

    /// Both halves, unless there is nothing to be halved.
    fn halves(&self, cutter: &Cutter<'_>) -> [Option<Self>; 2] {
        let bounds = &self.prim.bounds;
        let axis = bounds.longest_axis();
        cutter
            .cut(&self.prim, axis, bounds.centre()[axis])
            .map(|part| part.map(|prim| Self { prim, share: self.share }))
    }
}

/// Cuts the large ones of some triangles; `bounds` is the union of their boxes.
pub fn split(prims: Vec<Prim>, cutter: &Cutter<'_>, bounds: &Aabb) -> Vec<Prim> {
    let mut budget = (prims.len() as f64 * MORE) as usize;
    let mean = prims.iter().map(|p| p.bounds.half_area()).sum::<f64>() / prims.len().max(1) as f64;
    let smallest = mean * SMALLEST;
    let (large, mut done): (Vec<Prim>, Vec<Prim>) =
        prims.into_par_iter().partition(|prim| prim.bounds.half_area() > smallest);
    let mut waiting: Vec<_> =
        large.into_par_iter().map(|prim| Candidate::new(prim, cutter)).collect();
    let mut threshold = bounds.half_area();
    while threshold > smallest && budget > 0 {
        threshold = (threshold * 0.5).max(smallest);
        waiting = cut_above(threshold, waiting, cutter, &mut budget);
    }
    done.extend(waiting.into_iter().map(|candidate| candidate.prim));
    done
}

/// Cuts until nothing is above a threshold, or nothing may be added.
fn cut_above(
    threshold: f64,
    waiting: Vec<Candidate>,
    cutter: &Cutter<'_>,
    budget: &mut usize,
) -> Vec<Candidate> {
    let above = |candidate: &Candidate| candidate.waste() > threshold;
    let (mut large, mut small): (Vec<_>, Vec<_>) = waiting.into_par_iter().partition(above);
    while !large.is_empty() && *budget > 0 {
        if large.len() > *budget {
            large.par_sort_by(|a, b| b.waste().total_cmp(&a.waste()));
            small.extend(large.drain(*budget..));
        }
        let halves: Vec<_> = large.par_iter().map(|candidate| candidate.halves(cutter)).collect();
        let before = large.len();
        let halves = halves.into_iter().flatten().flatten();
        let (above, below): (Vec<_>, Vec<_>) = halves.partition(above);
        *budget -= (above.len() + below.len()).saturating_sub(before);
        large = above;
        small.extend(below);
    }
    small.extend(large);
    small
}
