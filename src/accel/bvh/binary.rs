//! `bvh2`: the binary hierarchy, one ray at a time.
//!
//! The baseline, and no straw man: both children's boxes lie in their parent's cache line and are
//! tested together, the nearer child comes first, what waits on the stack remembers where the ray
//! enters it, and leaves are blocks of four triangles in a leaf's cache lines.

use std::ops::ControlFlow;

use fearless_simd::{Simd, SimdBase, f32x4};

use super::build::{BUILD, REFINE, build_tree_by};
use super::leaves::{CACHE, Fetch, Fetched, TRIANGLES, fetch_triangles, pad_ids};
use super::link::Link;
use super::{BinaryTree, Parts, sah};
use crate::accel::{
    BuildError, BuildInput, BuildReport, Built, Counters, Event, MemoryReport, Phases, PreparedRay,
    Query, RayContext, Structure, Variant, Verdict, WalkRay,
};
use crate::geom::{BlockRef, TriangleBlock, TriangleSource};
use crate::math::{Aabb, PrimId, Vec3, larger};

/// Its row of the table.
pub const VARIANT: Variant = Variant {
    id: "bvh2",
    summary: "binary bounding volume hierarchy, leaves of up to four triangles",
    paper: "Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007",
    options: &[BUILD, REFINE, TRIANGLES, CACHE],
    build: |input| Ok(Box::new(Bvh2::build(input)?)),
};

/// Triangles of a leaf.
pub(super) const WIDTH: usize = 4;
/// Cost of a step relative to that of a leaf.
const COSTS: sah::Costs =
    sah::Costs { traversal_cost: sah::TRAVERSAL_COST, width: WIDTH, fill: sah::Fill::Any };
/// A node puts at most one child aside.
const STACK: usize = sah::MAX_DEPTH + 1;

/// Two children: for each axis the lower planes of both and the upper planes of both.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    planes: [[[f32; 2]; 2]; 3],
    pub(super) children: [Link; 2],
}

/// The structure.
pub struct Bvh2 {
    pub(super) root: Option<Link>,
    pub(super) nodes: Vec<Node>,
    leaves: Leaves,
    /// `None` if the leaves store their triangles.
    fetch: Option<Fetch>,
    /// If leaves hold parts of triangles: the rays that the boxes are good for.
    pub(super) parts: Option<Parts>,
    built: Built,
}

/// What leaves hold; one of the two is empty.
struct Leaves {
    blocks: Vec<TriangleBlock<WIDTH>>,
    /// Places not used hold [`PrimId::NONE`].
    ids: Vec<[PrimId; WIDTH]>,
}

/// Scratch of one thread.
pub struct Scratch {
    stack: Box<[(Link, f32); STACK]>,
    pub(super) fetched: Fetched<WIDTH>,
}

impl Bvh2 {
    pub(super) fn build(input: &BuildInput<'_>) -> Result<Self, BuildError> {
        let mut phases = Phases::start();
        let tree = build_tree_by(input, COSTS, &mut phases);
        let report = tree.report();
        if report.max_depth > sah::MAX_DEPTH {
            let (depth, limit) = (report.max_depth, sah::MAX_DEPTH);
            return Err(BuildError::TooDeep { depth, limit });
        }
        if report.leaves.max(report.nodes) >= Link::LIMIT {
            let (count, limit) = (report.leaves, Link::LIMIT);
            return Err(BuildError::TooManyTriangles { count, limit });
        }
        let fetch = Fetch::new(input);
        let (links, nodes, leaves) = lay_out(&tree, &*input.source, fetch.is_none());
        phases.end("layout");
        let report = BuildReport { phases: phases.ended(), ..report };
        let built = Built { level: input.level, report };
        let (root, parts) = (links.first().copied(), tree.parts);
        Ok(Self { root, nodes, leaves, fetch, parts, built })
    }
}

/// Inner nodes and leaves, each in the tree's order; leaves hold their triangles or only name them.
fn lay_out(
    tree: &BinaryTree,
    source: &dyn TriangleSource,
    inline: bool,
) -> (Vec<Link>, Vec<Node>, Leaves) {
    let (mut inner, mut leaf) = (0, 0);
    let links: Vec<Link> = (tree.nodes.iter())
        .map(|node| {
            if node.is_leaf() {
                leaf += 1;
                Link::to_leaf(leaf - 1)
            } else {
                inner += 1;
                Link::to_node(inner - 1)
            }
        })
        .collect();
    let mut nodes = Vec::with_capacity(inner);
    let (blocks, ids) = if inline { (leaf, 0) } else { (0, leaf) };
    let mut leaves = Leaves { blocks: Vec::with_capacity(blocks), ids: Vec::with_capacity(ids) };
    for (index, node) in tree.nodes.iter().enumerate() {
        if node.is_leaf() {
            let ids = tree.triangles(node);
            if inline {
                leaves.blocks.push(fetch_triangles(ids, source));
            } else {
                leaves.ids.push(pad_ids(ids));
            }
            continue;
        }
        let children = [index + 1, node.first as usize];
        let bounds = children.map(|child| tree.nodes[child].bounds);
        nodes.push(Node { children: children.map(|child| links[child]), ..Node::of(bounds) });
    }
    (links, nodes, leaves)
}

impl Node {
    /// Two boxes side by side; nothing lies below them.
    #[inline(always)]
    pub(super) fn of([a, b]: [Aabb; 2]) -> Self {
        let axis = |axis: usize| [[a.min[axis], b.min[axis]], [a.max[axis], b.max[axis]]];
        Self { planes: [axis(0), axis(1), axis(2)], children: [Link(0); 2] }
    }

