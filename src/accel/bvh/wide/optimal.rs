//! From a binary tree to the wide one of the least expected work.
//!
//! H. Ylitie, T. Karras and S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs", 2017, section 3.1. To open the largest child until a node is full, as
//! [`super::collapse`] does, is right near the root, but leaves nodes of two and three children
//! near the leaves. Here all ways to choose nodes are weighed, from the leaves up: of each binary
//! node, what its subtree costs as a forest of at most so many trees. A node costs its area, since
//! all cost as much to visit. Leaves are taken over as they are, so that they cost the same
//! whatever is chosen; in the paper they are chosen as well.

use super::collapse::Binary;
use super::shape::{Child, Shape, Source};
use crate::accel::bvh::BinaryTree;

/// Collapses a tree so that the areas of its nodes have the least sum.
pub fn collapse<const W: usize>(tree: BinaryTree) -> Shape<W, impl Source<W>> {
    let BinaryTree { nodes, order, parts } = tree;
    let binary = Binary { nodes };
    let choices = choose(&binary);
    Shape::new(Optimal { binary, choices }, order, parts)
}

/// How a subtree's forest of at most so many trees comes about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Choice {
    /// So many trees at most in the first child's part, or none where the subtree is one tree.
    first: u8,
    /// And so many in the second's.
    second: u8,
}

/// The choices for forests of at most one tree more than the index says; that of one tree is how
/// its root divides its children.
type Choices<const W: usize> = [Choice; W];

/// Costs of forests of at most one tree more than the index says.
type Costs<const W: usize> = [f64; W];

/// The choices of all binary nodes; those of leaves mean nothing.
fn choose<const W: usize>(binary: &Binary) -> Vec<Choices<W>> {
    let mut choices = vec![[Choice::default(); W]; binary.nodes.len()];
    // In reverse both children of a node come before it, the first one last.
    let mut waiting: Vec<Costs<W>> = Vec::new();
    for (node, choices) in binary.nodes.iter().zip(&mut choices).rev() {
        if node.is_leaf() {
            waiting.push([0.0; W]);
        } else if let (Some(first), Some(second)) = (waiting.pop(), waiting.pop()) {
            let costs = weigh(node.bounds.half_area(), &first, &second, choices);
            waiting.push(costs);
        }
    }
    choices
}

/// The costs and the choices of a node of such an area by its children's costs.
fn weigh<const W: usize>(
    area: f64,
    first: &Costs<W>,
    second: &Costs<W>,
    choices: &mut Choices<W>,
) -> Costs<W> {
    let cheapest = |trees: usize| {
        let way = |of_first: usize| {
            let cost = first[of_first - 1] + second[trees - of_first - 1];
            (cost, Choice { first: of_first as u8, second: (trees - of_first) as u8 })
        };
        // There is one also where areas are infinite or no numbers, so that none is the less.
        let mut best = way(1);
        for other in (2..trees).map(way) {
            if other.0 < best.0 {
                best = other;
            }
        }
        best
    };
    let (below, children) = cheapest(W);
    let mut costs = [area + below; W];
    choices[0] = children;
    let mut so_far = Choice::default();
    for trees in 2..=W {
        costs[trees - 1] = costs[trees - 2];
        let (cost, choice) = if trees == W { (below, children) } else { cheapest(trees) };
        if cost < costs[trees - 1] {
            (costs[trees - 1], so_far) = (cost, choice);
        }
        choices[trees - 1] = so_far;
    }
    costs
}

/// The nodes of a binary tree of which some are chosen.
struct Optimal<const W: usize> {
    binary: Binary,
    choices: Vec<Choices<W>>,
}

impl<const W: usize> Optimal<W> {
    /// Puts the roots of a forest of at most so many trees, as it was chosen, into `roots`.
    fn gather(&self, node: u32, trees: u8, roots: (&mut usize, &mut [u32; W])) {
        let (count, lanes) = roots;
        let choice = self.choices[node as usize][usize::from(trees) - 1];
        if trees == 1 || choice == Choice::default() || self.binary.is_leaf(node) {
            lanes[*count] = node;
            *count += 1;
            return;
        }
        let [first, second] = self.binary.pair(node);
        self.gather(first, choice.first, (count, lanes));
        self.gather(second, choice.second, (count, lanes));
    }
}

