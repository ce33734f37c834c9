//! From leaf to leaf: where one ends, find the one that begins there.
//!
//! Where to begin the search is the policy `N`: at the root, which is Kaplan's sequential
//! traversal (section 3.1 and algorithm 1 of the review), or behind the face by which the leaf was
//! left, by links between neighbours (section 3.3). No stack is needed.
//!
//! The distance at which a leaf was left is compared with the distances of planes; no point is
//! located and nothing is moved on by an epsilon. A link crosses its plane by construction. Where
//! planes of several axes have the same distance, links lead through leaves of no length, which
//! are not tested: so those that are tested are the same as in every other walk.

use super::interface::Walk;
use super::visit::Visit;
use crate::accel::kd::layout::{Compact, Layout, Nodes, View};
use crate::accel::kd::ray::{KdRay, Span};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::accel::{Counters, Event, Query};
use crate::math::{Aabb, NodeId};

/// Where to look for the next leaf.
pub trait Next: Send + Sync {
    /// Derives what is needed from a tree.
    fn new(tree: &KdTree) -> Self;

    /// The nodes to search; `main` are the tree's own.
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact;

    /// A leaf's cell; planes at the rim are infinite.
    fn cell(&self, leaf: LeafId) -> &Aabb;

    /// The node to begin at behind the lower (0) or upper (1) face along an axis;
    /// [`NodeId::NONE`] at the rim.
    fn behind(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId;

    /// What it counts as.
    const EVENT: Option<Event>;

    /// Bytes by part.
    fn memory(&self) -> Vec<(&'static str, usize)>;
}

/// Walks from leaf to leaf.
#[derive(Debug)]
pub struct LeafByLeaf<N> {
    layout: Compact,
    next: N,
}

impl<N: Next> LeafByLeaf<N> {
    /// Lays a tree out and derives what is needed.
    pub fn new(tree: &KdTree) -> Self {
        Self { layout: Compact::new(tree), next: N::new(tree) }
    }
}

impl<N: Next> Walk for LeafByLeaf<N> {
    type Scratch = ();

    fn nodes(&self) -> &dyn Nodes {
        &self.layout
    }

    fn scratch(&self) {}

    #[inline(never)]
    fn walk<Q: Query, C: Counters>(&self, visit: &mut Visit<'_, Q, C>, span: Span, (): &mut ()) {
        let ray = visit.kd_ray;
        let mut enter = span.enter;
        let mut leaf = locate(&self.layout, self.layout.root(), &ray, enter, visit.counters);
        loop {
            let (exit, axis) = ray.exit(self.next.cell(leaf));
            if exit > enter {
                if visit.ends_in_leaf(leaf, exit) || exit >= span.exit {
                    return;
                }
                enter = exit;
            }
            let behind = self.next.behind(leaf, axis, 1 - ray.near(axis));
            if behind == NodeId::NONE {
                return;
            }
            if let Some(event) = N::EVENT {
                visit.counters.count(event);
            }
            leaf = locate(self.next.nodes(&self.layout), behind, &ray, enter, visit.counters);
        }
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        self.next.memory()
    }
}

/// The leaf at a distance along a ray, searched from a node on: beyond every plane that is met at
/// or before that distance.
#[inline(always)]
fn locate<C: Counters>(
    nodes: &Compact,
    mut at: NodeId,
    ray: &KdRay,
    t: f32,
    counters: &mut C,
) -> LeafId {
    loop {
        match nodes.view(at) {
            View::Leaf(leaf) => return leaf,
            View::Inner { axis, split, children } => {
                counters.count(Event::InnerNode);
                let near = ray.near(axis);
                at = children[if ray.t_split(axis, split) <= t { 1 - near } else { near }];
            }
        }
    }
}

/// Begins at the root again and again; needs the cells of leaves only.
#[derive(Debug)]
pub struct FromRoot {
    cells: Vec<Aabb>,
}

impl Next for FromRoot {
    const EVENT: Option<Event> = Some(Event::Restart);

    fn new(tree: &KdTree) -> Self {
        let mut cells = Vec::with_capacity(tree.base.leaves.count());
        tree.for_each_cell(KdTree::SPACE, |at, cell, _| {
            if let Node::Leaf(_) = tree.nodes[at.index()] {
                cells.push(*cell);
            }
        });
        Self { cells }
    }

    #[inline(always)]
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact {
        main
    }

    #[inline(always)]
    fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.cells[leaf.index()]
    }

    #[inline(always)]
    fn behind(&self, _: LeafId, _: usize, _: usize) -> NodeId {
        NodeId(0)
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        vec![("boxes", size_of_val(&*self.cells))]
    }
}
