//! The shape of a wide tree, however it was built, and how it is laid out.

use rayon::prelude::*;

use super::arena::{Arena, BLOCK, NODE, write_block, write_ids, write_node};
use crate::accel::BuildReport;
use crate::accel::bvh::Parts;
use crate::accel::bvh::leaves::{ids_of, triangles_of};
use crate::accel::bvh::link::Link;
use crate::geom::TriangleSource;
use crate::math::{Aabb, TriangleId};

/// A tree whose nodes have up to `W` children, as a builder hands it over.
pub trait Source<const W: usize> {
    /// Box and place of the root; `None` without triangles.
    fn root(&self) -> Option<Child>;

    /// The children of the node at a place.
    fn children(&self, node: u32) -> impl Iterator<Item = Child>;
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
    /// A node, by its place in the source.
    Node(u32),
    /// A leaf, by its first place in the order of the triangles, and how many it holds.
    Leaf(u32, u32),
}

/// Nodes and leaves in the order in which they lie in memory.
pub struct Shape<const W: usize> {
    /// The root first; the nodes that a node links to stand together.
    nodes: Vec<Node<W>>,
    /// First place and number of triangles.
    leaves: Vec<(u32, u32)>,
    /// Triangles, leaf by leaf.
    order: Vec<TriangleId>,
    /// If leaves hold parts of triangles: the rays that the boxes are good for.
    pub parts: Option<Parts>,
    /// Its shape in figures.
    pub report: BuildReport,
}

/// Up to `W` children: their boxes, and the place of each among the nodes or the leaves.
#[derive(Clone, Copy)]
struct Node<const W: usize> {
    count: usize,
    bounds: [Aabb; W],
    places: [Place; W],
}

#[derive(Clone, Copy)]
enum Place {
    Node(u32),
    Leaf(u32),
}

impl<const W: usize> Shape<W> {
    /// Lays a tree out.
    pub fn new(
        source: &impl Source<W>,
        order: Vec<TriangleId>,
        parts: Option<Parts>,
        triangles: usize,
    ) -> Self {
        let report = BuildReport { triangles, ..BuildReport::default() };
        // About as many as there are, so that growing copies little.
        let nodes = Vec::with_capacity(order.len() / (2 * W) + 1);
        let leaves = Vec::with_capacity(order.len() / W + 1);
        let mut shape = Self { nodes, leaves, order, parts, report };
        let Some(root) = source.root() else { return shape };
        let (mut area, mut depths) = (0.0, 0);
        let place = shape.add(&root);
        let mut open = vec![(root, place, 0_usize)];
        while let Some((child, place, depth)) = open.pop() {
            area += child.bounds.half_area();
            let (Below::Node(of_source), Place::Node(place)) = (child.below, place) else {
                depths += depth;
                shape.report.max_depth = shape.report.max_depth.max(depth);
                continue;
            };
            let mut node = Node { count: 0, bounds: [Aabb::EMPTY; W], places: [Place::Node(0); W] };
            let first = open.len();
            for child in source.children(of_source) {
                let place = shape.add(&child);
                (node.bounds[node.count], node.places[node.count]) = (child.bounds, place);
                node.count += 1;
                open.push((child, place, depth + 1));
            }
            open[first..].reverse();
            shape.nodes[place as usize] = node;
        }
        shape.report.nodes = shape.nodes.len();
        shape.report.leaves = shape.leaves.len();
        shape.report.sah_cost = area / root.bounds.half_area().max(f64::MIN_POSITIVE);
        shape.report.mean_leaf = shape.order.len() as f64 / shape.leaves.len() as f64;
        shape.report.mean_depth = depths as f64 / shape.leaves.len() as f64;
        shape
    }

    /// Makes room for a child.
    fn add(&mut self, child: &Child) -> Place {
        match child.below {
            Below::Leaf(first, count) => {
                self.leaves.push((first, count));
                Place::Leaf(self.leaves.len() as u32 - 1)
            }
            Below::Node(_) => {
                let places = [Place::Node(0); W];
                self.nodes.push(Node { count: 0, bounds: [Aabb::EMPTY; W], places });
                Place::Node(self.nodes.len() as u32 - 1)
            }
        }
    }

    /// References to triangles in all leaves.
    pub fn references(&self) -> usize {
        self.order.len()
    }