    /// A child's box.
    #[inline(always)]
    pub(super) fn bounds(&self, side: usize) -> Aabb {
        let [x, y, z] = &self.planes;
        let corner = |upper: usize| Vec3::new(x[upper][side], y[upper][side], z[upper][side]);
        Aabb { min: corner(0), max: corner(1) }
    }

    /// Where the ray enters each child, and minus where it leaves it: `[in, in, -out, -out]`.
    #[inline(always)]
    pub(super) fn intervals<S: Simd>(
        &self,
        simd: S,
        prepared: &PreparedRay<'_>,
        t_max: f32,
    ) -> [f32; 4] {
        let slab = &prepared.slab;
        let mut worst =
            f32x4::from_fn(simd, |lane| if lane < 2 { prepared.ray.t_min() } else { -t_max });
        for axis in 0..3 {
            let near = self.planes[axis][slab.negative[axis]];
            let far = self.planes[axis][1 - slab.negative[axis]];
            let planes = f32x4::load_array(simd, [near[0], near[1], far[0], far[1]]);
            let (inv_near, inv_far) = (slab.inv_near[axis], -slab.inv_far[axis]);
            let inverse = f32x4::load_array(simd, [inv_near, inv_near, inv_far, inv_far]);
            // Negation is exact: a maximum of negated far distances is their minimum, negated.
            worst = worst.max((planes - slab.origin[axis]) * inverse);
        }
        worst.to_array()
    }
}

impl Bvh2 {
    /// A leaf's triangles.
    #[inline(always)]
    pub(super) fn visit_leaf<'a, C: Counters>(
        &'a self,
        leaf: usize,
        fetched: &'a mut Fetched<WIDTH>,
        counters: &mut C,
    ) -> BlockRef<'a, WIDTH> {
        counters.count(Event::Leaf);
        match &self.fetch {
            None => self.leaves.blocks[leaf].parts(),
            Some(fetch) => fetched.block(fetch, leaf, &self.leaves.ids[leaf], counters),
        }
    }

    /// Walks what is below a link, with a ray that the boxes are good for; `Break` if the answer is
    /// final.
    #[inline(always)]
    pub(super) fn walk_below<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        mut link: Link,
        Scratch { stack, fetched }: &mut Scratch,
    ) -> ControlFlow<()> {
        let mut pending = 0;
        loop {
            if link.is_leaf() {
                let block = self.visit_leaf(link.place(), fetched, context.counters);
                context.test_block(block)?;
            } else {
                context.counters.count(Event::InnerNode);
                context.counters.count(Event::BoxTest);
                let node = &self.nodes[link.place()];
                let t_max = context.query.t_max();
                let [in0, in1, out0, out1] = node.intervals(context.simd, context.ray, t_max);
                match (in0 <= -out0, in1 <= -out1) {
                    (true, true) => {
                        let first = usize::from(in1 < in0);
                        stack[pending] = (node.children[1 - first], larger(in0, in1));
                        pending += 1;
                        context.counters.count(Event::Push);
                        link = node.children[first];
                        continue;
                    }
                    (true, false) => {
                        link = node.children[0];
                        continue;
                    }
                    (false, true) => {
                        link = node.children[1];
                        continue;
                    }
                    (false, false) => {}
                }
            }
            // The nearest of what waits, unless a hit was found before it.
            loop {
                if pending == 0 {
                    return ControlFlow::Continue(());
                }
                pending -= 1;
                let (next, enter) = stack[pending];
                if enter <= context.query.t_max() {
                    link = next;
                    break;
                }
            }
        }
    }

    /// Tests all triangles: for the few rays that boxes of parts are not good for.
    #[inline(never)]
    fn test_all<Q: Query, C: Counters>(
        &self,
        (ray, verdict): (PreparedRay<'_>, Option<&dyn Verdict>),
        mut query: Q,
        counters: &mut C,
        fetched: &mut Fetched<WIDTH>,
    ) -> Q {
        let (simd, ray, query_of) = (crate::simd::baseline(), &ray, &mut query);
        let mut context = RayContext { simd, ray, verdict, query: query_of, counters };
        for leaf in 0..self.built.report.leaves {
            let block = self.visit_leaf(leaf, fetched, context.counters);
            if context.test_each(block).is_break() {
                break;
            }
        }
        query
    }
}

impl Structure for Bvh2 {
    type Scratch = Scratch;

    fn scratch(&self) -> Scratch {
        let fetched = self.fetch.as_ref().map(|fetch| fetch.make_table(self.built.report.leaves));
        let stack = Box::new([(Link(0), 0.0); STACK]);
        Scratch { stack, fetched: fetched.unwrap_or_else(Fetched::none) }
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let leaves = if self.fetch.is_some() {
            ("references", size_of_val(&*self.leaves.ids))
        } else {
            ("leaves", size_of_val(&*self.leaves.blocks))
        };
        MemoryReport::new([("nodes", size_of_val(&*self.nodes)), leaves])
    }
}

impl WalkRay for Bvh2 {
    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(
        &self,
        context: &mut RayContext<'_, S, Q, C>,
        scratch: &mut Scratch,
    ) {
        let Some(root) = self.root else { return };
        if self.parts.is_some_and(|parts| !parts.covers(&context.ray.ray)) {
            let ray = (*context.ray, context.verdict);
            *context.query =
                self.test_all(ray, *context.query, context.counters, &mut scratch.fetched);
            return;
        }
        let _final = self.walk_below(context, root, scratch);
    }
}
