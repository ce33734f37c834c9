//! A hierarchy of nodes with up to `W` children, and the walk of one ray.

use std::ops::ControlFlow;

use fearless_simd::{Level, Simd};

use super::arena::{Arena, BLOCK, NODE, Stripes, map_ids, map_links};
use super::packet::PacketScratch;
use super::shape::{Shape, Source};
use super::stack::{Sorting, Stack};
use super::{collapse, direct, node, octants, optimal};
use crate::accel::bvh::Parts;
use crate::accel::bvh::build::build_tree_by;
use crate::accel::bvh::leaves::{Fetch, Fetched};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::prims::make_prims;
use crate::accel::bvh::sah::{self, Costs, Fill, TRAVERSAL_COST};
use crate::accel::{
    BuildError, BuildInput, BuildReport, Built, Counters, Event, MemoryReport, Phases, PreparedRay,
    Query, RayContext, Structure,
};
use crate::geom::BlockRef;
use crate::math::PrimId;
use crate::simd::order::key_limit;
use crate::simd::{Vectors, Width};

/// A hierarchy of width `W`.
pub struct WideBvh<const W: usize> {
    /// `None` without triangles.
    pub root: Option<Link>,
    /// Nodes and leaves, and room behind them.
    pub arena: Arena<W>,
    /// How many stripes that is.
    room: usize,
    /// `None` if the leaves store their triangles.
    fetch: Option<Fetch>,
    /// Whether children are taken in the order of the direction's octant.
    by_octant: bool,
    /// If leaves hold parts of triangles: the rays that the boxes are good for.
    pub parts: Option<Parts>,
    /// Whether rays from one point that run side by side are walked sixteen at a time.
    pub side_by_side: bool,
    /// Stripe of the first leaf.
    first_leaf: usize,
    /// The blocks that leaves are in.
    blocks: usize,
    built: Built,
}

/// Rays in flight; 12 to 32 are equal.
pub const RAYS: usize = 16;

/// Scratch of one thread.
pub struct Scratch<const W: usize> {
    /// For each ray in flight.
    pub stacks: Box<[Stack<W>]>,
    /// Leaves that were fetched.
    pub fetched: Fetched<W>,
    /// For rays side by side.
    pub packet: Option<Box<PacketScratch<W>>>,
}

