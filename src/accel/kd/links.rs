//! Links from the faces of leaves to what lies behind them.

use super::layout::Compact;
use super::tree::{KdTree, LeafId, Node, halves};
use crate::math::{Aabb, NodeId};

/// What [`super::walk::neighbours`] follows.
pub trait Links: Send + Sync {
    /// Derives them from a tree.
    fn new(tree: &KdTree) -> Self;

    /// The nodes that links lead to; `main` are the tree's own.
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact;

    /// A leaf's cell; planes at the rim are infinite.
    fn cell(&self, leaf: LeafId) -> &Aabb;

    /// Behind the lower (0) or upper (1) face along an axis; [`NodeId::NONE`] at the rim.
    fn link(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId;

    /// Bytes by part.
    fn memory(&self) -> Vec<(&'static str, usize)>;
}

/// A leaf's place among its neighbours.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Place {
    cell: Aabb,
    /// Per axis, what is behind the lower and the upper face.
    links: [[NodeId; 2]; 3],
}

/// Neighbour links, or ropes: one node a face, the deepest that covers all of it. A leaf is a
/// direct link, an inner node an indirect one.
///
/// - D. MacDonald, K. Booth, "Heuristics for ray tracing using space subdivision", 1990.
/// - V. Havran, J. Bittner, J. Žára, "Ray tracing with rope trees", 1998.
/// - S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007:
///   made on the way down, each link pushed down as far as it goes.
#[derive(Debug)]
pub struct Ropes {
    places: Vec<Place>,
}

impl Links for Ropes {
    fn new(tree: &KdTree) -> Self {
        Self { places: places(tree) }
    }

    #[inline(always)]
    fn nodes<'a>(&'a self, main: &'a Compact) -> &'a Compact {
        main
    }

    #[inline(always)]
    fn cell(&self, leaf: LeafId) -> &Aabb {
        &self.places[leaf.index()].cell
    }

    #[inline(always)]
    fn link(&self, leaf: LeafId, axis: usize, side: usize) -> NodeId {
        self.places[leaf.index()].links[axis][side]
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        vec![("links", size_of_val(&*self.places))]
    }
}

/// The places of all leaves, in their order.
fn places(tree: &KdTree) -> Vec<Place> {
    let mut places = Vec::with_capacity(tree.base.leaves.len());
    let root = Place { cell: KdTree::SPACE, links: [[NodeId::NONE; 2]; 3] };
    let mut todo = vec![(NodeId(0), root)];
    while let Some((at, mut place)) = todo.pop() {
        push_down(tree, &mut place);
        let Node::Inner { axis, split, above } = tree.nodes[at.index()] else {
            // Depth-first order is the order of the leaves.
            places.push(place);
            continue;
        };
        let axis = axis as usize;
        let below = NodeId(at.0 + 1);
        let [low, high] = halves(&place.cell, axis, split);
        let (mut low, mut high) = (Place { cell: low, ..place }, Place { cell: high, ..place });
        low.links[axis][1] = above;
        high.links[axis][0] = below;
        todo.push((above, high));
        todo.push((below, low));
    }
    places
}

/// Moves each link down to the deepest node that covers the whole face.
fn push_down(tree: &KdTree, place: &mut Place) {
    for axis in 0..3 {
        for side in 0..2 {
            let link = &mut place.links[axis][side];
            while *link != NodeId::NONE
                && let Node::Inner { axis: other, split, above } = tree.nodes[link.index()]
            {
                let below = NodeId(link.0 + 1);
                let other = other as usize;
                *link = if other == axis {
                    // The child at the face: above an upper one it is the one below.
                    if side == 1 { below } else { above }
                } else if split <= place.cell.min[other] {
                    above
                } else if split >= place.cell.max[other] {
                    below
                } else {
                    break;
                };
            }
        }
    }
}
