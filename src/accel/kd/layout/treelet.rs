//! Subtrees of three levels, each on one cache line.
//!
//! - V. Havran, "Analysis of cache sensitive representation for binary space partitioning trees",
//!   1999: seven places in the order of a heap, and the children of the lowest four.
//! - L. Szécsi, "An effective implementation of the k-D tree", 2003: a leaf below the lowest level
//!   takes the place of the pointer to it instead of a line of its own.
//!
//! Both leave places empty below leaves that lie higher up, so they need more memory than
//! [`super::Compact`]; a step within a line is free of cache misses.

use super::nodes::{Layout, Nodes, View};
use crate::accel::kd::tree::{KdTree, LeafId, Node};
use crate::math::NodeId;

/// Havran's: a leaf that hangs below a line has a line of its own.
pub type Treelet = Treelets<false>;

/// Szécsi's: it takes the place of the pointer to it.
pub type TreeletFilled = Treelets<true>;

/// Treelets of seven places.
#[derive(Clone, Debug)]
pub struct Treelets<const FILLED: bool> {
    lines: Vec<CacheLine>,
}

/// A node's handle is its line times eight plus its place; with the top bit it is a leaf's number.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct CacheLine {
    /// The splits' bits, or the leaves' numbers.
    splits: [u32; 8],
    /// The children of places 3 to 6. The eighth split's place is the axes', two bits a place.
    exits: [u32; 8],
}

const AXES: usize = 7;
const LEAF: u32 = 3;
const IS_LEAF: u32 = 1 << 31;

impl<const FILLED: bool> Layout for Treelets<FILLED> {
    fn new(tree: &KdTree) -> Self {
        let empty = CacheLine { splits: [0; 8], exits: [u32::MAX; 8] };
        let mut lines = vec![empty];
        let mut roots = vec![(NodeId(0), 0)];
        while let Some((root, line)) = roots.pop() {
            let mut places = vec![(root, 0)];
            while let Some((at, place)) = places.pop() {
                let place: usize = place;
                let (axis, split) = match tree.nodes[at.index()] {
                    Node::Leaf(leaf) => (LEAF, leaf.0),
                    Node::Inner { axis, split, above } => {
                        for (side, child) in [NodeId(at.0 + 1), above].into_iter().enumerate() {
                            let lower = 2 * place + 1 + side;
                            if lower < AXES {
                                places.push((child, lower));
                                continue;
                            }
                            lines[line].exits[lower - AXES] = match tree.nodes[child.index()] {
                                Node::Leaf(leaf) if FILLED => IS_LEAF | leaf.0,
                                _ => {
                                    roots.push((child, lines.len()));
                                    lines.push(empty);
                                    (lines.len() as u32 - 1) << 3
                                }
                            };
                        }
                        (u32::from(axis), split.to_bits())
                    }
                };
                lines[line].splits[place] = split;
                lines[line].splits[AXES] |= axis << (2 * place);
            }
        }
        Self { lines }
    }
}

impl<const FILLED: bool> Nodes for Treelets<FILLED> {
    #[inline(always)]
    fn root(&self) -> NodeId {
        NodeId(0)
    }

    #[inline(always)]
    fn view(&self, at: NodeId) -> View {
        if FILLED && at.0 & IS_LEAF != 0 {
            return View::Leaf(LeafId(at.0 ^ IS_LEAF));
        }
        let line = &self.lines[(at.0 >> 3) as usize];
        let place = (at.0 & 7) as usize;
        let axis = (line.splits[AXES] >> (2 * place)) & 3;
        if axis == LEAF {
            return View::Leaf(LeafId(line.splits[place]));
        }
        let children = if place < 3 {
            let lower = (at.0 & !7) + 2 * place as u32 + 1;
            [lower, lower + 1]
        } else {
            let exit = (2 * (place - 3)) & 7;
            [line.exits[exit], line.exits[exit + 1]]
        };
        View::Inner {
            axis: axis as usize,
            split: f32::from_bits(line.splits[place]),
            children: children.map(NodeId),
        }
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.lines)
    }
}
