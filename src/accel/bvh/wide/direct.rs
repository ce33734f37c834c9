//! Wide trees built in one pass, without a binary tree in between.
//!
//! M. Ernst and G. Greiner, "Multi bounding volume hierarchies", 2008, section 3.1, name it as
//! future work. A node begins with all its triangles in one part and splits, again and again, the
//! part of the largest surface until it has `W`: by equal bins of centroids and the surface area
//! heuristic, as [`super::super::binned`] does, and by the same rule by which [`super::collapse`]
//! opens nodes. So the tree is the one that is collapsed from a binned one, to the bit; no node is
//! written that is thrown away again.

use rayon::prelude::*;

use super::collapse::find_largest;
use super::shape::{Below, Child, Shape, Source};
use crate::accel::Steps;
use crate::accel::bvh::objects::{ObjectSplit, find_bounds};
use crate::accel::bvh::prims::Prim;
use crate::accel::bvh::sah::Costs;
use crate::math::Aabb;

/// Subtrees with fewer are built by one thread.
const PARALLEL_SUBTREES: usize = 1 << 13;

/// Builds a tree of nodes with up to `W` children.
pub fn build<const W: usize>(
    mut prims: Vec<Prim>,
    costs: Costs,
    steps: &Steps<'_>,
) -> Shape<W, impl Source<W> + use<W>> {
    let triangles = prims.len();
    let mut nodes = vec![[None; W]];
    if !prims.is_empty() {
        let builder = Builder { costs, task: (triangles / 64).max(PARALLEL_SUBTREES), steps };
        let all = builder.make_part(&mut prims, 0, 0);
        nodes[ABOVE_ROOT][0] = Some(builder.append_subtree(all, &mut nodes));
    }
    let order = prims.iter().map(|prim| prim.id).collect();
    Shape::new(Nodes { nodes }, order, None)
}

/// The children of a node.
type Children<const W: usize> = [Option<Child>; W];

/// Nodes, each after those above it. A child's number is its node's times `W`, and its lane.
struct Nodes<const W: usize> {
    nodes: Vec<Children<W>>,
}

/// The place of a node whose only child is the root.
const ABOVE_ROOT: usize = 0;

impl<const W: usize> Nodes<W> {
    fn lane(&self, number: u32) -> Option<Child> {
        self.nodes[number as usize / W][number as usize % W]
    }
}

impl<const W: usize> Source<W> for Nodes<W> {
    fn root(&self) -> Option<u32> {
        let root = (ABOVE_ROOT * W) as u32;
        self.lane(root).map(|_| root)
    }

    fn child(&self, number: u32) -> Child {
        self.lane(number).expect("lanes that hold a child")
    }

    fn children(&self, node: u32) -> (usize, [u32; W]) {
        let count = self.nodes[node as usize].iter().flatten().count();
        (count, std::array::from_fn(|lane| node * W as u32 + lane as u32))
    }
}

/// Primitives that go together, from place `first` of the whole on.
struct Part<'a> {
    prims: &'a mut [Prim],
    first: usize,
    /// Splits above it, as a binary tree would count them.
    depth: usize,
    bounds: Aabb,
    /// How to split it; `None` for a leaf.
    split: Option<ObjectSplit>,
}

struct Builder<'a> {
    costs: Costs,
    task: usize,
    steps: &'a Steps<'a>,
}

impl Builder<'_> {
    /// A part, and whether and how it is best split.
    fn make_part<'a>(&self, prims: &'a mut [Prim], first: usize, depth: usize) -> Part<'a> {
        let (bounds, keys) = find_bounds(prims);
        let split = (!self.costs.must_be_leaf(prims.len()))
            .then(|| ObjectSplit::find_best(prims, keys, depth, &self.costs))
            .filter(|s| !self.costs.prefers_leaf(prims.len(), &bounds, s.split().area));
        Part { prims, first, depth, bounds, split }
    }

    /// Both sides of a part.
    fn split_part<'a>(&self, part: Part<'a>, split: &ObjectSplit) -> [Part<'a>; 2] {
        let Part { prims, first, depth, .. } = part;
        let parallel = prims.len() > self.task;
        let middle = split.apply(prims, &self.costs);
        let (left, right) = prims.split_at_mut(middle);
        let side = |prims: &'a mut [Prim], first| self.make_part(prims, first, depth + 1);
        if parallel {
            rayon::join(|| side(left, first), || side(right, first + middle)).into()
        } else {
            [side(left, first), side(right, first + middle)]
        }
    }

    /// Parts that cover a part: as many as a node has children.
    fn split_into_parts<'a, const W: usize>(
        &self,
        part: Part<'a>,
        split: &ObjectSplit,
    ) -> Vec<Part<'a>> {
        // Leaves can't be opened.
        let area = |part: &Part<'_>| match part.split {
            Some(_) => part.bounds.half_area(),
            None => -1.0,
        };
        let mut parts = Vec::with_capacity(W);
        parts.extend(self.split_part(part, split));
        let mut areas = [-1.0; W];
        areas[..2].copy_from_slice(&[area(&parts[0]), area(&parts[1])]);
        while parts.len() < W
            && let Some(at) = find_largest(&areas[..parts.len()])
            && let Some(split) = parts[at].split.take()
        {
            let [left, right] = self.split_part(parts.remove(at), &split);
            (areas[at], areas[parts.len() + 1]) = (area(&left), area(&right));
            parts.insert(at, left);
            parts.push(right);
        }
        parts
    }

    /// Appends the subtree of a part.
    fn append_subtree<const W: usize>(
        &self,
        mut part: Part<'_>,
        nodes: &mut Vec<Children<W>>,
    ) -> Child {
        let bounds = part.bounds;
        let Some(split) = part.split.take() else {
            let (first, count) = (part.first as u32, part.prims.len() as u32);
            return Child { bounds, below: Below::Leaf(first, count) };
        };
        let node = nodes.len();
        nodes.push([None; W]);
        let parallel = part.prims.len() > self.task;
        let parts = self.split_into_parts::<W>(part, &split);
        if parallel {
            let subtrees: Vec<(Child, Vec<Children<W>>)> = parts
                .into_par_iter()
                .map(|part| {
                    let (mut below, count) = (Vec::new(), part.prims.len());
                    let child = self.append_subtree(part, &mut below);
                    if count <= self.task {
                        self.steps.place(count);
                    }
                    (child, below)
                })
                .collect();
            for (lane, (child, below)) in subtrees.into_iter().enumerate() {
                let offset = nodes.len() as u32;
                nodes[node][lane] = Some(shift(child, offset));
                nodes.extend(
                    below.iter().map(|stripe| stripe.map(|child| Some(shift(child?, offset)))),
                );
            }
        } else {
            for (lane, part) in parts.into_iter().enumerate() {
                nodes[node][lane] = Some(self.append_subtree(part, nodes));
            }
        }
        Child { bounds, below: Below::Node(node as u32) }
    }
}

/// A child whose subtree lies so many nodes further back.
fn shift(child: Child, offset: u32) -> Child {
    match child.below {
        Below::Node(node) => Child { below: Below::Node(node + offset), ..child },
        Below::Leaf(..) => child,
    }
}
