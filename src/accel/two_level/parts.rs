//! Placements opened: parts of them in place of the whole, where that is large.
//!
//! Boxes of placements overlap, and most of a large one is empty: a ray enters many for nothing.
//! So the upper tree has subtrees of the meshes' trees in it, each with the box in the world of its
//! own triangles (Benthin et al., "Improved Two-Level BVHs using Partial Re-Braiding", 2017; there
//! they are opened while the tree is built, here before).

use glam::DVec3;
use rayon::prelude::*;

use super::levels::{Levels, Way};
use super::placement::ToMesh;
use super::trees::W;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::wide_bvh::WideBvh;
use crate::geom::own_box;
use crate::math::{Aabb, InstanceId, PrimId, TriangleId, Vec3};

/// More placements are left whole.
const MOST_OPENED: usize = 1 << 14;

/// The parts of more placements are not kept: each is found when it is needed.
const MOST_KEPT: usize = 1 << 18;

/// What is larger than the mean placement by this is opened. Smaller parts are entered more often
/// than their boxes spare.
const LARGE: f64 = 1.0;

/// What holds all.
const EVERYWHERE: Aabb =
    Aabb { min: Vec3::splat(f32::NEG_INFINITY), max: Vec3::splat(f32::INFINITY) };

/// Nodes are opened down to this depth.
const DEPTH: u32 = 2;

/// A subtree of a placement.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Part {
    /// Into the mesh's space.
    pub to_mesh: ToMesh,
    /// What holds it in the mesh's space, with room for a ray to begin in.
    pub grown: [DVec3; 2],
    /// The placement.
    pub placement: InstanceId,
    /// The root of the subtree.
    pub root: Link,
    /// By how much the boxes of its mesh are grown.
    pub slack: f32,
    unused: u32,
}

impl Part {
    /// The stripes that it takes in an arena.
    pub const STRIPES: usize = size_of::<Self>() / size_of::<[f32; W]>();

    /// All of a placement that stands still, by its number; `root` is that of a structure.
    #[inline]
    pub fn whole(
        levels: &Levels,
        number: usize,
        root: impl FnOnce(usize) -> Option<Link>,
    ) -> Option<Self> {
        let Way { placement, mesh, to_mesh } = levels.way(number);
        let root = root(levels.structure_of(number))?;
        let apart = levels.meshes[mesh.index()].as_ref()?;
        let (grown, slack) = (apart.grown, apart.slack);
        Some(Self { to_mesh, grown, placement, root, slack, unused: 0 })
    }

    /// What it is as stripes of an arena, where structures begin at place `first`.
    pub fn to_stripes(self, first: usize) -> [[f32; W]; Self::STRIPES] {
        bytemuck::cast(Self { root: self.root.moved(first as u32), ..self })
    }
}

/// The parts of all placements that are kept apart and stand still, each with its box in the world;
/// whole ones if it would take too long to look at all triangles, `None` if they are too many.
/// `trees` are the meshes' structures, one behind the other.
pub fn find_parts(levels: &Levels, trees: &[Option<WideBvh<W>>]) -> Option<Vec<(Part, Aabb)>> {
    let count = levels.still;
    if count > MOST_KEPT {
        return None;
    }
    let boxes = levels.boxes_of_still();
    let world_box = |number| boxes.world_box(PrimId::from_index(number));
    let boxes: Vec<Aabb> = (0..count).into_par_iter().map(world_box).collect();
    let firsts = find_firsts(trees);
    let whole = |number| {
        let root =
            |structure: usize| Some(trees[structure].as_ref()?.root?.moved(firsts[structure]));
        Part::whole(levels, number, root)
    };
    if count > MOST_OPENED || !levels.are_few_triangles() {
        let boxes = boxes.into_par_iter().enumerate();
        return Some(boxes.filter_map(|(number, held)| Some((whole(number)?, held))).collect());
    }
    let large = boxes.iter().map(|held| held.half_area()).sum::<f64>() / count as f64 * LARGE;
    let open_one = |number| {
        let structure = levels.structure_of(number);
        let (mut parts, tree) = (Vec::new(), trees[structure].as_ref());
        let (Some(whole), Some(tree)) = (whole(number), tree) else { return parts };
        let Some(root) = tree.root else { return parts };
        let Part { placement, slack, .. } = whole;
        let placement = Placement { levels, stripes: tree.arena.stripes(), placement, slack };
        let all = placement.look((root, whole.grown), &EVERYWHERE, DEPTH);
        all.cut(large, &mut |node: &Node| {
            let root = node.link.moved(firsts[structure]);
            parts.push((Part { root, grown: node.inside, ..whole }, node.bounds));
        });
        parts
    };
    Some((0..count).into_par_iter().flat_map_iter(open_one).collect())
}

