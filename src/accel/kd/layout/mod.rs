//! Layouts: how nodes lie in memory. They know nothing of builds and traversals.

mod basic;
mod clustered;
mod compact;
mod treelet;

pub use basic::Basic;
pub use clustered::Clustered;
pub use compact::{Compact, Packed};
pub use treelet::{Treelet, TreeletFilled};

use super::tree::{KdTree, LeafId};
use crate::math::NodeId;

/// What a walk sees of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Divides its cell.
    Inner {
        /// 0 to 2.
        axis: usize,
        /// Coordinate of the plane.
        split: f32,
        /// Below the plane, and above it.
        children: [NodeId; 2],
    },
    /// Holds triangles.
    Leaf(LeafId),
}

/// The nodes of a tree, in some order and form.
pub trait Nodes: Send + Sync {
    /// The root.
    fn root(&self) -> NodeId;

    /// Reads a node.
    fn view(&self, at: NodeId) -> View;

    /// Bytes of the nodes.
    fn bytes(&self) -> usize;
}

/// A way to lay nodes out.
pub trait Layout: Nodes + Sized {
    /// Lays the nodes of a tree out.
    fn new(tree: &KdTree) -> Self;
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::tree::Node;
    use super::*;
    use crate::accel::Options;
    use crate::accel::kd::build::OPTIONS;
    use crate::geom::{Triangle, TriangleList, TriangleSource};
    use crate::math::Vec3;

    fn tree(count: usize) -> KdTree {
        let corner = |i: usize| Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, i as f32);
        let triangle = |i| {
            let a = corner(i);
            Triangle { a, b: a + Vec3::X, c: a + Vec3::ONE }
        };
        let list = TriangleList((0..count).map(triangle).collect());
        let source: Arc<dyn TriangleSource> = Arc::new(list);
        // Dear triangles, for a tree of many levels.
        let options = Options::parse("kd", &OPTIONS, "cost=0.4").expect("it is known");
        KdTree::build(&source, &options).expect("it is small")
    }

    /// Walks both side by side.
    fn same<L: Layout>(tree: &KdTree) {
        let layout = L::new(tree);
        let mut todo = vec![(NodeId(0), layout.root())];
        let mut seen = 0;
        while let Some((plain, laid)) = todo.pop() {
            seen += 1;
            match (tree.nodes[plain.index()], layout.view(laid)) {
                (Node::Leaf(a), View::Leaf(b)) => assert_eq!(a, b),
                (
                    Node::Inner { axis, split, above },
                    View::Inner { axis: a, split: s, children },
                ) => {
                    assert_eq!((axis as usize, split), (a, s));
                    todo.push((NodeId(plain.0 + 1), children[0]));
                    todo.push((above, children[1]));
                }
                (a, b) => panic!("{a:?} became {b:?}"),
            }
        }
        assert_eq!(seen, tree.nodes.len());
    }

    #[test]
    fn all_layouts_hold_the_same_tree() {
        for count in [0, 1, 2, 3, 10, 500] {
            let tree = tree(count);
            same::<Basic>(&tree);
            same::<Compact>(&tree);
            same::<Treelet>(&tree);
            same::<TreeletFilled>(&tree);
            same::<Clustered>(&tree);
        }
    }

    #[test]
    fn compact_takes_half_of_basic_and_filling_saves_lines() {
        let tree = tree(500);
        assert_eq!(Basic::new(&tree).bytes(), 2 * Compact::new(&tree).bytes());
        assert!(TreeletFilled::new(&tree).bytes() < Treelet::new(&tree).bytes());
    }
}