impl<const W: usize> WideBvh<W>
where
    Width: Vectors<W>,
{
    /// Builds the tree, binary first or in one pass, and says how long each phase took.
    pub fn build(input: &BuildInput<'_>) -> Result<Self, BuildError> {
        Self::build_with_room(input, 0)
    }

    /// The same with `room` stripes to spare, which take no memory until something is put there.
    pub fn build_with_room(input: &BuildInput<'_>, room: usize) -> Result<Self, BuildError> {
        let fill = if input.options.choice("leaves") == "full" { Fill::Full } else { Fill::Any };
        let costs = Costs { traversal_cost: TRAVERSAL_COST, width: W, fill };
        let mut phases = Phases::start();
        if input.options.choice("build") == "direct" {
            let prims = make_prims(&*input.source);
            phases.end("boxes");
            let shape = direct::build::<W>(prims, costs, input.steps);
            phases.end("tree");
            return Self::lay_out(input, shape, phases, room);
        }
        let tree = build_tree_by(input, costs, &mut phases);
        if input.options.choice("collapse") == "optimal" {
            let shape = optimal::collapse::<W>(tree);
            phases.end("collapse");
            return Self::lay_out(input, shape, phases, room);
        }
        let shape = collapse::collapse::<W>(tree);
        phases.end("collapse");
        Self::lay_out(input, shape, phases, room)
    }

    /// Whether its leaves hold whole triangles, where they are.
    pub fn stores_triangles(&self) -> bool {
        self.fetch.is_none() && self.parts.is_none()
    }

    /// How many stripes its nodes and leaves are.
    pub fn count_stripes(&self) -> usize {
        self.arena.stripes().count() - self.room
    }

    /// Copies nodes and leaves into a larger arena from place `first` on; its root there.
    pub fn copy_to(&self, stripes: &mut [[f32; W]], first: usize) -> Option<Link> {
        self.arena.stripes().copy_to(&mut stripes[first..first + self.count_stripes()]);
        let moved = |link: Link| link.moved(first as u32);
        for node in stripes[first..first + self.first_leaf].chunks_exact_mut(NODE) {
            map_links(node, moved);
        }
        self.root.map(moved)
    }

    /// The ids of all leaves that store their triangles.
    pub fn leaves(&self) -> impl ExactSizeIterator<Item = &[PrimId; W]> {
        let (first_leaf, stripes) = (self.first_leaf, self.arena.stripes());
        (0..self.blocks)
            .map(move |leaf| stripes.block(Link::to_leaf(first_leaf + leaf * BLOCK)).ids)
    }

    /// Leads links to leaves elsewhere, where there is such a link for one.
    pub fn redirect(&mut self, links: &[Option<Link>]) {
        let first_leaf = self.first_leaf;
        let to = |old: Link| {
            let leaf = old.is_leaf().then(|| (old.place() - first_leaf) / BLOCK);
            leaf.and_then(|leaf| links[leaf]).unwrap_or(old)
        };
        for node in self.arena.floats_mut()[..first_leaf].chunks_exact_mut(NODE) {
            map_links(node, to);
        }
        self.root = self.root.map(to);
    }

    /// Replaces the ids in all leaves, which store their triangles.
    pub fn relabel(&mut self, to: impl Fn(PrimId) -> PrimId) {
        debug_assert!(self.fetch.is_none(), "ids are where a leaf's triangles are");
        let leaves = self.first_leaf..self.count_stripes();
        for leaf in self.arena.floats_mut()[leaves].chunks_exact_mut(BLOCK) {
            map_ids(leaf, &to);
        }
    }

    /// Forgets what is in its leaves; links to them stay.
    ///
    /// # Errors
    /// If there is not enough memory for nodes alone beside the whole.
    pub fn drop_leaves(&mut self) -> Result<(), BuildError> {
        let mut arena = Self::reserve(self.first_leaf)?;
        arena.floats_mut().copy_from_slice(&self.arena.floats_mut()[..self.first_leaf]);
        (self.arena, self.room) = (arena, 0);
        Ok(())
    }

    /// Memory for so many stripes.
    ///
    /// # Errors
    /// If there is not as much.
    pub fn reserve(stripes: usize) -> Result<Arena<W>, BuildError> {
        let needed = (stripes * size_of::<[f32; W]>()) as u64;
        Arena::new(stripes).map_err(|_| BuildError::NoMemory { needed })
    }

    /// How it was built.
    pub fn report(&self) -> &BuildReport {
        &self.built.report
    }

    /// The instruction set to walk with.
    pub fn level(&self) -> Level {
        self.built.level
    }

    /// Writes a tree's nodes and leaves.
    fn lay_out(
        input: &BuildInput<'_>,
        mut shape: Shape<W, impl Source<W>>,
        mut phases: Phases,
        room: usize,
    ) -> Result<Self, BuildError> {
        if input.options.choice("leaves") == "shared" {
            // Boxes stand alone: they are no triangles.
            let triangles = input.source.len() - input.source.boxes();
            shape.share_blocks(|id| id.index() >= triangles);
            phases.end("blocks");
        }
        if shape.report.max_depth > sah::MAX_DEPTH {
            let (depth, limit) = (shape.report.max_depth, sah::MAX_DEPTH);
            return Err(BuildError::TooDeep { depth, limit });
        }
        let fetch = Fetch::new(input);
        let (inline, by_octant) = (fetch.is_none(), input.options.choice("order") == "octant");
        let stripes = shape.stripes(inline);
        if stripes >= Link::LIMIT {
            let count = input.source.len();
            let limit = (count as u64 * Link::LIMIT as u64 / stripes as u64) as usize;
            return Err(BuildError::TooManyTriangles { count, limit });
        }
        let mut arena = Self::reserve(stripes + room)?;
        shape.write_nodes(&mut arena, inline, by_octant);
        phases.end("nodes");
        let (root, parts, first_leaf) = (shape.root(), shape.parts, shape.first_leaf());
        let blocks = shape.blocks();
        let report = std::mem::take(&mut shape.report);
        shape.into_blocks().write(&mut arena, &*input.source, inline);
        phases.end("leaves");
        Ok(Self {
            root,
            arena,
            room,
            fetch,
            by_octant,
            side_by_side: false,
            parts,
            first_leaf,
            blocks,
            built: Built {
                level: input.level,
                report: BuildReport {
                    phases: phases.ended(),
                    triangles: input.source.len(),
                    ..report
                },
            },
        })
    }

    /// In which order the children of a node go on the stack.
    #[inline(always)]
    pub fn sorting(
        &self,
        stripes: Stripes<'_, W>,
        node: Link,
        prepared: &PreparedRay<'_>,
    ) -> Sorting {
        if self.by_octant {
            Sorting::Listed(octants::read_list(
                stripes.orders(node),
                octants::find_octant(&prepared.slab),
            ))
        } else {
            Sorting::ByDistance
        }
    }

    /// A leaf's triangles.
    #[inline(always)]
    pub fn visit_leaf<'a, C: Counters>(
        &self,
        stripes: Stripes<'a, W>,
        link: Link,
        fetched: &'a mut Fetched<W>,
        counters: &mut C,
    ) -> BlockRef<'a, W> {
        counters.count(Event::Leaf);
        match &self.fetch {
            None => stripes.block(link),
            Some(fetch) => {
                let leaf = link.place() - self.first_leaf;
                fetched.block(fetch, leaf, stripes.ids(link), counters)
            }
        }
    }

    /// Tests a leaf's triangles.
    #[inline(always)]
    pub fn test_leaf<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        stripes: Stripes<'_, W>,
        link: Link,
        fetched: &mut Fetched<W>,
    ) -> ControlFlow<()> {
        let block = self.visit_leaf(stripes, link, fetched, context.counters);
        context.test_block(block)
    }

    /// Tests all triangles: for the few rays that boxes of parts are not good for.
    #[inline(never)]
    fn test_all<Q: Query, C: Counters>(
        &self,
        mut context: RayContext<'_, impl Simd, Q, C>,
        fetched: &mut Fetched<W>,
    ) {
        let (stripes, of_leaf) =
            (self.arena.stripes(), if self.fetch.is_some() { 1 } else { BLOCK });
        for block in 0..self.blocks {
            let link = Link::to_leaf(self.first_leaf + block * of_leaf);
            let block = self.visit_leaf(stripes, link, fetched, context.counters);
            if context.test_each(block).is_break() {
                return;
            }
        }
    }

    /// Walks one ray.
    #[inline(always)]
    pub fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        scratch: &mut Scratch<W>,
    ) {
        let Some(mut link) = self.root else { return };
        let stripes = self.arena.stripes();
        let Scratch { stacks, fetched, .. } = scratch;
        if self.parts.is_some_and(|parts| !parts.covers(&context.ray.ray)) {
            return self.test_all(context.reborrow(), fetched);
        }
        let (stack, mut top) = (&mut stacks[0], 1);
        loop {
            if link.is_leaf() {
                if self.test_leaf(context, stripes, link, fetched).is_break() {
                    return;
                }
            } else {
                context.counters.count(Event::InnerNode);
                context.counters.count(Event::BoxTest);
                let (planes, links) = stripes.node(link);
                let (simd, ray) = (context.simd, context.ray);
                let (keys, hits) =
                    node::intersect_children(simd, planes, ray.for_boxes(), context.query.t_max());
                let sorting = self.sorting(stripes, link, ray);
                let below = stack.descend(simd, sorting, &keys, hits, links, &mut top);
                if let Some(nearest) = below {
                    context.counters.add(Event::Push, u64::from(hits.count_ones()) - 1);
                    if hits & (hits - 1) != 0 {
                        // Where it will turn to when it comes back from below `nearest`.
                        stripes.prefetch(stack.peek(top));
                    }
                    link = nearest;
                    continue;
                }
            }
            match stack.next(&mut top, key_limit(context.query.t_max())) {
                Some(next) => link = next,
                None => return,
            }
        }
    }
}

impl<const W: usize> Structure for WideBvh<W>
where
    Width: Vectors<W>,
{
    type Scratch = Scratch<W>;

    fn scratch(&self) -> Scratch<W> {
        let stacks = (0..RAYS).map(|_| Stack::new()).collect();
        let fetched = self.fetch.as_ref().map(|fetch| fetch.make_table(self.blocks));
        let packet = self.side_by_side.then(Box::default);
        Scratch { stacks, fetched: fetched.unwrap_or_else(Fetched::none), packet }
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let nodes = self.first_leaf * size_of::<[f32; W]>();
        let leaves = if self.fetch.is_some() { "references" } else { "leaves" };
        MemoryReport::new([("nodes", nodes), (leaves, self.arena.bytes() - nodes)])
    }
}
