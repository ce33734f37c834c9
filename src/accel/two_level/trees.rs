//! Some trees, in one piece of memory.
//!
//! Those of meshes are small, most of them; by themselves they would lie on small pages, and a walk
//! would wait for their addresses: on a hall of 700 parts that took a third of the time.

use crate::accel::BuildError;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::{Arena, Stripes};
use crate::accel::bvh::wide::wide_bvh::WideBvh;

/// Lanes of a vector, children of a node.
pub const W: usize = 8;

/// Hierarchies of eight children that store what is in their leaves.
pub struct Trees {
    arena: Arena<W>,
    roots: Vec<Option<Link>>,
}

impl Trees {
    /// One tree, which stays where it is.
    pub fn single(tree: WideBvh<W>) -> Self {
        Self { roots: vec![tree.root], arena: tree.arena }
    }

    /// Moves trees together; `None` if there are too many nodes to link to.
    ///
    /// # Errors
    /// If there is not as much memory: a tree more than they take by themselves.
    pub fn new(trees: Vec<Option<WideBvh<W>>>) -> Result<Option<Self>, BuildError> {
        let count = trees.iter().flatten().map(|tree| tree.arena.stripes().count()).sum();
        if count >= Link::LIMIT {
            return Ok(None);
        }
        let mut arena = Arena::new(count)
            .map_err(|_| BuildError::NoMemory { needed: (count * size_of::<[f32; 8]>()) as u64 })?;
        let (mut roots, mut first) = (Vec::with_capacity(trees.len()), 0);
        for tree in trees {
            roots.push(tree.and_then(|tree| {
                let root = tree.copy_to(arena.floats_mut(), first);
                first += tree.arena.stripes().count();
                root
            }));
        }
        Ok(Some(Self { arena, roots }))
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

    /// Bytes of all trees.
    pub fn bytes(&self) -> usize {
        self.arena.bytes()
    }
}
