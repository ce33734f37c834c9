//! From a binary tree to a wide one.
//!
//! A node takes the two children of a binary node and opens, again and again, the inner one of the
//! largest surface until it has `W` (Dammertz, Hanika and Keller, "Shallow bounding volume
//! hierarchies for fast SIMD ray tracing of incoherent rays", 2008; Ernst and Greiner take every
//! second level, which at `W = 4` differs only where a grandchild is a leaf, and would leave many
//! lanes empty at 8 and 16). Leaves are taken over as they are.

use super::arena::{Arena, BLOCK, NODE, write_block, write_ids, write_node};
use crate::accel::BuildReport;
use crate::accel::bvh::leaves::{ids_of, triangles_of};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::{BinaryNode, BinaryTree};
use crate::geom::TriangleSource;
use crate::math::Aabb;

use rayon::prelude::*;

/// The shape of a wide tree.
pub struct Collapsed<const W: usize> {
    /// Nodes, the root first; each with its children. The nodes that a node links to stand
    /// together.
    nodes: Vec<Children<W>>,
    /// For each leaf the node of the binary tree.
    leaves: Vec<u32>,
    /// Its shape in figures.
    pub report: BuildReport,
}

/// Up to `W` nodes of the binary tree, and the place of each among the wide nodes or the leaves.
#[derive(Clone, Copy)]
struct Children<const W: usize> {
    count: usize,
    of_tree: [u32; W],
    places: [u32; W],
}

impl<const W: usize> Collapsed<W> {
    /// Collapses a tree.
    pub fn new(tree: &BinaryTree) -> Self {
        let triangles = tree.triangle_count();
        let report = BuildReport { triangles, ..BuildReport::default() };
        let mut wide = Self { nodes: Vec::new(), leaves: Vec::new(), report };
        let Some(root) = tree.nodes.first() else { return wide };
        let (mut area, mut depths) = (0.0, 0);
        let mut open = vec![(0_u32, wide.add(root, 0), 0_usize)];
        while let Some((index, place, depth)) = open.pop() {
            let node = &tree.nodes[index as usize];
            area += node.bounds.half_area();
            if node.is_leaf() {
                depths += depth;
                wide.report.max_depth = wide.report.max_depth.max(depth);
                continue;
            }
            let mut children = Children::below(&tree.nodes, index);
            for lane in (0..children.count).rev() {
                let child = children.of_tree[lane];
                let place = wide.add(&tree.nodes[child as usize], child);
                children.places[lane] = place;
                open.push((child, place, depth + 1));
            }
            wide.nodes[place as usize] = children;
        }
        wide.report.nodes = wide.nodes.len();
        wide.report.leaves = wide.leaves.len();
        wide.report.sah_cost = area / root.bounds.half_area().max(f64::MIN_POSITIVE);
        wide.report.mean_leaf = tree.order.len() as f64 / wide.leaves.len() as f64;
        wide.report.mean_depth = depths as f64 / wide.leaves.len() as f64;
        wide
    }

    /// Makes room for a node of the binary tree.
    fn add(&mut self, node: &BinaryNode, index: u32) -> u32 {
        if node.is_leaf() {
            self.leaves.push(index);
            self.leaves.len() as u32 - 1
        } else {
            self.nodes.push(Children { count: 0, of_tree: [0; W], places: [0; W] });
            self.nodes.len() as u32 - 1
        }
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
    pub fn write(
        &self,
        tree: &BinaryTree,
        source: &dyn TriangleSource,
        inline: bool,
    ) -> std::io::Result<Arena<W>> {
        let mut arena = Arena::new(self.rows(inline))?;
        let (first_leaf, of_leaf) = (self.first_leaf(), Self::leaf_rows(inline));
        let (nodes, leaves) = arena.floats_mut().split_at_mut(first_leaf);
        nodes.par_chunks_mut(NODE).zip(&self.nodes).with_min_len(256).for_each(|(rows, node)| {
            let mut children = [(Aabb::EMPTY, Link::to_node(0)); W];
            for lane in 0..node.count {
                let of_tree = &tree.nodes[node.of_tree[lane] as usize];
                let place = node.places[lane] as usize;
                let link = if of_tree.is_leaf() {
                    Link::to_leaf(first_leaf + place * of_leaf)
                } else {
                    Link::to_node(place * NODE)
                };
                children[lane] = (of_tree.bounds, link);
            }
            write_node(rows, &children[..node.count]);
        });
        leaves.par_chunks_mut(of_leaf).zip(&self.leaves).with_min_len(256).for_each(
            |(rows, &leaf)| {
                let ids = tree.triangles(&tree.nodes[leaf as usize]);
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

impl<const W: usize> Children<W> {
    /// Descendants of an inner node that cover all that is below it.
    fn below(nodes: &[BinaryNode], parent: u32) -> Self {
        let pair = |index: u32| [index + 1, nodes[index as usize].first];
        let mut children = Self { count: 2, of_tree: [0; W], places: [0; W] };
        children.of_tree[..2].copy_from_slice(&pair(parent));
        // Areas of those that can be opened; leaves can't.
        let area = |index: u32| {
            let node = &nodes[index as usize];
            if node.is_leaf() { -1.0 } else { node.bounds.half_area() }
        };
        let mut areas = [-1.0; W];
        areas[..2].copy_from_slice(&pair(parent).map(area));
        while children.count < W {
            let mut largest = 0;
            for lane in 1..children.count {
                if areas[lane] > areas[largest] {
                    largest = lane;
                }
            }
            if areas[largest] < 0.0 {
                break;
            }
            let [first, second] = pair(children.of_tree[largest]);
            (children.of_tree[largest], areas[largest]) = (first, area(first));
            (children.of_tree[children.count], areas[children.count]) = (second, area(second));
            children.count += 1;
        }
        children
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::{binned, prims, sah};
    use crate::geom::{Triangle, TriangleList};
    use crate::math::{TriangleId, Vec3};

    fn triangles(count: usize) -> TriangleList {
        let at = |i: usize| {
            let f = |k: usize| ((i * k) % 101) as f32 * 0.1;
            Vec3::new(f(37), f(59), f(83))
        };
        let triangle = |i| Triangle { a: at(i), b: at(i) + Vec3::X, c: at(i) + Vec3::Y };
        TriangleList((0..count).map(triangle).collect())
    }

    /// Every leaf is linked to once, every triangle is in one, and no lane leads nowhere.
    fn check<const W: usize>(count: usize, inline: bool) {
        let source = triangles(count);
        let mut prims = prims::prims(&source);
        let tree = binned::build(
            &mut prims,
            sah::Cost { traversal: sah::TRAVERSAL, width: W, fill: sah::Fill::Any },
        );
        let wide = Collapsed::<W>::new(&tree);
        let arena = wide.write(&tree, &source, inline).expect("memory");
        let mut seen = vec![false; count];
        let mut open = vec![wide.root().expect("triangles")];
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
        assert_eq!(visited, wide.report.nodes + wide.report.leaves);
    }

    #[test]
    fn all_leaves_stay_and_no_more() {
        for count in [1, 2, 5, 17, 300, 2000] {
            for inline in [false, true] {
                check::<4>(count, inline);
                check::<8>(count, inline);
                check::<16>(count, inline);
            }
        }
    }
}
