//! The memory of a wide tree: nodes and leaves as stripes of `W` numbers.
//!
//! All in one piece, so that a link's place is a stripe of it whether it leads to a node or a leaf,
//! and a walk can ask for that place ahead of time without a branch. A node is eight stripes: the
//! lower and the upper planes along x, y and z, the links, and the lists of `octants`, or one to
//! spare, which keeps nodes on cache lines. A leaf that stores its triangles is nine stripes of
//! coordinates and one of ids; one that does not is its ids. Behind them may lie what is neither.

use bytemuck::{Pod, cast_slice};
use memmap2::{Advice, MmapMut};

use super::octants;
use crate::accel::bvh::link::Link;
use crate::geom::{BlockRef, TriangleBlock};
use crate::math::{Aabb, PrimId, Vec3};
use crate::simd::prefetch;

/// Stripes of a node.
pub const NODE: usize = 8;
/// Stripes of a leaf that stores its triangles.
pub const BLOCK: usize = 10;
/// The stripe of a leaf that holds its triangles' ids.
const IDS: usize = 9;
/// The stripe of a node that holds its links.
const LINKS: usize = 6;
/// The stripe of a node that holds its children's orders.
const ORDERS: usize = 7;

/// Stripes of `W` numbers.
pub struct Arena<const W: usize> {
    /// Mapped rather than allocated: on huge pages a walk waits less for addresses.
    memory: MmapMut,
}

/// An arena as a walk reads it: the same stripes as floats, as integers and as ids.
#[derive(Clone, Copy)]
pub struct Stripes<'a, const W: usize> {
    floats: &'a [[f32; W]],
    bits: &'a [[u32; W]],
    ids: &'a [[PrimId; W]],
}

impl<const W: usize> Arena<W> {
    /// So many stripes of zeros.
    ///
    /// # Errors
    /// If there is not as much memory.
    pub fn new(stripes: usize) -> std::io::Result<Self> {
        let memory = MmapMut::map_anon((stripes * size_of::<[f32; W]>()).max(1))?;
        // Where the system has no huge pages, or not as many, small ones do.
        #[cfg(target_os = "linux")]
        let _ = memory.advise(Advice::HugePage);
        Ok(Self { memory })
    }

    /// Bytes of its stripes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.stripes().floats)
    }

    /// To read.
    pub fn stripes(&self) -> Stripes<'_, W> {
        let whole = &self.memory[..self.memory.len() / 4 * 4];
        Stripes {
            floats: cast_slice::<u8, f32>(whole).as_chunks().0,
            bits: cast_slice::<u8, u32>(whole).as_chunks().0,
            ids: cast_slice::<u8, PrimId>(whole).as_chunks().0,
        }
    }

    /// To write.
    pub fn floats_mut(&mut self) -> &mut [[f32; W]] {
        let whole = self.memory.len() / 4 * 4;
        bytemuck::cast_slice_mut::<u8, f32>(&mut self.memory[..whole]).as_chunks_mut().0
    }
}

/// A node before it is in an arena.
#[derive(Clone, Copy)]
pub struct NodeStripes<const W: usize>(pub [[f32; W]; NODE]);

impl<const W: usize> NodeStripes<W> {
    /// Without children: all boxes are turned inside out, so that no ray enters them.
    pub const EMPTY: Self = {
        let mut stripes = [[0.0; W]; NODE];
        let mut axis = 0;
        while axis < 3 {
            stripes[2 * axis] = [f32::INFINITY; W];
            stripes[2 * axis + 1] = [f32::NEG_INFINITY; W];
            axis += 1;
        }
        Self(stripes)
    };