    /// Rows of a leaf.
    fn leaf_rows(inline: bool) -> usize {
        if inline { BLOCK } else { 1 }
    }

    /// The first row of all leaves.
    pub fn first_leaf(&self) -> usize {
        self.nodes.len() * NODE
    }

    /// Rows in all.
    pub fn rows(&self, inline: bool) -> usize {
        self.first_leaf() + self.leaves.len() * Self::leaf_rows(inline)
    }

    /// Where a walk begins; `None` without triangles.
    pub fn root(&self) -> Option<Link> {
        match (self.nodes.is_empty(), self.leaves.is_empty()) {
            (false, _) => Some(Link::to_node(0)),
            (true, false) => Some(Link::to_leaf(0)),
            (true, true) => None,
        }
    }

    /// Writes nodes and leaves, the latter with their triangles or without.
    ///
    /// # Errors
    /// If there is not as much memory.
    pub fn write(&self, source: &dyn TriangleSource, inline: bool) -> std::io::Result<Arena<W>> {
        let mut arena = Arena::new(self.rows(inline))?;
        let (first_leaf, of_leaf) = (self.first_leaf(), Self::leaf_rows(inline));
        let (nodes, leaves) = arena.floats_mut().split_at_mut(first_leaf);
        nodes.par_chunks_mut(NODE).zip(&self.nodes).with_min_len(256).for_each(|(rows, node)| {
            let mut children = [(Aabb::EMPTY, Link::to_node(0)); W];
            for lane in 0..node.count {
                let link = match node.places[lane] {
                    Place::Leaf(place) => Link::to_leaf(first_leaf + place as usize * of_leaf),
                    Place::Node(place) => Link::to_node(place as usize * NODE),
                };
                children[lane] = (node.bounds[lane], link);
            }
            write_node(rows, &children[..node.count]);
        });
        leaves.par_chunks_mut(of_leaf).zip(&self.leaves).with_min_len(256).for_each(
            |(rows, &(first, count))| {
                let ids = &self.order[first as usize..][..count as usize];
                if inline {
                    write_block(rows, &triangles_of(ids, source));
                } else {
                    write_ids(rows, &ids_of(ids));
                }
            },
        );
        Ok(arena)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::wide::{collapse::collapse, direct};
    use crate::accel::bvh::{binned, prims, sah};
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

    /// Every leaf is linked to once, every triangle is in one, and no lane leads nowhere.
    fn check<const W: usize>(shape: &Shape<W>, source: &TriangleList, inline: bool) {
        let arena = shape.write(source, inline).expect("memory");
        let mut seen = vec![false; source.len()];
        let mut open = vec![shape.root().expect("triangles")];
        let mut visited = 0;
        while let Some(link) = open.pop() {
            visited += 1;
            let rows = arena.rows();
            if link.is_leaf() {
                let ids = if inline { rows.block(link).ids } else { rows.ids(link) };
                for id in ids.iter().filter(|&&id| id != TriangleId::NONE) {
                    assert!(!std::mem::replace(&mut seen[id.index()], true));
                }
                continue;
            }
            let (planes, links) = rows.node(link);
            let taken = (0..W).filter(|&lane| planes[0][lane] <= planes[1][lane]);
            open.extend(taken.map(|lane| Link(links[lane])));
        }
        assert!(seen.iter().all(|&s| s));
        assert_eq!(visited, shape.report.nodes + shape.report.leaves);
    }

    fn check_builds<const W: usize>(count: usize, fill: sah::Fill) {
        let source = triangles(count);
        let cost = sah::Cost { traversal: sah::TRAVERSAL, width: W, fill };
        let collapsed = collapse::<W>(binned::build(&mut prims::prims(&source), cost));
        let direct = direct::build::<W>(prims::prims(&source), cost);
        for inline in [false, true] {
            check(&collapsed, &source, inline);
            check(&direct, &source, inline);
        }
        // The same splits, chosen by the same rule: the same tree, to the order in memory.
        assert_eq!(direct.order, collapsed.order);
        assert_eq!(direct.leaves, collapsed.leaves);
        assert_eq!(direct.report.sah_cost, collapsed.report.sah_cost);
        for (ours, theirs) in direct.nodes.iter().zip(&collapsed.nodes) {
            assert_eq!(ours.bounds, theirs.bounds);
        }
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
