//! Front-to-back traversal, one ray at a time.
//!
//! The recursive traversal of the review (section 3.2, algorithm 2) with the recursion unrolled.
//! How the near child is told is the policy `K`; what is done with the farther one is the policy
//! `T`: a list that forgets makes the loop begin again, at the root (section 5.1) or at the deepest
//! node that is known to hold all that is left of the ray (section 5.2, algorithm 4).
//!
//! After each leaf the walk goes on exactly where it left off, not a little further.

use std::marker::PhantomData;

use super::interface::Walk;
use super::todo::Todo;
use super::visit::Visit;
use crate::accel::kd::layout::{Layout, Nodes, View};
use crate::accel::kd::ray::{Crossing, KdRay, Span};
use crate::accel::kd::tree::KdTree;
use crate::accel::{BuildError, Counters, Event, Query};

/// How the near child is told from the far one.
pub trait Classify: Send + Sync {
    /// Which child is near, 0 below and 1 above, where the plane is, and which children are
    /// crossed.
    fn classify(ray: &KdRay, axis: usize, split: f32, span: Span) -> (usize, f32, Crossing);
}

/// By the ray's direction (Keller 1997, Wald 2004): the near child is the one that it comes from.
#[derive(Debug)]
pub struct ByDirection;

impl Classify for ByDirection {
    #[inline(always)]
    fn classify(ray: &KdRay, axis: usize, split: f32, span: Span) -> (usize, f32, Crossing) {
        let t_split = ray.t_split(axis, split);
        (ray.near(axis), t_split, Crossing::of(t_split, span))
    }
}

/// By the ray's origin (Jansen 1986, Arvo 1988): the near child is the one with the origin.
///
/// A plane behind the origin is told by the sign of its distance, zeros included. An origin in the
/// plane belongs below it: then a ray that goes up is beyond the plane at distance zero, and for
/// one that goes down the distance is a negative zero and it stays below.
#[derive(Debug)]
pub struct ByOrigin;

impl Classify for ByOrigin {
    #[inline(always)]
    fn classify(ray: &KdRay, axis: usize, split: f32, span: Span) -> (usize, f32, Crossing) {
        let t_split = ray.t_split(axis, split);
        let near = usize::from(ray.origin(axis) > split);
        let crossing =
            if t_split.is_sign_negative() { Crossing::Near } else { Crossing::of(t_split, span) };
        (near, t_split, crossing)
    }
}

/// Visits the leaves along a ray in order, keeping farther children in a `T`.
#[derive(Debug)]
pub struct FrontToBack<L, K, T> {
    layout: L,
    entries: usize,
    policies: PhantomData<fn() -> (K, T)>,
}

impl<L: Layout, K: Classify, T: Todo> FrontToBack<L, K, T> {
    /// Lays a tree out to walk it; `entries` is the size of a short stack.
    ///
    /// # Errors
    /// If the tree is too deep for the to-do list.
    pub fn new(tree: &KdTree, entries: usize) -> Result<Self, BuildError> {
        if tree.depth() > T::CAPACITY {
            return Err(BuildError::TooDeep { depth: tree.depth(), limit: T::CAPACITY });
        }
        Ok(Self { layout: L::new(tree), entries, policies: PhantomData })
    }

    /// The nodes.
    pub fn layout(&self) -> &L {
        &self.layout
    }
}

impl<L: Layout, K: Classify, T: Todo> Walk for FrontToBack<L, K, T> {
    type Scratch = T;

    fn nodes(&self) -> &dyn Nodes {
        &self.layout
    }

    fn scratch(&self) -> T {
        T::new(self.entries)
    }

    #[inline(never)]
    fn walk<Q: Query, C: Counters>(
        &self,
        visit: &mut Visit<'_, Q, C>,
        mut span: Span,
        todo: &mut T,
    ) {
        todo.clear();
        let end = span.exit;
        let mut at = self.layout.root();
        let (mut restart_at, mut single_path) = (at, true);
        loop {
            let leaf = loop {
                let (axis, split, children) = match self.layout.view(at) {
                    View::Inner { axis, split, children } => (axis, split, children),
                    View::Leaf(leaf) => break leaf,
                };
                visit.counters.count(Event::InnerNode);
                let (near, t_split, crossing) = K::classify(&visit.kd_ray, axis, split, span);
                match crossing {
                    Crossing::Far => at = children[1 - near],
                    Crossing::Near => at = children[near],
                    Crossing::Both => {
                        visit.counters.count(Event::Push);
                        todo.push(children[1 - near], span.exit);
                        (at, span.exit, single_path) = (children[near], t_split, false);
                    }
                }
                if T::PUSH_DOWN && single_path {
                    restart_at = at; // all that is left of the ray lies in here
                }
            };
            if visit.ends_in_leaf(leaf, span.exit) {
                return;
            }
            (at, span) = match todo.pop() {
                Some((far, exit)) => (far, Span { enter: span.exit, exit }),
                None if T::FORGETS && span.exit < end => {
                    visit.counters.count(Event::Restart);
                    single_path = true;
                    (restart_at, Span { enter: span.exit, exit: end })
                }
                None => return,
            };
        }
    }
}
