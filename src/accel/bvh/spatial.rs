//! Spatial splits: a plane through a node's box, and what crosses it is cut in two.
//!
//! M. Stich, H. Friedrich, A. Dietrich, "Spatial Splits in Bounding Volume Hierarchies", 2009, 4.1
//! and 4.4: planes between equal bins; each triangle is chopped at the planes that it crosses and
//! its pieces, cut to the primitive's box, widen the boxes of their bins; it is counted where it
//! begins and where it ends. A primitive that crosses the plane stays whole on one side if that is
//! cheaper.
//!
//! The pieces only tell what a plane would cost. What is kept is cut by [`super::parts`].

use rayon::prelude::*;

use super::bins::PARALLEL_BINNING;
use super::parts::Cutter;
use super::prims::Prim;
use crate::accel::sah::expected_tests;
use crate::geom::Triangle;
use crate::math::{Aabb, Vec3};

const BINS: usize = 32;

/// One side of a split.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The box of what is in there.
    pub bounds: Aabb,
    /// Their number.
    pub count: usize,
}

impl Side {
    const EMPTY: Self = Self { bounds: Aabb::EMPTY, count: 0 };

    fn with(&self, bounds: &Aabb) -> Self {
        Self { bounds: self.bounds.union(*bounds), count: self.count }
    }

    fn without_one(&self) -> Self {
        Self { count: self.count - 1, ..*self }
    }
}

/// A plane, and what it would make.
#[derive(Clone, Copy, Debug)]
pub struct SpatialSplit {
    axis: usize,
    plane: f32,
    /// Below and above, what crosses the plane on both.
    pub sides: [Side; 2],
}

/// What is in a bin, and how many primitives begin and end there.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    begin: usize,
    end: usize,
}

type Bins = [[Bin; BINS]; 3];

const NO_BINS: Bins = [[Bin { bounds: Aabb::EMPTY, begin: 0, end: 0 }; BINS]; 3];

/// Planes at equal distances through a box.
struct Planes {
    low: Vec3,
    width: Vec3,
    /// Bins per unit; zero for an axis along which the box is flat.
    scale: Vec3,
}

impl Planes {
    fn new(bounds: &Aabb) -> Self {
        let width = bounds.extent() / BINS as f32;
        let scale = width.map(|w| if w.recip().is_finite() { w.recip() } else { 0.0 });
        Self { low: bounds.min, width, scale }
    }

