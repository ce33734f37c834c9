//! The binary tree that builders make: plain data.

use super::Parts;
use crate::accel::BuildReport;
use crate::math::{Aabb, PrimId};

/// A node: a leaf if `count` is not zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinaryNode {
    /// Box of all triangles below.
    pub bounds: Aabb,
    /// Of a leaf: its first place in the order. Of an inner node: its second child; the first one
    /// follows the node itself.
    pub first: u32,
    /// Triangles of a leaf.
    pub count: u32,
}

impl BinaryNode {
    /// Whether it holds triangles.
    #[inline(always)]
    pub fn is_leaf(&self) -> bool {
        self.count > 0
    }
}

/// A binary tree in depth-first order; no nodes if there are no triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryTree {
    /// The root first.
    pub nodes: Vec<BinaryNode>,
    /// Triangles, leaf by leaf; one may be in several if leaves hold parts.
    pub order: Vec<PrimId>,
    /// If some leaf holds a part of a triangle only: which rays the boxes are good for.
    pub parts: Option<Parts>,
}

impl BinaryTree {
    /// Appends the subtree `other` to this one.
    ///
    /// Its leaves' places must be right already; its nodes' links are moved.
    pub(super) fn append_nodes(nodes: &mut Vec<BinaryNode>, other: &[BinaryNode]) {
        let offset = nodes.len() as u32;
        nodes.extend(other.iter().map(|node| BinaryNode {
            first: if node.is_leaf() { node.first } else { node.first + offset },
            ..*node
        }));
    }

    /// How many triangles there are, each counted once however many leaves hold a part of it.
    pub fn triangle_count(&self) -> usize {
        self.order.iter().map(|id| id.index() + 1).max().unwrap_or(0)
    }

    /// The triangles of a leaf.
    pub fn triangles(&self, leaf: &BinaryNode) -> &[PrimId] {
        &self.order[leaf.first as usize..][..leaf.count as usize]
    }

    /// Shape and expected cost, with a step and a leaf at the same price.
    pub fn report(&self) -> BuildReport {
        // Each is in some leaf, so that the last one tells how many there are.
        let mut report = BuildReport { triangles: self.triangle_count(), ..BuildReport::default() };
        let Some(root) = self.nodes.first() else { return report };
        let mut stack = vec![(0_u32, 0_usize)];
        let (mut area, mut depths) = (0.0, 0);
        while let Some((index, depth)) = stack.pop() {
            let node = &self.nodes[index as usize];
            area += node.bounds.half_area();
            if node.is_leaf() {
                report.leaves += 1;
                depths += depth;
                report.max_depth = report.max_depth.max(depth);
            } else {
                report.nodes += 1;
                stack.extend([(node.first, depth + 1), (index + 1, depth + 1)]);
            }
        }
        report.sah_cost = area / root.bounds.half_area().max(f64::MIN_POSITIVE);
        report.mean_leaf = self.order.len() as f64 / report.leaves as f64;
        report.mean_depth = depths as f64 / report.leaves as f64;
        report
    }

    /// Checks that every box holds what is below it and every triangle is in exactly one leaf, or
    /// if there are parts, that the leaves of a triangle hold its own box together.
    ///
    /// # Errors
    /// What is wrong.
    pub fn validate(&self, bounds_of: impl Fn(PrimId) -> Aabb) -> Result<(), String> {
        let mut held = vec![Aabb::EMPTY; self.order.len()];
        let mut places = vec![false; self.order.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            if !node.is_leaf() {
                for child in [index + 1, node.first as usize] {
                    let child_bounds = self.nodes.get(child).ok_or("a link leads nowhere")?.bounds;
                    if !node.bounds.contains(child_bounds) {
                        return Err(format!("node {index} does not hold its child {child}"));
                    }
                }
                continue;
            }
            for place in node.first..node.first + node.count {
                if std::mem::replace(&mut places[place as usize], true) {
                    return Err(format!("place {place} is in two leaves"));
                }
            }
            for &id in self.triangles(node) {
                let held = &mut held[id.index()];
                if self.parts.is_none() && !held.is_empty() {
                    return Err(format!("triangle {id:?} is in two leaves"));
                }
                *held = held.union(node.bounds);
            }
        }
        if !places.iter().all(|&used| used) {
            return Err("a place is in no leaf".to_owned());
        }
        let count = self.order.iter().map(|id| id.index() + 1).max().unwrap_or(0);
        let missed = (0..count).find(|&i| !held[i].contains(bounds_of(PrimId::from_index(i))));
        missed.map_or(Ok(()), |i| Err(format!("no leaf holds all of triangle {i}")))
    }
}
