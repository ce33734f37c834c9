//! The shape of a wide tree, however it was built, and how it is laid out.

use rayon::prelude::*;

use super::arena::{Arena, BLOCK, NODE, NodeStripes, write_block, write_ids};
use super::share::SharedBlocks;
use crate::accel::BuildReport;
use crate::accel::bvh::Parts;
use crate::accel::bvh::leaves::{fetch_triangles, pad_ids};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::sah;
use crate::geom::TriangleSource;
use crate::math::{Aabb, PrimId};

/// A tree whose nodes have up to `W` children, as a builder hands it over.
///
/// It names its nodes and leaves by numbers of its own.
pub trait Source<const W: usize>: Sync {
    /// The root; `None` without triangles.
    fn root(&self) -> Option<u32>;

    /// What has a number.
    fn child(&self, number: u32) -> Child;

    /// The children of a node: how many, and their numbers.
    fn children(&self, node: u32) -> (usize, [u32; W]);
}

/// A child of a node: its box, and what it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Child {
    /// Box of all triangles below.
    pub bounds: Aabb,
    /// Node or leaf.
    pub below: Below,
}

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Below {
    /// A node, by the number by which its source knows its children.
    Node(u32),
    /// A leaf, by its first place in the order of the triangles, and how many it holds.
    Leaf(u32, u32),
}

/// Nodes and leaves in the order in which they lie in memory.
pub struct Shape<const W: usize, S> {
    /// Boxes.
    source: S,
    /// The root first; the nodes that a node links to stand together.
    nodes: Vec<Node<W>>,
    /// First place and number of triangles; those that a node links to stand together.
    leaves: Vec<(u32, u32)>,
    /// The blocks of leaves that share them; none if each leaf has its own.
    shared: Option<SharedBlocks>,
    /// Triangles, leaf by leaf.
    order: Vec<PrimId>,
    /// If leaves hold parts of triangles: the rays that the boxes are good for.
    pub parts: Option<Parts>,
    /// Its shape in figures, but for what its maker alone knows: triangles and phases.
    pub report: BuildReport,
}

/// Up to `W` children: their numbers in the source, and where the first of those that are nodes and
/// of those that are leaves lies. Small, as memory that is touched for the first time is what
/// collapsing waits for: boxes are read once more when stripes are written.
#[derive(Clone, Copy)]
struct Node<const W: usize> {
    count: u32,
    first_node: u32,
    first_leaf: u32,
    children: [u32; W],
}

/// A node whose children are yet to be asked for.
struct Open {
    /// As its source knows it.
    from: u32,
    /// Its place among the nodes.
    place: usize,
    depth: usize,
}

/// Sums over all nodes and leaves.
#[derive(Default)]
struct Sums {
    area: f64,
    depth: usize,
    max_depth: usize,
}

impl<const W: usize, S: Source<W>> Shape<W, S> {
    /// Lays a tree out.
    pub fn new(source: S, order: Vec<PrimId>, parts: Option<Parts>) -> Self {
        let report = BuildReport::default();
        // About as many as there are, so that growing copies little.
        let nodes = Vec::with_capacity(order.len() / (2 * W) + 1);
        let leaves = Vec::with_capacity(order.len() / W + 1);
        let mut shape = Self { source, nodes, leaves, shared: None, order, parts, report };
        let Some(root) = shape.source.root() else { return shape };
        let (mut sums, mut open) = (Sums::default(), Vec::with_capacity(W * sah::MAX_DEPTH));
        shape.add(root, 0, &mut open, &mut sums);
        while let Some(Open { from, place, depth }) = open.pop() {
            let (first, (count, children)) = (open.len(), shape.source.children(from));
            let (first_node, first_leaf) = (shape.nodes.len() as u32, shape.leaves.len() as u32);
            shape.nodes[place] = Node { count: count as u32, first_node, first_leaf, children };
            for &child in &children[..count] {
                shape.add(child, depth + 1, &mut open, &mut sums);
            }
            open[first..].reverse();
        }
        shape.sum_up(&sums, shape.source.child(root).bounds.half_area());
        shape
    }

    /// Makes room for a child.
    fn add(&mut self, number: u32, depth: usize, open: &mut Vec<Open>, sums: &mut Sums) {
        let child = self.source.child(number);
        sums.area += child.bounds.half_area();
        match child.below {
            Below::Leaf(first, count) => {
                sums.depth += depth;
                sums.max_depth = sums.max_depth.max(depth);
                self.leaves.push((first, count));
            }
            Below::Node(from) => {
                open.push(Open { from, place: self.nodes.len(), depth });
                self.nodes.push(Node { count: 0, first_node: 0, first_leaf: 0, children: [0; W] });
            }
        }
    }

