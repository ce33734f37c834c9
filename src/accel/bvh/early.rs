//! Early split clipping: large triangles are cut into parts before a tree is built.
//!
//! M. Ernst and G. Greiner, "Early Split Clipping for Bounding Volume Hierarchies", 2007: a box
//! whose surface is above a threshold is halved along its longest edge, both halves shrunk to what
//! they hold of the triangle, and so on. Any builder then works on the parts.
//!
//! Ours looks at what a cut gains, the surface of the box less that of both halves': triangles
//! along the axes gain nothing. And it bounds the number of parts: the threshold is halved from the
//! scene's surface downwards, as long as parts may be added, and what gains more is cut all at
//! once; if that is too much, the best only. So it does not depend on the threads.

use rayon::prelude::*;

use super::parts::Cutter;
use super::prims::Prim;

/// Parts may be so many times the triangles more.
const MORE: f64 = 0.5;
/// Threshold below which cuts do not pay, in mean surfaces of the boxes.
const SMALLEST: f64 = 2.0;
/// And in surfaces of the box itself.
const SHARE: f64 = 0.3;

/// A primitive that may be worth cutting.
struct Candidate {
    prim: Prim,
    halves: [Option<Prim>; 2],
    /// How much less surface the halves have.
    gain: f64,
}

impl Candidate {
    fn new(prim: Prim, cutter: &Cutter<'_>) -> Self {
        let axis = prim.bounds.longest_axis();
        let halves = cutter.cut(&prim, axis, prim.bounds.centre()[axis]);
        let area = prim.bounds.half_area();
        let left: f64 = halves.iter().flatten().map(|half| half.bounds.half_area()).sum();
        let gain = if area - left > SHARE * area { area - left } else { 0.0 };
        Self { prim, halves, gain }
    }
}

/// Cuts the large ones of some triangles.
pub fn split(prims: Vec<Prim>, cutter: &Cutter<'_>) -> Vec<Prim> {
    let mut budget = (prims.len() as f64 * MORE) as usize;
    let mean = prims.iter().map(|p| p.bounds.half_area()).sum::<f64>() / prims.len().max(1) as f64;
    let smallest = mean * SMALLEST;
    // Halves have at least a third of the surface.
    let (large, mut done): (Vec<Prim>, Vec<Prim>) =
        prims.into_par_iter().partition(|prim| prim.bounds.half_area() > 1.5 * smallest);
    let mut waiting: Vec<_> =
        large.into_par_iter().map(|prim| Candidate::new(prim, cutter)).collect();
    let mut threshold = cutter.bounds().half_area();
    while threshold > smallest && budget > 0 {
        threshold = (threshold * 0.5).max(smallest);
        waiting = cut_above(threshold, waiting, cutter, &mut budget);
    }
    done.extend(waiting.into_iter().map(|candidate| candidate.prim));
    done
}

/// Cuts until no cut gains more than a threshold, or nothing may be added.
fn cut_above(
    threshold: f64,
    waiting: Vec<Candidate>,
    cutter: &Cutter<'_>,
    budget: &mut usize,
) -> Vec<Candidate> {
    let (mut large, mut small): (Vec<_>, Vec<_>) =
        waiting.into_par_iter().partition(|candidate| candidate.gain > threshold);
    while !large.is_empty() && *budget > 0 {
        if large.len() > *budget {
            large.par_sort_by(|a, b| b.gain.total_cmp(&a.gain));
            small.extend(large.drain(*budget..));
        }
        let before = large.len();
        let halves: Vec<_> = large
            .into_par_iter()
            .flat_map_iter(|candidate| candidate.halves.into_iter().flatten())
            .map(|half| Candidate::new(half, cutter))
            .collect();
        *budget -= halves.len().saturating_sub(before);
        let (above, below): (Vec<_>, Vec<_>) =
            halves.into_par_iter().partition(|candidate| candidate.gain > threshold);
        large = above;
        small.extend(below);
    }
    small.extend(large);
    small
}
