//! The tree as builders make it and layouts read it, and what all walks share.

use std::sync::Arc;

use fearless_simd::{Simd, SimdBase, f32x4};
use rayon::prelude::*;

use super::slack::Slack;
use crate::accel::BuildReport;
use crate::geom::{Triangle, TriangleBlock, TriangleSource};
use crate::math::{Aabb, NodeId, PrimId};
use crate::simd::prefetch;

/// A leaf, numbered in the order of a depth-first walk.
///
/// Says by itself whether it is empty, as most leaves are that a ray visits: so a walk need not
/// look their lists up. 31 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct LeafId(pub u32);

impl LeafId {
    const EMPTY: u32 = 1 << 30;

    /// The leaf of that number.
    pub fn new(number: usize, is_empty: bool) -> Self {
        Self(number as u32 | if is_empty { Self::EMPTY } else { 0 })
    }

    /// The number as an index into a slice.
    #[inline(always)]
    pub const fn index(self) -> usize {
        (self.0 & !Self::EMPTY) as usize
    }

    /// Whether it has no triangles.
    #[inline(always)]
    pub const fn is_empty(self) -> bool {
        self.0 & Self::EMPTY != 0
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

/// Triangles that are tested at once.
pub const LANES: usize = 4;

/// Triangles to test at once.
pub type Block = TriangleBlock<LANES>;

/// The leaves' triangles: lists of places in one table of vertices.
///
/// The table is in the order in which leaves first name the triangles, so that those of a leaf, and
/// of its neighbours, lie close together.
///
/// Blocks stored in the leaves spare their assembly and two cache misses, for several times the
/// memory, as a triangle is in two to four leaves: [`super::wide_nodes`] has them.
#[derive(Clone, Debug)]
pub struct Leaves {
    /// Leaf `i` has the slots `starts[i]..starts[i + 1]`.
    starts: Vec<u32>,
    slots: Vec<Slot>,
    vertices: Vec<Corners>,
}

/// A triangle's corners, each padded to a vector; the first's padding is the triangle's id, as
/// bits.
pub type Corners = [[f32; 4]; 3];

/// A triangle's place in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Slot(u32);

impl Slot {
    /// Its place in the table.
    #[inline(always)]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl Leaves {
    /// Keeps lists of triangles, leaf after leaf; `ends[i]` is where the list of leaf `i` ends.
    /// `None` if there are too many to number.
    pub fn new(source: &dyn TriangleSource, ids: Vec<PrimId>, ends: &[usize]) -> Option<Self> {
        u32::try_from(ids.len()).ok()?;
        let starts = std::iter::once(0).chain(ends.iter().map(|&end| end as u32)).collect();
        let (slots, order) = number_by_use(ids, source.len());
        let corners = |&id: &PrimId| {
            let Triangle { a, b, c } = source.triangle(id);
            let mut corners = [a, b, c].map(|p| [p.x, p.y, p.z, 0.0]);
            corners[0][3] = f32::from_bits(id.0);
            corners
        };
        let vertices = order.par_iter().map(corners).collect();
        Some(Self { starts, slots, vertices })
    }

    /// How many leaves there are.
    pub fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Where a leaf's list begins and ends.
    #[inline(always)]
    pub fn range(&self, leaf: LeafId) -> (u32, u32) {
        match self.starts.get(leaf.index()..leaf.index() + 2) {
            Some(&[start, end]) => (start, end),
            _ => (0, 0),
        }
    }

    /// Prefetches where a leaf's list begins and ends.
    #[inline(always)]
    pub fn prefetch_range(&self, leaf: LeafId) {
        prefetch(&self.starts, leaf.index(), 2 * size_of::<u32>());
    }

    /// Prefetches a leaf's list.
    #[inline(always)]
    pub fn prefetch_list(&self, leaf: LeafId) {
        let (start, end) = self.range(leaf);
        prefetch(&self.slots, start as usize, (end - start) as usize * size_of::<Slot>());
    }

    /// Prefetches a leaf's first triangles.
    #[inline(always)]
    pub fn prefetch_triangles(&self, leaf: LeafId) {
        for &slot in self.triangles(leaf).iter().take(2 * LANES) {
            prefetch(&self.vertices, slot.index(), size_of::<Corners>());
        }
    }

    /// The triangles of a leaf.
    #[inline(always)]
    pub fn triangles(&self, leaf: LeafId) -> &[Slot] {
        let (start, end) = self.range(leaf);
        self.slots.get(start as usize..end as usize).unwrap_or(&[])
    }

    /// A triangle's corners.
    #[inline(always)]
    pub fn corners(&self, slot: Slot) -> &Corners {
        &self.vertices[slot.0 as usize]
    }

    /// The triangle of a slot.
    pub fn id(&self, slot: Slot) -> PrimId {
        id_of(self.corners(slot))
    }

    /// Puts up to four triangles together; what is missing repeats the first.
    #[inline(always)]
    pub fn block<S: Simd>(&self, simd: S, slots: &[Slot]) -> Block {
        let first = self.corners(slots[0]);
        let mut lanes = [id_of(first), PrimId::NONE, PrimId::NONE, PrimId::NONE];
        let mut corners = [first; LANES];
        for lane in 1..LANES {
            if let Some(&slot) = slots.get(lane) {
                corners[lane] = self.corners(slot);
                lanes[lane] = id_of(corners[lane]);
            }
        }
        let mut block = Block { vertices: [[0.0; LANES]; 9], ids: lanes };
        for (vertex, stripes) in block.vertices.as_chunks_mut().0.iter_mut().enumerate() {
            let load = |lane: usize| f32x4::load_array_ref(simd, &corners[lane][vertex]);
            let (p, q) = (load(0).zip_low(load(2)), load(1).zip_low(load(3)));
            let z = load(0).zip_high(load(2)).zip_low(load(1).zip_high(load(3)));
            *stripes = [p.zip_low(q).into(), p.zip_high(q).into(), z.into()];
        }
        block
    }

    /// Bytes of the parts, for reports.
    pub fn memory(&self) -> [(&'static str, usize); 3] {
        [
            ("leaves", size_of_val(&*self.starts)),
            ("references", size_of_val(&*self.slots)),
            ("vertices", size_of_val(&*self.vertices)),
        ]
    }
}

#[inline(always)]
fn id_of(corners: &Corners) -> PrimId {
    PrimId(corners[0][3].to_bits())
}

/// Numbers triangles in the order in which a list first names them: the list by these numbers, and
/// the triangles in their order.
fn number_by_use(ids: Vec<PrimId>, count: usize) -> (Vec<Slot>, Vec<PrimId>) {
    const NONE: u32 = u32::MAX;
    let (mut slots, mut order) = (vec![NONE; count], Vec::with_capacity(count));
    let number = |id: PrimId| {
        let slot = &mut slots[id.index()];
        if *slot == NONE {
            *slot = order.len() as u32;
            order.push(id);
        }
        Slot(*slot)
    };
    (ids.into_iter().map(number).collect(), order)
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
                let [low, high] = split_cell(&cell, axis as usize, split);
                todo.push((above, high, depth + 1));
                todo.push((NodeId(at.0 + 1), low, depth + 1));
            }
        }
    }
}

/// The parts of a cell below and above a plane.
#[inline]
pub fn split_cell(cell: &Aabb, axis: usize, split: f32) -> [Aabb; 2] {
    let (mut low, mut high) = (*cell, *cell);
    low.max[axis] = split;
    high.min[axis] = split;
    [low, high]
}
