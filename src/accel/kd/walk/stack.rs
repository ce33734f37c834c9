//! What a walk does with the farther child: the policies of the to-do list.

use crate::math::NodeId;

/// Levels that stacks hold; a power of two, so that a mask keeps an index inside.
pub const LEVELS: usize = 64;

/// Keeps farther children for later, with where their spans end. Where one begins need not be
/// kept: it is where the last one ended (Zlatuška and Havran 2010).
pub trait Todo: Default + Send {
    /// The deepest tree that it can serve.
    const CAPACITY: usize;

    /// Forgets all.
    fn clear(&mut self);

    /// Keeps a node.
    fn push(&mut self, far: NodeId, exit: f32);

    /// The node that was kept last.
    fn pop(&mut self) -> Option<(NodeId, f32)>;
}

/// The textbook stack.
#[derive(Debug)]
pub struct Full {
    entries: [(NodeId, f32); LEVELS],
    len: usize,
}

impl Default for Full {
    fn default() -> Self {
        Self { entries: [(NodeId::NONE, 0.0); LEVELS], len: 0 }
    }
}

impl Todo for Full {
    const CAPACITY: usize = LEVELS;

    #[inline(always)]
    fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    fn push(&mut self, far: NodeId, exit: f32) {
        self.entries[self.len & (LEVELS - 1)] = (far, exit);
        self.len += 1;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(NodeId, f32)> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        Some(self.entries[self.len & (LEVELS - 1)])
    }
}
