//! From a binary tree to a wide one.
//!
//! A node takes the two children of a binary node and opens, again and again, the inner one of the
//! largest surface until it has `W` (Dammertz, Hanika and Keller, "Shallow bounding volume
//! hierarchies for fast SIMD ray tracing of incoherent rays", 2008; Ernst and Greiner take every
//! second level, which at `W = 4` differs only where a grandchild is a leaf, and would leave many
//! lanes empty at 8 and 16). Leaves are taken over as they are.

use super::shape::{Below, Child, Shape, Source};
use crate::accel::bvh::{BinaryNode, BinaryTree};

/// Collapses a tree.
pub fn collapse<const W: usize>(tree: BinaryTree) -> Shape<W> {
    let triangles = tree.triangle_count();
    let BinaryTree { nodes, order, parts } = tree;
    Shape::new(&Binary::<W> { nodes: &nodes }, order, parts, triangles)
}

/// The nodes of a binary tree, those between two levels of the wide one left out.
struct Binary<'a, const W: usize> {
    nodes: &'a [BinaryNode],
}

impl<const W: usize> Binary<'_, W> {
    fn child(&self, index: u32) -> Child {
        let node = &self.nodes[index as usize];
        let below =
            if node.is_leaf() { Below::Leaf(node.first, node.count) } else { Below::Node(index) };
        Child { bounds: node.bounds, below }
    }

    fn pair(&self, parent: u32) -> [u32; 2] {
        [parent + 1, self.nodes[parent as usize].first]
    }

    /// Area of a node that can be opened; leaves can't.
    fn area(&self, index: u32) -> f64 {
        let node = &self.nodes[index as usize];
        if node.is_leaf() { -1.0 } else { node.bounds.half_area() }
    }
}

impl<const W: usize> Source<W> for Binary<'_, W> {
    fn root(&self) -> Option<Child> {
        (!self.nodes.is_empty()).then(|| self.child(0))
    }

    /// Descendants that cover all that is below a node.
    fn children(&self, node: u32) -> impl Iterator<Item = Child> {
        let (mut open, mut areas) = ([0; W], [-1.0; W]);
        open[..2].copy_from_slice(&self.pair(node));
        areas[..2].copy_from_slice(&self.pair(node).map(|child| self.area(child)));
        let mut count = 2;
        while count < W
            && let Some(largest) = largest(&areas[..count])
        {
            let [first, second] = self.pair(open[largest]);
            (open[largest], areas[largest]) = (first, self.area(first));
            (open[count], areas[count]) = (second, self.area(second));
            count += 1;
        }
        open.into_iter().take(count).map(|index| self.child(index))
    }
}

/// The first of the largest areas that are not negative.
pub fn largest(areas: &[f64]) -> Option<usize> {
    let mut largest = 0;
    for lane in 1..areas.len() {
        if areas[lane] > areas[largest] {
            largest = lane;
        }
    }
    (areas[largest] >= 0.0).then_some(largest)
}
