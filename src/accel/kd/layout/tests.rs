//! All layouts hold the same tree.

use std::sync::Arc;

use super::{Basic, Clustered, Compact, Layout, Nodes, Treelet, TreeletFilled, View};
use crate::accel::kd::build::OPTIONS;
use crate::accel::kd::tree::{KdTree, Node};
use crate::accel::{Options, Steps};
use crate::geom::{Triangle, TriangleList, TriangleSource};
use crate::math::{NodeId, Vec3};

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
    KdTree::build(&source, &options, &Steps::untold()).expect("it is small")
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
            (Node::Inner { axis, split, above }, View::Inner { axis: a, split: s, children }) => {
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