    fn sum_up(&mut self, sums: &Sums, root_area: f64) {
        let leaves = self.leaves.len() as f64;
        self.report = BuildReport {
            nodes: self.nodes.len(),
            leaves: self.leaves.len(),
            sah_cost: sums.area / root_area.max(f64::MIN_POSITIVE),
            mean_leaf: self.order.len() as f64 / leaves,
            mean_depth: sums.depth as f64 / leaves,
            max_depth: sums.max_depth,
            ..std::mem::take(&mut self.report)
        };
    }

    /// Has small leaves share blocks, but for those that hold what `is_alone`.
    pub fn share_blocks(&mut self, is_alone: impl Fn(PrimId) -> bool) {
        self.shared = Some(SharedBlocks::new::<W>(&self.leaves, &self.order, is_alone));
        self.order = Vec::new();
    }

    /// How many blocks hold the triangles of leaves.
    pub fn blocks(&self) -> usize {
        self.shared.as_ref().map_or(self.leaves.len(), |shared| shared.blocks.len())
    }

    /// The block of a leaf.
    fn block_of(&self, leaf: usize) -> usize {
        self.shared.as_ref().map_or(leaf, |shared| shared.block_of[leaf] as usize)
    }

    /// The first stripe of all leaves.
    pub fn first_leaf(&self) -> usize {
        self.nodes.len() * NODE
    }

    /// Stripes in all.
    pub fn stripes(&self, inline: bool) -> usize {
        self.first_leaf() + self.blocks() * leaf_stripes(inline)
    }

    /// Where a walk begins; `None` without triangles.
    pub fn root(&self) -> Option<Link> {
        match (self.nodes.is_empty(), self.leaves.is_empty()) {
            (false, _) => Some(Link::to_node(0)),
            (true, false) => Some(Link::to_leaf(0)),
            (true, true) => None,
        }
    }

    /// Writes the nodes into the stripes before the leaves', with their children's orders or
    /// without.
    pub fn write_nodes(&self, arena: &mut Arena<W>, inline: bool, by_octant: bool) {
        let (first_leaf, of_leaf) = (self.first_leaf(), leaf_stripes(inline));
        let stripes = arena.floats_mut()[..first_leaf].par_chunks_mut(NODE);
        stripes.zip(&self.nodes).with_min_len(256).for_each(|(stripes, node)| {
            let mut written = NodeStripes::EMPTY;
            let mut nodes = (node.first_node as usize..).map(|place| place * NODE);
            let block = |leaf: usize| first_leaf + self.block_of(leaf) * of_leaf;
            let mut leaves = (node.first_leaf as usize..).map(block);
            for (lane, &number) in node.children[..node.count as usize].iter().enumerate() {
                let Child { bounds, below } = self.source.child(number);
                let link = match below {
                    Below::Node(_) => nodes.next().map(Link::to_node),
                    Below::Leaf(..) => leaves.next().map(Link::to_leaf),
                };
                written.set(lane, &bounds, link.expect("counts on without end"));
            }
            if by_octant {
                written.write_orders();
            }
            stripes.copy_from_slice(&written.0);
        });
    }

    /// What is left once the nodes are written. The boxes are given back: leaves take more memory
    /// than all before them, so that a build needs the most while they are written.
    pub fn into_blocks(self) -> Blocks {
        let first = self.first_leaf();
        match self.shared {
            None => Blocks { first, places: self.leaves, order: self.order },
            Some(SharedBlocks { order, blocks, .. }) => Blocks { first, places: blocks, order },
        }
    }
}

/// The blocks of leaves in the order in which they lie in memory.
pub struct Blocks {
    /// The first stripe.
    first: usize,
    /// First place and number of triangles.
    places: Vec<(u32, u32)>,
    /// Triangles, block by block.
    order: Vec<PrimId>,
}

impl Blocks {
    /// Writes them into the stripes behind the nodes', with their triangles or without.
    pub fn write<const W: usize>(
        &self,
        arena: &mut Arena<W>,
        source: &dyn TriangleSource,
        inline: bool,
    ) {
        let stripes = &mut arena.floats_mut()[self.first..];
        let leaves = stripes.par_chunks_mut(leaf_stripes(inline)).zip(&self.places);
        leaves.with_min_len(256).for_each(|(stripes, &(first, count))| {
            let ids = &self.order[first as usize..][..count as usize];
            if inline {
                write_block(stripes, &fetch_triangles(ids, source));
            } else {
                write_ids(stripes, &pad_ids(ids));
            }
        });
    }
}

