//! From a binary tree to a wide one.
//!
//! A node takes the two children of a binary node and opens, again and again, the inner one of the
//! largest surface until it has `W` (Dammertz, Hanika and Keller, "Shallow bounding volume
//! hierarchies for fast SIMD ray tracing of incoherent rays", 2008). Ernst and Greiner take every
//! second level instead: there both children of the binary node are opened, here the larger of
//! their children may be opened in place of the smaller of the two, also at `W = 4`; and at 8 and
//! 16 a rule by levels would leave many lanes empty, where a leaf lies high. Leaves are taken over
//! as they are.

use super::shape::{Below, Child, Shape, Source};
use crate::accel::bvh::{BinaryNode, BinaryTree};
use crate::simd::prefetch;

/// Collapses a tree.
pub fn collapse<const W: usize>(tree: BinaryTree) -> Shape<W, impl Source<W>> {
    let BinaryTree { nodes, order, parts } = tree;
    Shape::new(Binary { nodes }, order, parts)
}

/// The nodes of a binary tree, those between two levels of the wide one left out.
pub struct Binary {
    /// The root first.
    pub nodes: Vec<BinaryNode>,
}

impl Binary {
    /// The children of a binary node.
    pub fn pair(&self, parent: u32) -> [u32; 2] {
        [parent + 1, self.nodes[parent as usize].first]
    }

    /// Whether a binary node is a leaf.
    pub fn is_leaf(&self, index: u32) -> bool {
        self.nodes[index as usize].is_leaf()
    }

    /// Area of a node that can be opened; leaves can't.
    fn area(&self, index: u32) -> f64 {
        let node = self.node(index);
        if node.is_leaf() { -1.0 } else { node.bounds.half_area() }
    }

    /// A node. Its second child lies far behind it and will be needed soon.
    fn node(&self, index: u32) -> &BinaryNode {
        let node = &self.nodes[index as usize];
        prefetch(&self.nodes, node.first as usize, size_of::<BinaryNode>());
        node
    }
}

impl<const W: usize> Source<W> for Binary {
    fn root(&self) -> Option<u32> {
        (!self.nodes.is_empty()).then_some(0)
    }

    fn child(&self, number: u32) -> Child {
        let node = self.node(number);
        let below =
            if node.is_leaf() { Below::Leaf(node.first, node.count) } else { Below::Node(number) };
        Child { bounds: node.bounds, below }
    }

    /// Descendants that cover all that is below a node.
    fn children(&self, node: u32) -> (usize, [u32; W]) {
        let (mut open, mut areas) = ([0; W], [-1.0; W]);
        open[..2].copy_from_slice(&self.pair(node));
        areas[..2].copy_from_slice(&self.pair(node).map(|child| self.area(child)));
        let mut count = 2;
        while count < W
            && let Some(largest) = find_largest(&areas[..count])
        {
            let [first, second] = self.pair(open[largest]);
            (open[largest], areas[largest]) = (first, self.area(first));
            (open[count], areas[count]) = (second, self.area(second));
            count += 1;
        }
        (count, open)
    }
}

/// The first of the largest areas that are not negative.
pub fn find_largest(areas: &[f64]) -> Option<usize> {
    let mut largest = 0;
    for lane in 1..areas.len() {
        if areas[lane] > areas[largest] {
            largest = lane;
        }
    }
    (areas[largest] >= 0.0).then_some(largest)
}
