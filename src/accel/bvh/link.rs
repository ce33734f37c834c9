//! Links from nodes to what is below them.

/// The place of a node, or with the highest bit set that of a leaf. What a place counts is the
/// structure's own affair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Link(pub u32);

impl Link {
    /// So many places can be linked to.
    pub const LIMIT: usize = 1 << 31;
    /// What tells links to leaves.
    pub const LEAF: u32 = 1 << 31;

    /// To a node.
    pub fn to_node(place: usize) -> Self {
        Self(place as u32)
    }

    /// To a leaf.
    pub fn to_leaf(place: usize) -> Self {
        Self(place as u32 | Self::LEAF)
    }

    /// The same link where all places are moved by so many.
    #[must_use]
    pub fn moved(self, by: u32) -> Self {
        Self(self.0 + by)
    }

    /// Whether it leads to a leaf.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The place of what it leads to.
    #[inline(always)]
    pub fn place(self) -> usize {
        (self.0 & !Self::LEAF) as usize
    }
}
