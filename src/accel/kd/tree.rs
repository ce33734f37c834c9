//! The tree as builders make it and layouts read it, and what all walks share.

use std::sync::Arc;

use super::slack::Slack;
use crate::accel::BuildReport;
use crate::geom::{TriangleBlock, TriangleSource};
use crate::math::{Aabb, NodeId, TriangleId};

/// A leaf, numbered in the order of a depth-first walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct LeafId(pub u32);

impl LeafId {
    /// The index as one into a slice.
    #[inline(always)]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// A node in depth-first order: the child below the plane comes right after its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// Divides its cell.
    Inner {
        /// 0 to 2.
        axis: u8,
        /// Coordinate of the plane.
        split: f32,
        /// The child above it.
        above: NodeId,
    },
    /// Holds triangles.
    Leaf(LeafId),
}

/// A built kd-tree: plain data, from which layouts and links are derived.
#[derive(Clone, Debug)]
pub struct KdTree {
    /// The nodes, root first.
    pub nodes: Vec<Node>,
    /// What walks need beside the nodes.
    pub base: Arc<Base>,
    /// How it was built.
    pub report: BuildReport,
}

/// What all walks share, whatever the layout of the nodes.
pub struct Base {
    /// Box around all triangles, slack included.
    pub bounds: Aabb,
    /// By how much triangles were grown, and for which rays that is enough.
    pub slack: Slack,
    /// Whether leaves hold only triangles that touch their cell, not just their boxes.
    pub clipped: bool,
    /// The triangles of each leaf.
    pub leaves: Leaves,
    /// Where the triangles came from.
    pub source: Arc<dyn TriangleSource>,
}

impl std::fmt::Debug for Base {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Base").field("bounds", &self.bounds).finish_non_exhaustive()
    }
}

/// Triangles of a block.
pub const LANES: usize = 4;

/// Triangles to test at once.
pub type Block = TriangleBlock<LANES>;

/// The leaves' triangles, inline.
#[derive(Clone, Debug)]
pub struct Leaves {
    /// Leaf `i` has the blocks `starts[i]..starts[i + 1]`.
    starts: Vec<u32>,
    blocks: Vec<Block>,
}

impl Leaves {
    /// Packs lists of triangles, leaf after leaf; `ends[i]` is where the list of leaf `i` ends.
    /// `None` if there are too many blocks to number.
    pub fn new(source: &dyn TriangleSource, ids: &[TriangleId], ends: &[usize]) -> Option<Self> {
        let begins = || std::iter::once(&0).chain(ends);
        let count: usize = begins().zip(ends).map(|(a, b)| (b - a).div_ceil(LANES)).sum();
        u32::try_from(count).ok()?;
        let (mut starts, mut blocks) =
            (Vec::with_capacity(ends.len() + 1), Vec::with_capacity(count));
        starts.push(0);
        for (&begin, &end) in begins().zip(ends) {
            for ids in ids[begin..end].chunks(LANES) {
                let triangles = [ids.first(), ids.get(1), ids.get(2), ids.get(3)]
                    .map(|id| id.map(|&id| (id, source.triangle(id))));
                let present: Vec<_> = triangles.into_iter().flatten().collect();
                blocks.push(Block::new(&present));
            }
            starts.push(blocks.len() as u32);
        }
        Some(Self { starts, blocks })
    }

    /// How many leaves there are.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The triangles of a leaf.
    pub fn triangles(&self, leaf: LeafId) -> impl Iterator<Item = TriangleId> + '_ {
        let ids = self.blocks(leaf).iter().flat_map(|block| block.ids);
        ids.filter(|&id| id != TriangleId::NONE)
    }

    /// Where a leaf's blocks begin and end.
    #[inline(always)]
    pub fn blocks(&self, leaf: LeafId) -> &[Block] {
        match self.starts.get(leaf.index()..leaf.index() + 2) {
            Some(&[start, end]) => self.blocks.get(start as usize..end as usize).unwrap_or(&[]),
            _ => &[],
        }
    }

    /// Bytes of the parts, for reports.
    pub fn memory(&self) -> [(&'static str, usize); 2] {
        [("leaves", size_of_val(&*self.starts)), ("triangles", size_of_val(&*self.blocks))]
    }
}

impl KdTree {
    /// The cell of the root: all of space. Cells at the rim have no outer planes, so that they
    /// partition it, and a ray ends where it leaves [`Base::bounds`] instead.
    pub const SPACE: Aabb = Aabb { min: Aabb::EMPTY.max, max: Aabb::EMPTY.min };

    /// Calls `visit` with each node, its cell and its depth, parents first, below before above.
    pub fn for_each_cell(&self, cell: Aabb, mut visit: impl FnMut(NodeId, &Aabb, usize)) {
        let mut todo = vec![(NodeId(0), cell, 0)];
        while let Some((at, cell, depth)) = todo.pop() {
            visit(at, &cell, depth);
            if let Node::Inner { axis, split, above } = self.nodes[at.index()] {
                let [low, high] = halves(&cell, axis as usize, split);
                todo.push((above, high, depth + 1));
                todo.push((NodeId(at.0 + 1), low, depth + 1));
            }
        }
    }
}

/// The parts of a cell below and above a plane.
#[inline]
pub fn halves(cell: &Aabb, axis: usize, split: f32) -> [Aabb; 2] {
    let (mut low, mut high) = (*cell, *cell);
    low.max[axis] = split;
    high.min[axis] = split;
    [low, high]
}
