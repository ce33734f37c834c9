//! Front-to-back traversal, one ray at a time.
//!
//! The recursive traversal of the review (section 3.2, algorithm 2) with the recursion unrolled.
//! What it does with the farther child is the policy `T`.

use std::marker::PhantomData;

use fearless_simd::Simd;

use super::super::layout::{Layout, View};
use super::super::ray::{Crossing, KdRay, Span};
use super::super::tree::{Base, KdTree};
use super::Walk;
use super::stack::Todo;
use crate::accel::{BuildError, Counters, Event, Query, Shot};

/// Visits the leaves along a ray in order, keeping farther children in a `T`.
#[derive(Debug)]
pub struct FrontToBack<L, T> {
    layout: L,
    todo: PhantomData<fn() -> T>,
}

impl<L: Layout, T: Todo> FrontToBack<L, T> {
    /// Lays a tree out to walk it.
    ///
    /// # Errors
    /// If the tree is too deep for the to-do list.
    pub fn new(tree: &KdTree) -> Result<Self, BuildError> {
        if tree.depth() > T::CAPACITY {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: T::CAPACITY });
        }
        Ok(Self { layout: L::new(tree), todo: PhantomData })
    }
}

impl<L: Layout, T: Todo> Walk for FrontToBack<L, T> {
    type Layout = L;
    type Scratch = T;

    fn layout(&self) -> &L {
        &self.layout
    }

    fn scratch(&self) -> T {
        T::default()
    }

    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        base: &Base,
        ray: &KdRay,
        mut span: Span,
        shot: &Shot<'_>,
        query: &mut Q,
        todo: &mut T,
        counters: &mut C,
    ) {
        todo.clear();
        let mut at = self.layout.root();
        loop {
            let leaf = loop {
                match self.layout.view(at) {
                    View::Leaf(leaf) => break leaf,
                    View::Inner { axis, split, children } => {
                        counters.count(Event::InnerNode);
                        let t_split = ray.t_split(axis, split);
                        let near = ray.near(axis);
                        at = match Crossing::of(t_split, span) {
                            Crossing::Far => children[1 - near],
                            Crossing::Near => children[near],
                            Crossing::Both => {
                                counters.count(Event::Push);
                                todo.push(children[1 - near], span.exit);
                                span.exit = t_split;
                                children[near]
                            }
                        };
                    }
                }
            };
            if base.leaves.test(simd, leaf, shot, query, counters).is_break()
                || query.t_max() < span.exit
            {
                return;
            }
            let Some((far, exit)) = todo.pop() else { return };
            (at, span) = (far, Span { enter: span.exit, exit });
        }
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        Vec::new()
    }
}
