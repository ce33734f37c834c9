//! What all builders promise.

use super::BinaryTree;
use super::build::build_tree;
use super::refine::refine;
use super::sah::{Costs, Fill};
use crate::accel::{Phases, Steps};
use crate::geom::{Triangle, TriangleList, TriangleSource, own_box};
use crate::math::{PrimId, Vec3};

const BUILDERS: [&str; 4] = ["binned", "sweep", "esc", "sbvh"];

/// Triangles of all sizes, some of them long and thin.
fn cloud(count: usize) -> TriangleList {
    let mut state = count as u32 + 1;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / 16_777_216.0
    };
    let mut point = || Vec3::new(random(), random(), random());
    let triangle = |i: usize| {
        let (a, size) = (point(), [0.02, 0.1, 0.9][i % 3]);
        let b = a + (point() - 0.5) * size;
        Triangle { a, b, c: b + (point() - 0.5) * [0.01, size][i % 2] }
    };
    TriangleList((0..count).map(triangle).collect())
}

fn copies(count: usize) -> TriangleList {
    TriangleList(vec![Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y }; count])
}

fn tree_of(source: &TriangleList, builder: &str, width: usize, fill: Fill) -> BinaryTree {
    let costs = Costs { traversal_cost: 0.4, width, fill };
    build_tree(source, builder, costs, (&mut Phases::start(), &Steps::untold()))
}

fn check(source: &TriangleList, tree: &BinaryTree, what: &str) {
    let valid = tree.validate(|id| own_box(&source.triangle(id)));
    assert_eq!(valid, Ok(()), "{what}");
    let mut ids = tree.order.clone();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), source.len(), "{what}: triangles in leaves");
}

#[test]
fn trees_hold_all_triangles_in_leaves_of_at_most_a_block() {
    for count in [0, 1, 2, 3, 4, 5, 17, 100, 3000] {
        for source in [cloud(count), copies(count)] {
            for builder in BUILDERS {
                for fill in [Fill::Any, Fill::Full] {
                    let tree = tree_of(&source, builder, 4, fill);
                    check(&source, &tree, &format!("{builder}, {count}, {fill:?}"));
                    assert!(tree.nodes.iter().all(|node| node.count <= 4));
                    let tree = refine(tree, &Steps::untold());
                    check(&source, &tree, &format!("{builder}, {count}, {fill:?}, refined"));
                }
            }
        }
    }
}

#[test]
fn full_leaves_are_full_but_for_one() {
    let sizes = (1..70).chain([127, 128, 129, 1000, 5003]);
    for count in sizes {
        for source in [cloud(count), copies(count)] {
            for builder in ["binned", "sweep", "esc"] {
                for width in [4, 8, 16] {
                    let tree = tree_of(&source, builder, width, Fill::Full);
                    let what = format!("{builder}, {count} in leaves of {width}");
                    check(&source, &tree, &what);
                    let leaves = tree.nodes.iter().filter(|node| node.is_leaf());
                    let short: Vec<_> =
                        leaves.map(|leaf| leaf.count as usize).filter(|&n| n != width).collect();
                    let rest = tree.order.len() % width;
                    let expected = if rest == 0 { vec![] } else { vec![rest] };
                    assert_eq!(short, expected, "{what}");
                }
            }
        }
    }
}

#[test]
fn the_number_of_threads_does_not_show() {
    let source = cloud(30_000);
    let on = |threads: usize, builder: &str, fill: Fill| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let build = || refine(tree_of(&source, builder, 8, fill), &Steps::untold());
        pool.expect("threads start").install(build)
    };
    for builder in BUILDERS {
        for fill in [Fill::Any, Fill::Full] {
            let expected = on(1, builder, fill);
            for threads in [2, 5] {
                assert!(on(threads, builder, fill) == expected, "{builder} on {threads} threads");
            }
        }
    }
}

#[test]
fn splits_make_trees_cheaper_and_keep_to_their_budget() {
    let source = cloud(3000);
    let cost = |builder: &str| tree_of(&source, builder, 4, Fill::Any).report().sah_cost;
    let whole = cost("binned");
    assert!(cost("esc") < 0.98 * whole && cost("sbvh") < 0.8 * whole);
    for builder in ["esc", "sbvh"] {
        let references = tree_of(&source, builder, 4, Fill::Any).order.len();
        assert!((3001..=4500).contains(&references), "{builder}: {references}");
    }
}

#[test]
fn refinement_makes_trees_cheaper_and_leaves_the_leaves_alone() {
    let source = cloud(3000);
    for builder in BUILDERS {
        let tree = tree_of(&source, builder, 8, Fill::Full);
        let refined = refine(tree.clone(), &Steps::untold());
        let leaves = |tree: &BinaryTree| {
            let leaves = tree.nodes.iter().filter(|node| node.is_leaf());
            let mut lists: Vec<_> = leaves.map(|leaf| tree.triangles(leaf).to_vec()).collect();
            lists.sort();
            lists
        };
        assert!(leaves(&tree) == leaves(&refined), "{builder}");
        assert!(refined.report().sah_cost < tree.report().sah_cost, "{builder}");
    }
}

/// Every point of a triangle is in a leaf that lists it.
#[test]
fn leaves_of_parts_cover_their_triangles() {
    let source = cloud(400);
    for builder in ["esc", "sbvh"] {
        let tree = tree_of(&source, builder, 4, Fill::Any);
        let mut boxes = vec![Vec::new(); source.len()];
        for leaf in tree.nodes.iter().filter(|node| node.is_leaf()) {
            for &id in tree.triangles(leaf) {
                boxes[id.index()].push(leaf.bounds);
            }
        }
        for (i, boxes) in boxes.iter().enumerate() {
            let triangle = source.triangle(PrimId::from_index(i));
            let (Triangle { a, b, c }, bounds) = (triangle, triangle.bounds());
            for step in 0..2000 {
                let (s, t) = ((step % 40) as f32 / 39.0, (step / 40) as f32 / 49.0);
                let point = a + ((b - a) * (1.0 - t) + (c - a) * t) * s;
                let point = point.clamp(bounds.min, bounds.max);
                let inside =
                    boxes.iter().any(|b| b.contains(crate::math::Aabb { min: point, max: point }));
                assert!(inside, "{builder}: a point of triangle {i} is in no leaf of it");
            }
        }
    }
}