    /// Puts a child into a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, bounds: &Aabb, link: Link) {
        for axis in 0..3 {
            self.0[2 * axis][lane] = bounds.min[axis];
            self.0[2 * axis + 1][lane] = bounds.max[axis];
        }
        self.0[LINKS][lane] = f32::from_bits(link.0);
    }

    /// Puts in the orders of the children, see `octants`.
    pub fn write_orders(&mut self) {
        let corner = |lane: usize, side: usize| {
            Vec3::from_array(std::array::from_fn(|axis| self.0[2 * axis + side][lane]))
        };
        let bounds = |lane| Aabb { min: corner(lane, 0), max: corner(lane, 1) };
        self.0[ORDERS] = octants::pack(&std::array::from_fn(bounds)).map(f32::from_bits);
    }
}

/// Replaces all links of a node by its stripes, also those of lanes that are not used.
pub fn map_links<const W: usize>(node: &mut [[f32; W]], to: impl Fn(Link) -> Link) {
    for bits in &mut node[LINKS] {
        *bits = f32::from_bits(to(Link(bits.to_bits())).0);
    }
}

/// Puts triangles into a leaf's stripes.
pub fn write_block<const W: usize>(stripes: &mut [[f32; W]], block: &TriangleBlock<W>) {
    stripes[..IDS].copy_from_slice(&block.vertices);
    write_ids(&mut stripes[IDS..], &block.ids);
}

/// Replaces all ids of a leaf that stores its triangles, by its stripes.
pub fn map_ids<const W: usize>(leaf: &mut [[f32; W]], to: impl Fn(PrimId) -> PrimId) {
    for bits in &mut leaf[IDS] {
        *bits = f32::from_bits(to(PrimId(bits.to_bits())).0);
    }
}

/// Puts ids into a stripe.
pub fn write_ids<const W: usize>(stripes: &mut [[f32; W]], ids: &[PrimId; W]) {
    stripes[0] = ids.map(|id| f32::from_bits(id.0));
}

impl<'a, const W: usize> Stripes<'a, W> {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.floats.len()
    }

    /// Copies as many of them as there is room for.
    pub fn copy_to(&self, stripes: &mut [[f32; W]]) {
        stripes.copy_from_slice(&self.floats[..stripes.len()]);
    }

    /// A node's planes, lower and upper by axis, and its links.
    #[inline(always)]
    pub fn node(&self, link: Link) -> (&'a [[f32; W]; LINKS], &'a [u32; W]) {
        let stripe = link.place();
        let planes = self.floats[stripe..stripe + LINKS].try_into().expect("six stripes");
        (planes, &self.bits[stripe + LINKS])
    }

    /// A node's children by octants of directions, see `octants`.
    #[inline(always)]
    pub fn orders(&self, link: Link) -> &'a [u32; W] {
        &self.bits[link.place() + ORDERS]
    }

    /// A leaf's triangles.
    #[inline(always)]
    pub fn block(&self, link: Link) -> BlockRef<'a, W> {
        let stripe = link.place();
        let vertices = self.floats[stripe..stripe + IDS].try_into().expect("nine stripes");
        BlockRef { vertices, ids: &self.ids[stripe + IDS] }
    }

    /// The same ids as numbers: of a leaf whose ids are links.
    #[inline(always)]
    pub fn links(&self, leaf: Link) -> &'a [u32; W] {
        &self.bits[leaf.place() + IDS]
    }

    /// The ids of a leaf that does not store its triangles.
    #[inline(always)]
    pub fn ids(&self, link: Link) -> &'a [PrimId; W] {
        &self.ids[link.place()]
    }

    /// Prefetches a node or a leaf.
    #[inline(always)]
    pub fn prefetch(&self, link: Link) {
        prefetch(self.floats, link.place(), BLOCK * size_of::<[f32; W]>());
    }

    /// What lies from a place on, neither node nor leaf: of whole stripes, and aligned as these.
    #[inline(always)]
    pub fn read<T: Pod>(&self, place: usize) -> &'a T {
        let stripes = size_of::<T>() / size_of::<[f32; W]>();
        bytemuck::from_bytes(cast_slice(self.floats[place..place + stripes].as_flattened()))
    }
}