impl<const W: usize> Source<W> for Optimal<W> {
    fn root(&self) -> Option<u32> {
        Source::<W>::root(&self.binary)
    }

    fn child(&self, number: u32) -> Child {
        Source::<W>::child(&self.binary, number)
    }

    fn children(&self, node: u32) -> (usize, [u32; W]) {
        let (mut count, mut lanes) = (0, [0; W]);
        let choice = self.choices[node as usize][0];
        let [first, second] = self.binary.pair(node);
        self.gather(first, choice.first, (&mut count, &mut lanes));
        self.gather(second, choice.second, (&mut count, &mut lanes));
        (count, lanes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::BinaryNode;
    use crate::math::{Aabb, Vec3};

    /// A node or leaf in a box of such an area.
    fn node(area: f32, first: u32, count: u32) -> BinaryNode {
        // A box of height 1 and no depth has its width as half its area.
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(area, 1.0, 0.0) };
        BinaryNode { bounds, first, count }
    }

    /// The areas of all wide nodes, the least that any choice may reach, by trying all.
    fn least<const W: usize>(nodes: &[BinaryNode], at: u32, trees: usize) -> f64 {
        let node = &nodes[at as usize];
        if node.is_leaf() {
            return 0.0;
        }
        let split = |trees: usize| {
            let cost = |of_first: usize| {
                least::<W>(nodes, at + 1, of_first)
                    + least::<W>(nodes, node.first, trees - of_first)
            };
            (1..trees).map(cost).fold(f64::INFINITY, f64::min)
        };
        let whole = node.bounds.half_area() + split(W);
        (2..=trees).map(split).fold(whole, f64::min)
    }

    #[test]
    fn no_other_choice_has_a_smaller_area() {
        for seed in 0..20 {
            let nodes = tree_of(13, 1000.0, seed);
            let (area, leaves) = area_of(&nodes);
            assert_eq!(leaves, 13);
            let least = least::<4>(&nodes, 0, 1);
            assert!((area - least).abs() < 1e-6 * least, "{area} and {least}");
        }
    }

    #[test]
    fn areas_without_bounds_leave_no_node_without_children() {
        for area in [f32::INFINITY, f32::NAN, 3e38, 0.0] {
            assert_eq!(area_of(&tree_of(40, area, 1)).1, 40);
        }
    }

    /// A tree of so many leaves, each inner node's children by a fixed draw.
    fn tree_of(leaves: u32, area: f32, seed: u32) -> Vec<BinaryNode> {
        fn grow(nodes: &mut Vec<BinaryNode>, leaves: u32, area: f32, seed: u32) {
            let seed = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            if leaves == 1 {
                let first = nodes.len() as u32;
                return nodes.push(node(area, first, 1));
            }
            let at = nodes.len();
            nodes.push(node(area, 0, 0));
            let left = 1 + (seed >> 20) % (leaves - 1);
            let share = 0.3 + 0.5 * ((seed >> 8) % 100) as f32 * 0.01;
            grow(nodes, left, area * share, seed);
            nodes[at].first = nodes.len() as u32;
            grow(nodes, leaves - left, area * (1.1 - share), seed ^ 0x5bd1_e995);
        }
        let mut nodes = Vec::new();
        grow(&mut nodes, leaves, area, seed);
        nodes
    }

    /// The areas of all nodes of the tree that is chosen, in sum, and how many leaves it has.
    fn area_of(nodes: &[BinaryNode]) -> (f64, u32) {
        let binary = || Binary { nodes: nodes.to_vec() };
        let optimal = Optimal::<4> { choices: choose(&binary()), binary: binary() };
        let (mut open, mut area, mut leaves) = (vec![0], 0.0, 0);
        while let Some(number) = open.pop() {
            if nodes[number as usize].is_leaf() {
                leaves += 1;
                continue;
            }
            area += nodes[number as usize].bounds.half_area();
            let (count, children) = optimal.children(number);
            assert!((2..=4).contains(&count));
            open.extend(&children[..count]);
        }
        (area, leaves)
    }
}