/// Where trees begin that lie one behind the other.
fn find_firsts(trees: &[Option<WideBvh<W>>]) -> Vec<u32> {
    let mut end = 0;
    let first = |tree: &Option<WideBvh<W>>| {
        let first = end;
        end += tree.as_ref().map_or(0, |tree| tree.count_stripes() as u32);
        first
    };
    trees.iter().map(first).collect()
}

/// A node of a placement's tree, with what is below it as far as it was looked at.
struct Node {
    link: Link,
    /// In the mesh's space, as [`Part::grown`].
    inside: [DVec3; 2],
    /// Of its triangles in the world.
    bounds: Aabb,
    below: Vec<Self>,
}

impl Node {
    /// Hands out this node, or in its place what is below it if it is large.
    fn cut(&self, large: f64, hand_out: &mut impl FnMut(&Self)) {
        if self.below.is_empty() || self.bounds.half_area() <= large {
            return hand_out(self);
        }
        for node in &self.below {
            node.cut(large, hand_out);
        }
    }
}

/// A placement whose triangles are looked at.
struct Placement<'a> {
    levels: &'a Levels,
    stripes: Stripes<'a, W>,
    placement: InstanceId,
    /// By how much the boxes of its mesh are grown.
    slack: f32,
}

impl Placement<'_> {
    /// Looks at a node in a box and what is below it, down to a depth.
    fn look(&self, (link, inside): (Link, [DVec3; 2]), held: &Aabb, depth: u32) -> Node {
        if link.is_leaf() || depth == 0 {
            return Node { link, inside, bounds: self.find_bounds(link, held), below: Vec::new() };
        }
        let below: Vec<Node> = self
            .children(link)
            .map(|(link, held)| self.look((link, self.grow(&held)), &held, depth - 1))
            .collect();
        let bounds = below.iter().map(|node| node.bounds).fold(Aabb::EMPTY, Aabb::union);
        Node { link, inside, bounds, below }
    }

    /// A box as it is in the tree, grown by the slack once more.
    fn grow(&self, bounds: &Aabb) -> [DVec3; 2] {
        let slack = f64::from(self.slack);
        [bounds.min.as_dvec3() - slack, bounds.max.as_dvec3() + slack]
    }

    /// The box in the world of all triangles below a node in a box.
    fn find_bounds(&self, link: Link, held: &Aabb) -> Aabb {
        if !link.is_leaf() {
            let below = self.children(link).map(|(link, held)| self.find_bounds(link, &held));
            return below.fold(Aabb::EMPTY, Aabb::union);
        }
        // A block may hold triangles of other leaves, which the leaf's box does not.
        let block = self.stripes.block(link);
        let is_below = |lane: &usize| {
            let own = own_box(&block.triangle(*lane));
            let grown = Aabb { min: own.min - self.slack, max: own.max + self.slack };
            held.contains(grown)
        };
        let in_world = |lane: usize| {
            let triangle = TriangleId { instance: self.placement, index: block.ids[lane].0 };
            own_box(&self.levels.placed.get().placed_triangle(triangle))
        };
        let lanes = (0..block.len()).filter(is_below);
        lanes.map(in_world).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The children of a node with their boxes in the mesh's space.
    fn children(&self, link: Link) -> impl Iterator<Item = (Link, Aabb)> {
        let (planes, links) = self.stripes.node(link);
        (0..links.len()).filter_map(|lane| {
            let side =
                |side: usize| Vec3::from_array([0, 1, 2].map(|axis| planes[2 * axis + side][lane]));
            let bounds = Aabb { min: side(0), max: side(1) };
            (!bounds.is_empty()).then_some((Link(links[lane]), bounds))
        })
    }
}
