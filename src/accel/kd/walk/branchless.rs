//! Front-to-back traversal without branches between children.
//!
//! Both children are written to the stack and its pointer is moved by comparisons, so that what
//! should be next ends up on top (M. Hapala 2009; section 5.5 and algorithm 5 of the review).
//!
//! Two differences: an entry has no `enter`, since that is where the last leaf was left; and the
//! farther child also counts as crossed where it is the only one by the tie rule, which matters
//! when a span is a single point.

use super::interface::Walk;
use super::todo::LEVELS;
use super::visit::Visit;
use crate::accel::kd::layout::{Layout, Nodes, View};
use crate::accel::kd::ray::Span;
use crate::accel::kd::tree::KdTree;
use crate::accel::{BuildError, Counters, Event, Query};
use crate::math::{NodeId, smaller};

/// Walks by a stack pointer moved by comparisons.
#[derive(Debug)]
pub struct Branchless<L> {
    layout: L,
}

impl<L: Layout> Branchless<L> {
    /// Lays a tree out to walk it.
    ///
    /// # Errors
    /// If the tree is too deep for the stack.
    pub fn new(tree: &KdTree) -> Result<Self, BuildError> {
        const LIMIT: usize = LEVELS - 2;
        if tree.depth() > LIMIT {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: LIMIT });
        }
        Ok(Self { layout: L::new(tree) })
    }
}

impl<L: Layout> Walk for Branchless<L> {
    type Scratch = [(NodeId, f32); LEVELS];

    fn nodes(&self) -> &dyn Nodes {
        &self.layout
    }

    fn scratch(&self) -> Self::Scratch {
        [(NodeId::NONE, 0.0); LEVELS]
    }

    #[inline(never)]
    fn walk<Q: Query, C: Counters>(
        &self,
        visit: &mut Visit<'_, Q, C>,
        span: Span,
        stack: &mut Self::Scratch,
    ) {
        const MASK: usize = LEVELS - 1;
        let mut enter = span.enter;
        let mut top = 0;
        stack[0] = (self.layout.root(), span.exit);
        loop {
            let (at, exit) = stack[top & MASK];
            match self.layout.view(at) {
                View::Inner { axis, split, children } => {
                    visit.counters.count(Event::InnerNode);
                    let t_split = visit.kd_ray.t_split(axis, split);
                    let near = visit.kd_ray.near(axis);
                    let skip_near = t_split <= enter;
                    let cross_far = u8::from(skip_near) | u8::from(t_split < exit);
                    stack[top & MASK] = (children[1 - near], exit);
                    top += usize::from(cross_far);
                    stack[top & MASK] = (children[near], smaller(t_split, exit));
                    top -= usize::from(skip_near);
                    visit.counters.add(Event::Push, u64::from(cross_far & u8::from(!skip_near)));
                }
                View::Leaf(leaf) => {
                    if visit.ends_in_leaf(leaf, exit) || top == 0 {
                        return;
                    }
                    enter = exit;
                    top -= 1;
                }
            }
        }
    }
}