/// Stripes of a leaf.
fn leaf_stripes(inline: bool) -> usize {
    if inline { BLOCK } else { 1 }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::accel::Steps;
    use crate::accel::bvh::wide::{collapse::collapse, direct};
    use crate::accel::bvh::{binned, prims};
    use crate::geom::{Triangle, TriangleList};
    use crate::math::Vec3;

    fn triangles(count: usize) -> TriangleList {
        let at = |i: usize| {
            let f = |k: usize| ((i * k) % 101) as f32 * 0.1;
            Vec3::new(f(37), f(59), f(83))
        };
        let triangle = |i| Triangle { a: at(i), b: at(i) + Vec3::X, c: at(i) + Vec3::Y };
        TriangleList((0..count).map(triangle).collect())
    }

    /// Every block is linked to, once by each leaf, every triangle is in one, and no lane leads
    /// nowhere.
    fn check<const W: usize>(shape: Shape<W, impl Source<W>>, source: &TriangleList, inline: bool) {
        let mut arena = Arena::new(shape.stripes(inline)).expect("memory");
        shape.write_nodes(&mut arena, inline, true);
        let (root, report) = (shape.root(), shape.report.clone());
        let (blocks, is_shared) = (shape.blocks(), shape.shared.is_some());
        assert!(if is_shared { blocks <= report.leaves } else { blocks == report.leaves });
        shape.into_blocks().write(&mut arena, source, inline);
        let mut seen = vec![false; source.len()];
        let mut open = vec![root.expect("triangles")];
        let (mut visited, mut known) = (0, HashSet::new());
        while let Some(link) = open.pop() {
            visited += 1;
            let stripes = arena.stripes();
            if link.is_leaf() {
                if !known.insert(link.place()) {
                    assert!(is_shared);
                    continue;
                }
                let ids = if inline { stripes.block(link).ids } else { stripes.ids(link) };
                for id in ids.iter().filter(|&&id| id != PrimId::NONE) {
                    assert!(!std::mem::replace(&mut seen[id.index()], true));
                }
                continue;
            }
            let (planes, links) = stripes.node(link);
            let taken = (0..W).filter(|&lane| planes[0][lane] <= planes[1][lane]);
            open.extend(taken.map(|lane| Link(links[lane])));
        }
        assert!(seen.iter().all(|&s| s));
        assert_eq!((visited, known.len()), (report.nodes + report.leaves, blocks));
    }

    fn check_builds<const W: usize>(count: usize, fill: sah::Fill) {
        let source = triangles(count);
        let costs = sah::Costs { traversal_cost: sah::TRAVERSAL_COST, width: W, fill };
        let collapsed = || {
            collapse::<W>(binned::build(&mut prims::make_prims(&source), costs, &Steps::untold()))
        };
        let direct = || direct::build::<W>(prims::make_prims(&source), costs, &Steps::untold());
        for inline in [false, true] {
            check(collapsed(), &source, inline);
            check(direct(), &source, inline);
            let mut shared = collapsed();
            shared.share_blocks(|id| id.0.is_multiple_of(7));
            check(shared, &source, inline);
        }
        let (collapsed, direct) = (collapsed(), direct());
        // The same splits, chosen by the same rule: the same tree, to the order in memory.
        assert_eq!(direct.order, collapsed.order);
        assert_eq!(direct.leaves, collapsed.leaves);
        assert_eq!(direct.report.sah_cost, collapsed.report.sah_cost);
        assert_eq!(stripes(&direct), stripes(&collapsed));
    }

    /// The nodes as they lie in memory.
    fn stripes<const W: usize>(shape: &Shape<W, impl Source<W>>) -> Vec<[u32; W]> {
        let mut arena = Arena::new(shape.stripes(true)).expect("memory");
        shape.write_nodes(&mut arena, true, true);
        let stripes = &arena.floats_mut()[..shape.first_leaf()];
        stripes.iter().map(|stripe| stripe.map(f32::to_bits)).collect()
    }

    #[test]
    fn all_leaves_stay_and_no_more_and_direct_builds_are_those_that_are_collapsed() {
        for count in [1, 2, 5, 17, 300, 2000, 20_000] {
            for fill in [sah::Fill::Any, sah::Fill::Full] {
                check_builds::<4>(count, fill);
                check_builds::<8>(count, fill);
                check_builds::<16>(count, fill);
            }
        }
    }
}
