//! Some trees, in one piece of memory, with room behind them for what else is walked to.
//!
//! Those of meshes are small, most of them; by themselves they would lie on small pages, and a walk
//! would wait for their addresses: on a hall of 700 parts that took a third of the time.

use crate::accel::BuildError;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::{Arena, Stripes};
use crate::accel::bvh::wide::wide_bvh::WideBvh;

/// Lanes of a vector, children of a node.
pub const W: usize = 8;

/// Hierarchies of eight children that store what is in their leaves, and room behind them.
pub struct Trees {
    arena: Arena<W>,
    roots: Vec<Option<Link>>,
    /// Where that room begins.
    end: usize,
}

impl Trees {
    /// Moves trees together behind the first one, with room for `more` stripes behind them. The
    /// first stays where it is if it has room for the others.
    ///
    /// # Errors
    /// If there is not as much memory: a tree more than they take by themselves.
    pub fn new(
        first: WideBvh<W>,
        others: Vec<Option<WideBvh<W>>>,
        more: usize,
    ) -> Result<Self, BuildError> {
        let count = first.count_stripes() + count_stripes(&others) + more;
        let (mut roots, mut end) = (vec![first.root], first.count_stripes());
        let mut arena = if first.arena.stripes().count() >= count {
            first.arena
        } else {
            let mut arena = WideBvh::reserve(count)?;
            first.copy_to(arena.floats_mut(), 0);
            drop(first);
            arena
        };
        for tree in others {
            roots.push(tree.and_then(|tree| {
                let root = tree.copy_to(arena.floats_mut(), end);
                end += tree.count_stripes();
                root
            }));
        }
        Ok(Self { arena, roots, end })
    }

    /// The root of a tree; `None` where there is nothing.
    #[inline(always)]
    pub fn root(&self, tree: usize) -> Option<Link> {
        self.roots[tree]
    }

    /// What the roots lead into.
    #[inline(always)]
    pub fn stripes(&self) -> Stripes<'_, W> {
        self.arena.stripes()
    }

    /// The room behind them.
    pub fn room_mut(&mut self) -> &mut [[f32; W]] {
        &mut self.arena.floats_mut()[self.end..]
    }
}

/// How many stripes trees take.
pub fn count_stripes(trees: &[Option<WideBvh<W>>]) -> usize {
    trees.iter().flatten().map(WideBvh::count_stripes).sum()
}