    /// The bin of a coordinate.
    #[inline(always)]
    fn bin(&self, axis: usize, at: f32) -> usize {
        (((at - self.low[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }

    /// The plane behind a bin.
    fn plane_behind(&self, axis: usize, bin: usize) -> f32 {
        self.low[axis] + self.width[axis] * (bin + 1) as f32
    }

    fn fill(&self, prims: &[Prim], cutter: &Cutter<'_>) -> Bins {
        let mut bins = NO_BINS;
        for prim in prims {
            let mut triangle = None;
            for (axis, bins) in bins.iter_mut().enumerate() {
                let first = self.bin(axis, prim.bounds.min[axis]);
                let last = self.bin(axis, prim.bounds.max[axis]).max(first);
                bins[first].begin += 1;
                bins[last].end += 1;
                if first == last {
                    bins[first].bounds = bins[first].bounds.union(prim.bounds);
                    continue;
                }
                let triangle = triangle.get_or_insert_with(|| cutter.fetch_whole(prim).triangle);
                let pieces = self.find_pieces(axis, triangle, first, last);
                for (bin, piece) in bins[first..=last].iter_mut().zip(&pieces[first..]) {
                    let piece = piece.intersection(prim.bounds);
                    if !piece.is_empty() {
                        bin.bounds = bin.bounds.union(piece);
                    }
                }
            }
        }
        bins
    }

    /// The boxes of the pieces of a triangle between planes, for some bins of an axis.
    fn find_pieces(
        &self,
        axis: usize,
        triangle: &Triangle,
        first: usize,
        last: usize,
    ) -> [Aabb; BINS] {
        let Triangle { a, b, c } = *triangle;
        let mut pieces = [Aabb::EMPTY; BINS];
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = if p[axis] <= q[axis] { (p, q) } else { (q, p) };
            let (begin, end) = (self.bin(axis, p[axis]), self.bin(axis, q[axis]));
            pieces[begin] = pieces[begin].include(p);
            pieces[end] = pieces[end].include(q);
            for at in begin.max(first.saturating_sub(1))..end.min(last + 1) {
                let along = (self.plane_behind(axis, at) - p[axis]) / (q[axis] - p[axis]);
                let crossing = p + (q - p) * along;
                pieces[at] = pieces[at].include(crossing);
                pieces[at + 1] = pieces[at + 1].include(crossing);
            }
        }
        pieces
    }

    fn find_best_on_axis(&self, axis: usize, bins: &[Bin; BINS]) -> Option<SpatialSplit> {
        let mut above = [Side::EMPTY; BINS];
        for at in (1..BINS).rev() {
            let count = above[at].count + bins[at].end;
            above[at - 1] = Side { count, ..above[at].with(&bins[at].bounds) };
        }
        let mut below = Side::EMPTY;
        let mut best: Option<SpatialSplit> = None;
        for at in 0..BINS - 1 {
            below = Side { count: below.count + bins[at].begin, ..below.with(&bins[at].bounds) };
            if below.count > 0 && above[at].count > 0 {
                let plane = self.plane_behind(axis, at);
                let split = SpatialSplit { axis, plane, sides: [below, above[at]] };
                best = Some(best.map_or(split, |best| best.min(split)));
            }
        }
        best
    }
}

fn merge(mut a: Bins, b: &Bins) -> Bins {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        a.bounds = a.bounds.union(b.bounds);
        a.begin += b.begin;
        a.end += b.end;
    }
    a
}

impl SpatialSplit {
    /// The best one through the box of some primitives.
    pub fn find_best(prims: &[Prim], bounds: &Aabb, cutter: &Cutter<'_>) -> Option<Self> {
        let planes = Planes::new(bounds);
        let bins = if prims.len() < PARALLEL_BINNING / 4 {
            planes.fill(prims, cutter)
        } else {
            prims
                .par_chunks(PARALLEL_BINNING / 16)
                .map(|part| planes.fill(part, cutter))
                .reduce(|| NO_BINS, |a, b| merge(a, &b))
        };
        (0..3)
            .filter(|&axis| planes.scale[axis] > 0.0)
            .filter_map(|axis| planes.find_best_on_axis(axis, &bins[axis]))
            .reduce(Self::min)
    }

    /// The cheaper; the first of equals.
    fn min(self, other: Self) -> Self {
        if other.cost() < self.cost() { other } else { self }
    }

    /// The sum over both sides of half area times count.
    pub fn cost(&self) -> f64 {
        sum_costs(&self.sides)
    }

    /// Sum of both sides' half areas.
    pub fn area(&self) -> f64 {
        self.sides[0].bounds.half_area() + self.sides[1].bounds.half_area()
    }

    /// What is below and what is above; `None` if that gets nowhere: nothing on a side.
    pub fn apply(&self, prims: &[Prim], cutter: &Cutter<'_>) -> Option<[Vec<Prim>; 2]> {
        let mut parts = self.sides.map(|side| Vec::with_capacity(side.count));
        let mut sides = self.sides;
        for prim in prims {
            if prim.bounds.max[self.axis] <= self.plane {
                parts[0].push(*prim);
            } else if prim.bounds.min[self.axis] >= self.plane {
                parts[1].push(*prim);
            } else {
                self.cut_or_keep(prim, cutter, &mut sides, &mut parts);
            }
        }
        (!parts[0].is_empty() && !parts[1].is_empty()).then_some(parts)
    }

    /// Cuts a primitive that crosses the plane, or keeps it whole on one side, if that is cheaper
    /// ("reference unsplitting"); the sides are changed to match.
    fn cut_or_keep(
        &self,
        prim: &Prim,
        cutter: &Cutter<'_>,
        sides: &mut [Side; 2],
        parts: &mut [Vec<Prim>; 2],
    ) {
        if sides.iter().all(|side| side.count > 1) {
            let [below, above] = *sides;
            let whole = [
                [below.with(&prim.bounds), above.without_one()],
                [below.without_one(), above.with(&prim.bounds)],
            ];
            let on = usize::from(sum_costs(&whole[1]) < sum_costs(&whole[0]));
            if sum_costs(&whole[on]) < sum_costs(sides) {
                *sides = whole[on];
                return parts[on].push(*prim);
            }
        }
        for (part, half) in parts.iter_mut().zip(cutter.cut(prim, self.axis, self.plane)) {
            part.extend(half);
        }
    }
}

/// The sum over both sides of half area times count.
fn sum_costs(sides: &[Side; 2]) -> f64 {
    expected_tests([0, 1].map(|side| (sides[side].bounds.half_area(), sides[side].count as f64)))
}
