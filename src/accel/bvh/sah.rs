//! The surface area heuristic of hierarchies.

use crate::accel::sah::expected_tests;
use crate::math::Aabb;

/// C_T of all hierarchies: a step through an inner node in units of the test of one block of
/// triangles. The same for all, so that what differs between them is the traversal.
pub const TRAVERSAL_COST: f64 = 0.4;

/// What things cost, in units of the test of one block of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Costs {
    /// A step through an inner node.
    pub traversal_cost: f64,
    /// Triangles that are tested at once, and the most that a leaf may hold.
    pub width: usize,
    /// How many a leaf must hold.
    pub fill: Fill,
}

/// How full leaves must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// As the heuristic likes it.
    Any,
    /// All leaves but one are full: M. Ernst and G. Greiner, "Multi Bounding Volume Hierarchies",
    /// 2008, where a split costs infinitely much unless one side is a multiple of the width. Then
    /// one chain of nodes alone carries the remainder.
    Full,
}

/// Depth below which builders split in the middle, whatever it costs, so that no input makes a
/// tree deeper than this and the logarithm of its triangles.
pub const DEPTH_OF_MIDDLE_SPLITS: usize = 64;

/// No tree of at most 2^32 triangles is deeper, see [`DEPTH_OF_MIDDLE_SPLITS`].
pub const MAX_DEPTH: usize = DEPTH_OF_MIDDLE_SPLITS + 32;

impl Costs {
    /// Whether `count` triangles in `bounds` are better left in one leaf than split into sides
    /// whose half areas sum to `split_area`.
    ///
    /// Either side costs one block, full or not, and the split a step more.
    pub fn prefers_leaf(&self, count: usize, bounds: &Aabb, split_area: f64) -> bool {
        self.must_be_leaf(count)
            || count <= self.width && (1.0 - self.traversal_cost) * bounds.half_area() <= split_area
    }

    /// Whether `count` triangles are a leaf whatever a split would cost.
    #[inline(always)]
    pub fn must_be_leaf(&self, count: usize) -> bool {
        count == 1 || (self.fill == Fill::Full && count <= self.width)
    }

    /// Whether `count` triangles may be split after the first `at`.
    #[inline(always)]
    pub fn allows(&self, count: usize, at: usize) -> bool {
        match self.fill {
            Fill::Any => true,
            Fill::Full => at.is_multiple_of(self.width) || (count - at).is_multiple_of(self.width),
        }
    }

    /// The place nearest to `at` where more triangles than a leaf holds may be split: never at
    /// either end.
    pub fn nearest_place(&self, count: usize, at: usize) -> usize {
        if self.fill == Fill::Any {
            return at;
        }
        let most = (count - 1) / self.width;
        let multiple = |n: usize| ((n + self.width / 2) / self.width).clamp(1, most) * self.width;
        let (front, back) = (multiple(at), count - multiple(count - at));
        if front.abs_diff(at) <= back.abs_diff(at) { front } else { back }
    }
}

/// A way to split: the sum over both sides of half area times count, and of half area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// What is minimised.
    pub cost: f64,
    /// Sum of both sides' half areas.
    pub area: f64,
    /// Along which axis.
    pub axis: usize,
    /// Where, in the builder's own terms.
    pub at: usize,
}

impl Split {
    /// Worse than any.
    pub const NONE: Self = Self { cost: f64::INFINITY, area: f64::INFINITY, axis: 0, at: 0 };

    /// The split of two sides with their boxes and counts.
    #[inline(always)]
    pub fn new(axis: usize, at: usize, left: (f64, usize), right: (f64, usize)) -> Self {
        Self {
            cost: expected_tests([left, right].map(|(area, count)| (area, count as f64))),
            area: left.0 + right.0,
            axis,
            at,
        }
    }

    /// The cheaper; the first of equals, so that the order of trials decides and nothing else.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_is_the_nearest_of_those_allowed() {
        for width in [1, 4, 8, 16] {
            let cost = Costs { traversal_cost: 0.4, width, fill: Fill::Full };
            for count in width + 1..5 * width {
                for at in 1..count {
                    let place = cost.nearest_place(count, at);
                    let off = |place: usize| place.abs_diff(at);
                    let best = (1..count).filter(|&place| cost.allows(count, place)).map(off).min();
                    assert!((1..count).contains(&place) && cost.allows(count, place));
                    assert_eq!(Some(off(place)), best, "{count} of {width} after {at}");
                }
            }
        }
    }
}
