//! The surface area heuristic.
//!
//! J. Goldsmith and J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987;
//! J. D. MacDonald and K. S. Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990.

use crate::math::Aabb;

/// What things cost, in units of the test of one block of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// A step through an inner node.
    pub traversal: f64,
    /// Triangles that are tested at once, and the most that a leaf may hold.
    pub width: usize,
}

/// Depth below which builders split in the middle, whatever it costs, so that no input makes a
/// tree deeper than this and the logarithm of its triangles.
pub const DEPTH_OF_MIDDLE_SPLITS: usize = 64;

/// No tree of at most 2^32 triangles is deeper, see [`DEPTH_OF_MIDDLE_SPLITS`].
pub const MAX_DEPTH: usize = DEPTH_OF_MIDDLE_SPLITS + 32;

impl Cost {
    /// Whether `count` triangles in `bounds` are better left in one leaf than split into sides
    /// whose half areas sum to `split_area`.
    ///
    /// Either side costs one block, full or not, and the split a step more.
    pub fn prefers_leaf(&self, count: usize, bounds: &Aabb, split_area: f64) -> bool {
        count <= self.width && (1.0 - self.traversal) * bounds.half_area() <= split_area
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
            cost: left.0 * left.1 as f64 + right.0 * right.1 as f64,
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
