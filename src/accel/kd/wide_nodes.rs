//! Subtrees of three levels as nodes of seven planes and eight children, and leaves as blocks.
//!
//! - V. Havran, "Analysis of cache sensitive representation for binary space partitioning trees",
//!   1999: a subtree lies on a cache line, as in [`super::layout::Treelet`].
//! - L. Szécsi, "An effective implementation of the k-D tree", 2003: leaves take the places of
//!   pointers.
//!
//! Here all nodes have the same shape, so that one stream of vector instructions can look at a
//! whole node: where a leaf lies higher up, the places below it are planes at infinity, with the
//! leaf below them and nothing above. A bit for each child says whether there is anything in it, so
//! that empty leaves are not visited at all. The pointer to a leaf is one to its triangles, which
//! lie there ready to be tested: more memory than the lists of [`super::tree::Leaves`] take, but
//! one cache miss in place of three, each of which had to wait for the one before.

use rayon::prelude::*;

use super::tree::{KdTree, LeafId, Leaves, Node};
use crate::accel::BuildError;
use crate::geom::{Triangle, TriangleBlock};
use crate::math::{NodeId, Vec3};

/// Triangles that are tested at once.
pub const WIDTH: usize = 8;

/// Triangles to test at once.
pub type Block = TriangleBlock<WIDTH>;

/// WideNodes of a tree, the root's first, and the blocks of its leaves.
#[derive(Debug)]
pub struct WideNodes {
    nodes: Vec<WideNode>,
    blocks: Vec<Block>,
    /// Leaves with too many blocks for a [`Child`] to say: where they begin and end.
    long: Vec<[u32; 2]>,
}

/// A subtree of three levels: one plane, two and four, in the order of a heap. A child is above the
/// plane of level l on its way if bit 2 - l of its number is set.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct WideNode {
    /// The planes' bits. In the place of an eighth: the axes, two bits a plane, and from bit 16 on
    /// a bit for each child that is not empty.
    pub planes: [u32; 8],
    /// The children.
    pub children: [Child; 8],
}

/// A node by its number; or, with the top bit, a leaf by its first block and, in the five bits
/// below, how many there are. If these are all set, the leaf by its place in the table of long
/// ones.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Child(u32);

