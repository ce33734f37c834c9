//! What the builders with bins share.

use super::input::Reference;
use super::sah::{CellCosts, Costs, Plane};
use crate::math::Aabb;

/// Intervals along an axis.
pub const BINS: usize = 32;

/// The bounds between equal bins along an axis.
pub struct Planes {
    planes: [f32; BINS - 1],
    low: f32,
    per_unit: f32,
}

impl Planes {
    /// `None` if there is nothing to divide.
    fn new(low: f32, high: f32) -> Option<Self> {
        let width = (high - low) / BINS as f32;
        let per_unit = 1.0 / width;
        if !(width > 0.0 && width.is_finite() && per_unit.is_finite()) {
            return None;
        }
        let mut planes = [0.0; BINS - 1];
        for (i, plane) in planes.iter_mut().enumerate() {
            *plane = low + width * (i + 1) as f32;
        }
        Some(Self { planes, low, per_unit })
    }

    /// The bound above a bin.
    #[inline]
    pub fn plane(&self, bin: usize) -> f32 {
        self.planes[bin]
    }

    /// About how many bounds are below a coordinate.
    #[inline]
    pub fn count_near(&self, x: f32) -> usize {
        // Saturates at both ends.
        (((x - self.low) * self.per_unit) as usize).min(BINS - 1)
    }

    /// How many bounds are at or below a coordinate.
    #[inline]
    pub fn count_at_or_below(&self, x: f32) -> usize {
        let mut count = self.count_near(x);
        while count < BINS - 1 && self.planes[count] <= x {
            count += 1;
        }
        while count > 0 && self.planes[count - 1] > x {
            count -= 1;
        }
        count
    }

    /// How many bounds are below a coordinate.
    #[inline]
    pub fn count_below(&self, x: f32) -> usize {
        let mut count = self.count_near(x);
        while count < BINS - 1 && self.planes[count] < x {
            count += 1;
        }
        while count > 0 && self.planes[count - 1] >= x {
            count -= 1;
        }
        count
    }
}

/// Planes to choose from.
pub struct Candidates<'a> {
    costs: CellCosts<'a>,
    /// The part of the cell that triangles take.
    range: Aabb,
    /// The best so far.
    pub best: Option<Plane>,
}

impl<'a> Candidates<'a> {
    /// Begins with the planes that cut off empty space.
    pub fn new(references: &[Reference], cell: &'a Aabb, costs: &'a Costs) -> Self {
        let all = references.iter().fold(Aabb::EMPTY, |all, r| all.union(r.bounds));
        let range = all.intersection(*cell);
        let mut candidates = Self { costs: costs.in_cell(cell), range, best: None };
        let count = references.len();
        for axis in 0..3 {
            candidates.offer(axis, range.min[axis], 0, count);
            candidates.offer(axis, range.max[axis], count, 0);
        }
        candidates
    }

    /// The bounds of bins over the triangles.
    pub fn planes(&self, axis: usize) -> Option<Planes> {
        Planes::new(self.range.min[axis], self.range.max[axis])
    }

    /// Considers a plane with that many triangles below and above it.
    #[inline]
    pub fn offer(&mut self, axis: usize, split: f32, below: usize, above: usize) {
        if let Some(plane) = self.costs.weigh(axis, split, below, above) {
            self.best = Some(Plane::choose_cheaper(self.best, plane));
        }
    }
}
