//! Havran's recursive traversal TA-rec-B: children by where a span's end points lie.
//!
//! - V. Havran, "Heuristic ray shooting algorithms", PhD thesis, 2000, 4.3; V. Havran, T. Kopal,
//!   J. Bittner, J. Žára, "Fast robust BSP tree traversal algorithm for ray tracing", 1997.
//!
//! The stack holds the points where the span meets planes, the coordinate along the plane's axis
//! being the split itself. A node is decided by two comparisons of coordinates with the split,
//! and a distance is needed only where both children are crossed. Zeros in the direction need no
//! care at all.
//!
//! Points are rounded otherwise than distances, so where a ray passes close to an edge of a cell
//! this walk may visit another leaf than the others do: one whose cell, grown by the rounding, has
//! the point in it. The slack is wide enough for that (see [`crate::accel::kd`]).

use super::interface::Walk;
use super::todo::LEVELS;
use super::visit::Visit;
use crate::accel::kd::layout::{Layout, Nodes, View};
use crate::accel::kd::ray::{KdRay, Span};
use crate::accel::kd::tree::KdTree;
use crate::accel::{BuildError, Counters, Event, Query};
use crate::math::{NodeId, larger, smaller};

/// Walks by points.
#[derive(Debug)]
pub struct PlanePoints<L> {
    layout: L,
}

impl<L: Layout> PlanePoints<L> {
    /// Lays a tree out to walk it.
    ///
    /// # Errors
    /// If the tree is too deep for the stack.
    pub fn new(tree: &KdTree) -> Result<Self, BuildError> {
        if tree.depth() > LEVELS {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: LEVELS });
        }
        Ok(Self { layout: L::new(tree) })
    }
}

/// A point of the ray.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    t: f32,
    /// The fourth is never used: it spares a check.
    coordinates: [f32; 4],
}

impl Point {
    #[inline(always)]
    fn new(ray: &KdRay, t: f32) -> Self {
        Self { t, coordinates: [ray.at(0, t), ray.at(1, t), ray.at(2, t), 0.0] }
    }

    #[inline(always)]
    fn on_plane(ray: &KdRay, t: f32, axis: usize, split: f32) -> Self {
        let mut point = Self::new(ray, t);
        point.coordinates[axis & 3] = split;
        point
    }
}

impl<L: Layout> Walk for PlanePoints<L> {
    type Scratch = [(NodeId, Point); LEVELS];

    fn nodes(&self) -> &dyn Nodes {
        &self.layout
    }

    fn scratch(&self) -> Self::Scratch {
        [(NodeId::NONE, Point { t: 0.0, coordinates: [0.0; 4] }); LEVELS]
    }

    #[inline(never)]
    fn walk<Q: Query, C: Counters>(
        &self,
        visit: &mut Visit<'_, Q, C>,
        span: Span,
        stack: &mut Self::Scratch,
    ) {
        let ray = visit.kd_ray;
        let (mut enter, mut exit) = (Point::new(&ray, span.enter), Point::new(&ray, span.exit));
        let mut at = self.layout.root();
        let mut pending = 0;
        loop {
            let leaf = loop {
                let (axis, split, [below, above]) = match self.layout.view(at) {
                    View::Inner { axis, split, children } => (axis, split, children),
                    View::Leaf(leaf) => break leaf,
                };
                visit.counters.count(Event::InnerNode);
                let (from, to) = (enter.coordinates[axis & 3], exit.coordinates[axis & 3]);
                let (near, far) = if from <= split {
                    if to <= split {
                        at = below;
                        continue;
                    }
                    (below, above)
                } else {
                    if to > split {
                        at = above;
                        continue;
                    }
                    (above, below)
                };
                visit.counters.count(Event::Push);
                stack[pending & (LEVELS - 1)] = (far, exit);
                pending += 1;
                let t_split = smaller(larger(ray.t_split(axis, split), enter.t), exit.t);
                (at, exit) = (near, Point::on_plane(&ray, t_split, axis, split));
            };
            if visit.ends_in_leaf(leaf, exit.t) || pending == 0 {
                return;
            }
            pending -= 1;
            enter = exit;
            (at, exit) = stack[pending & (LEVELS - 1)];
        }
    }
}
