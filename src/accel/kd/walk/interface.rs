//! What walks of single rays have in common.

use super::visit::Visit;
use crate::accel::kd::layout::Nodes;
use crate::accel::kd::ray::Span;
use crate::accel::{Counters, Query};

/// A way through a tree.
///
/// Given a tame ray and the part of it inside the root's box, a walk tests the leaves that the
/// span crosses, front to back, until a hit is strictly before what is left. Rays that are not
/// tame never come here.
pub trait Walk: Send + Sync {
    /// What a thread needs.
    type Scratch: Send;

    /// The nodes.
    fn nodes(&self) -> &dyn Nodes;

    /// Fresh scratch for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// Visits the leaves along the ray of `visit` within `span`, until its query is answered.
    fn walk<Q: Query, C: Counters>(
        &self,
        visit: &mut Visit<'_, Q, C>,
        span: Span,
        scratch: &mut Self::Scratch,
    );

    /// Bytes of what it derived from the tree, the nodes aside.
    fn memory(&self) -> Vec<(&'static str, usize)> {
        Vec::new()
    }
}