/// What a [`Child`] leads to.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// Divides its cell.
    Node(&'a WideNode),
    /// Holds triangles.
    Leaf(&'a [Block]),
}

/// Planes of a node.
const PLANES: usize = 7;

impl WideNode {
    const EMPTY: Self = Self { planes: [0; 8], children: [Child::ROOT; 8] };

    /// A bit for each child that is not empty.
    #[inline(always)]
    pub fn occupied(&self) -> u32 {
        self.planes[PLANES] >> 16
    }

    fn put(&mut self, place: usize, child: Child) {
        self.children[place] = child;
        self.planes[PLANES] |= 1 << (16 + place);
    }
}

impl Child {
    /// The root's node.
    pub const ROOT: Self = Self(0);
    const IS_LEAF: u32 = 1 << 31;
    const PLACE_BITS: u32 = 26;
    const PLACE: u32 = (1 << Self::PLACE_BITS) - 1;
    const LONG: u32 = 31;

    fn leaf(place: u32, blocks: u32) -> Self {
        Self(Self::IS_LEAF | blocks << Self::PLACE_BITS | place)
    }
}

impl WideNodes {
    /// Lays a tree out.
    ///
    /// # Errors
    /// If there are more blocks than can be numbered.
    pub fn new(tree: &KdTree) -> Result<Self, BuildError> {
        const LIMIT: usize = Child::PLACE as usize;
        let leaves = &tree.base.leaves;
        let (firsts, parts) = places(leaves);
        if parts.len() > LIMIT {
            let bytes = |blocks: usize| (blocks * size_of::<Block>()) as u64;
            return Err(BuildError::TooLarge { needed: bytes(parts.len()), limit: bytes(LIMIT) });
        }
        let blocks = parts.par_iter().map(|&(leaf, part)| block(leaves, leaf, part)).collect();
        let mut nodes = Self { nodes: vec![WideNode::EMPTY], blocks, long: Vec::new() };
        let mut roots = vec![(NodeId(0), 0)];
        while let Some(root) = roots.pop() {
            nodes.fill(tree, &firsts, root, &mut roots);
        }
        Ok(nodes)
    }

    /// What a child leads to.
    #[inline(always)]
    pub fn follow(&self, Child(child): Child) -> Target<'_> {
        if child & Child::IS_LEAF == 0 {
            return Target::Node(&self.nodes[child as usize]);
        }
        let (place, count) = (child & Child::PLACE, child >> Child::PLACE_BITS & Child::LONG);
        let [begin, end] =
            if count == Child::LONG { self.long[place as usize] } else { [place, place + count] };
        Target::Leaf(&self.blocks[begin as usize..end as usize])
    }

    /// Bytes by part.
    pub fn memory(&self) -> [(&'static str, usize); 2] {
        let long = size_of_val(&*self.long);
        [("wide nodes", size_of_val(&*self.nodes)), ("blocks", size_of_val(&*self.blocks) + long)]
    }

    /// Fills a wide node with what lies below a node of the tree; adds wide nodes for what lies
    /// below those.
    fn fill(
        &mut self,
        tree: &KdTree,
        firsts: &[u32],
        (root, wide): (NodeId, usize),
        roots: &mut Vec<(NodeId, usize)>,
    ) {
        let mut places = vec![(Some(root), 0)];
        while let Some((node, place)) = places.pop() {
            let at = node.map(|node| (node, tree.nodes[node.index()]));
            if let Some(child) = usize::checked_sub(place, PLANES) {
                match at {
                    Some((_, Node::Leaf(leaf))) if !leaf.is_empty() => {
                        let leaf = self.add_leaf(firsts[leaf.index()], firsts[leaf.index() + 1]);
                        self.nodes[wide].put(child, leaf);
                    }
                    Some((node, Node::Inner { .. })) => {
                        let below = self.nodes.len();
                        roots.push((node, below));
                        self.nodes.push(WideNode::EMPTY);
                        self.nodes[wide].put(child, Child(below as u32));
                    }
                    _ => {}
                }
                continue;
            }
            let (axis, split, children) = match at {
                Some((node, Node::Inner { axis, split, above })) => {
                    (axis, split, [Some(NodeId(node.0 + 1)), Some(above)])
                }
                _ => (0, f32::INFINITY, [node, None]),
            };
            self.nodes[wide].planes[place] = split.to_bits();
            self.nodes[wide].planes[PLANES] |= u32::from(axis) << (2 * place);
            places.extend([(children[1], 2 * place + 2), (children[0], 2 * place + 1)]);
        }
    }

    fn add_leaf(&mut self, begin: u32, end: u32) -> Child {
        if end - begin < Child::LONG {
            return Child::leaf(begin, end - begin);
        }
        self.long.push([begin, end]);
        Child::leaf(self.long.len() as u32 - 1, Child::LONG)
    }
}

/// Where the blocks of each leaf begin, the end last; and of each block its leaf and which it is.
fn places(leaves: &Leaves) -> (Vec<u32>, Vec<(LeafId, usize)>) {
    let (mut firsts, mut ids) = (vec![0], Vec::new());
    for leaf in (0..leaves.count() as u32).map(LeafId) {
        let blocks = leaves.triangles(leaf).len().div_ceil(WIDTH);
        ids.extend((0..blocks).map(|part| (leaf, part)));
        firsts.push(ids.len() as u32);
    }
    (firsts, ids)
}

fn block(leaves: &Leaves, leaf: LeafId, part: usize) -> Block {
    let slots = leaves.triangles(leaf);
    let slots = &slots[part * WIDTH..slots.len().min((part + 1) * WIDTH)];
    Block::fetch(slots.len(), |lane| {
        let corners = leaves.corners(slots[lane]);
        let [a, b, c] = corners.map(|[x, y, z, _]| Vec3::new(x, y, z));
        (leaves.id(slots[lane]), Triangle { a, b, c })
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::accel::kd::build::OPTIONS;
    use crate::accel::{Options, Steps};
    use crate::geom::{TriangleList, TriangleSource};
    use crate::math::PrimId;

    fn nodes(count: usize, options: &str) -> (KdTree, WideNodes) {
        let corner = |i: usize| Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, i as f32);
        let triangle = |i| {
            let a = corner(i);
            Triangle { a, b: a + Vec3::X, c: a + Vec3::ONE }
        };
        let list = TriangleList((0..count).map(triangle).collect());
        let source: Arc<dyn TriangleSource> = Arc::new(list);
        let options = Options::parse("kd", &OPTIONS, options).expect("they are known");
        let tree = KdTree::build(&source, &options, &Steps::untold()).expect("it is small");
        let nodes = WideNodes::new(&tree).expect("it is small");
        (tree, nodes)
    }

    /// The triangles of all leaves below a child, in the order of the tree.
    fn ids(nodes: &WideNodes, child: Child, found: &mut Vec<PrimId>) {
        match nodes.follow(child) {
            Target::Node(node) => {
                for place in (0..8).filter(|place| node.occupied() >> place & 1 == 1) {
                    ids(nodes, node.children[place], found);
                }
            }
            Target::Leaf(blocks) => {
                let all = blocks.iter().flat_map(|block| block.ids);
                found.extend(all.filter(|&id| id != PrimId::NONE));
            }
        }
    }

    #[test]
    fn wide_nodes_hold_the_leaves_of_the_tree_in_order() {
        // The last has leaves of more blocks than a child can count.
        for (count, options) in
            [(0, ""), (1, ""), (7, "cost=9,leaf=1"), (900, ""), (900, "depth=1")]
        {
            let (tree, nodes) = nodes(count, options);
            let mut found = Vec::new();
            ids(&nodes, Child::ROOT, &mut found);
            let leaves = &tree.base.leaves;
            let slots = (0..leaves.count() as u32).flat_map(|leaf| leaves.triangles(LeafId(leaf)));
            let expected: Vec<_> = slots.map(|&slot| leaves.id(slot)).collect();
            assert_eq!(found, expected, "{count}, {options}");
            assert_eq!(nodes.long.is_empty(), options != "depth=1");
        }
    }

    #[test]
    fn a_wide_node_is_a_cache_line() {
        assert_eq!((size_of::<WideNode>(), align_of::<WideNode>()), (64, 64));
    }
}
