//! What a walk does with the farther child: the policies of the to-do list.

use crate::math::NodeId;

/// Levels that stacks hold; a power of two, so that a mask keeps an index inside.
pub const LEVELS: usize = 64;

/// Keeps farther children for later, with where their spans end. Where one begins need not be
/// kept: it is where the last one ended (Zlatuška and Havran 2010).
pub trait Todo: Send {
    /// The deepest tree that it can serve.
    const CAPACITY: usize;
    /// Whether what was pushed may be lost, so that the walk must be able to begin again.
    const FORGETS: bool = false;
    /// Whether it then begins at the deepest node that holds all that is left, not at the root.
    const PUSH_DOWN: bool = false;

    /// An empty one; `entries` is the size of the short part, if it has one.
    fn new(entries: usize) -> Self;

    /// Drops all entries.
    fn clear(&mut self);

    /// Keeps a node.
    fn push(&mut self, far: NodeId, exit: f32);

    /// The node that was kept last.
    fn pop(&mut self) -> Option<(NodeId, f32)>;
}

type Entries = [(NodeId, f32); LEVELS];

const EMPTY: Entries = [(NodeId::NONE, 0.0); LEVELS];

/// The textbook stack.
#[derive(Debug)]
pub struct Full {
    entries: Entries,
    len: usize,
}

impl Todo for Full {
    const CAPACITY: usize = LEVELS;

    fn new(_: usize) -> Self {
        Self { entries: EMPTY, len: 0 }
    }

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

/// Keeps nothing: T. Foley, J. Sugerman, "KD-tree acceleration structures for a GPU raytracer",
/// 2005; with push-down: D. Horn et al., "Interactive k-D tree GPU raytracing", 2007.
#[derive(Debug)]
pub struct Nothing<const PUSH_DOWN: bool>;

impl<const PUSH_DOWN: bool> Todo for Nothing<PUSH_DOWN> {
    const CAPACITY: usize = usize::MAX;
    const FORGETS: bool = true;
    const PUSH_DOWN: bool = PUSH_DOWN;

    fn new(_: usize) -> Self {
        Self
    }

    #[inline(always)]
    fn clear(&mut self) {}

    #[inline(always)]
    fn push(&mut self, _: NodeId, _: f32) {}

    #[inline(always)]
    fn pop(&mut self) -> Option<(NodeId, f32)> {
        None
    }
}

/// A short stack: keeps the last few and forgets the others (Horn et al. 2007).
#[derive(Debug)]
pub struct Ring {
    entries: Entries,
    capacity: usize,
    /// Counts pushes less pops; its place in the ring is that modulo [`LEVELS`].
    top: usize,
    len: usize,
}

impl Todo for Ring {
    const CAPACITY: usize = usize::MAX;
    const FORGETS: bool = true;
    const PUSH_DOWN: bool = true;

    fn new(entries: usize) -> Self {
        Self { entries: EMPTY, capacity: entries.clamp(1, LEVELS), top: 0, len: 0 }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.len = 0;
    }

    #[inline(always)]
    fn push(&mut self, far: NodeId, exit: f32) {
        self.entries[self.top & (LEVELS - 1)] = (far, exit);
        self.top = self.top.wrapping_add(1);
        self.len = (self.len + 1).min(self.capacity);
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(NodeId, f32)> {
        if self.len == 0 {
            return None;
        }
        self.len -= 1;
        self.top = self.top.wrapping_sub(1);
        Some(self.entries[self.top & (LEVELS - 1)])
    }
}

/// A short stack whose bottom spills into a large one instead of being lost (J. Novák 2009,
/// figure 8 of the review).
#[derive(Debug)]
pub struct Spill {
    short: Ring,
    spilled: Full,
}

impl Todo for Spill {
    const CAPACITY: usize = LEVELS;

    fn new(entries: usize) -> Self {
        Self { short: Ring::new(entries), spilled: Full::new(0) }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.short.clear();
        self.spilled.clear();
    }

    #[inline(always)]
    fn push(&mut self, far: NodeId, exit: f32) {
        let short = &mut self.short;
        if short.len == short.capacity {
            let bottom = short.top.wrapping_sub(short.len);
            let (node, exit) = short.entries[bottom & (LEVELS - 1)];
            self.spilled.push(node, exit);
        }
        short.push(far, exit);
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(NodeId, f32)> {
        self.short.pop().or_else(|| self.spilled.pop())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drained<T: Todo>(entries: usize, pushed: u32) -> Vec<u32> {
        let mut todo = T::new(entries);
        todo.push(NodeId(99), 0.0);
        todo.clear();
        for i in 0..pushed {
            todo.push(NodeId(i), i as f32);
        }
        std::iter::from_fn(|| todo.pop()).map(|(node, _)| node.0).collect()
    }

    #[test]
    fn what_was_pushed_last_comes_first_and_short_stacks_keep_the_last_few() {
        assert_eq!(drained::<Full>(0, 4), [3, 2, 1, 0]);
        assert_eq!(drained::<Ring>(3, 5), [4, 3, 2]);
        assert_eq!(drained::<Spill>(2, 5), [4, 3, 2, 1, 0]);
        assert_eq!(drained::<Nothing<true>>(0, 5), [0_u32; 0]);
    }
}
