//! The trees above the meshes: of what stands still and, for each part of the time, of what moves.

use std::sync::Arc;

use rayon::prelude::*;

use super::body::Body;
use super::levels::Levels;
use super::moving_triangles::MovingTriangles;
use super::sources::Boxes;
use super::trees::W;
use crate::accel::BuildError;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::wide_bvh::WideBvh;
use crate::geom::{MovingBlock, MovingTriangle, TriangleSource};
use crate::math::{Aabb, PrimId};

type Tree = WideBvh<W>;

/// All trees above the meshes, before they are brought together.
pub struct UpperTrees {
    standing: Tree,
    /// Of placements that move, then of bodies, by parts of the time.
    whole: Vec<Option<Tree>>,
    /// Of the triangles of others, likewise, without their leaves; each with the number of its
    /// first block.
    triangles: Vec<Option<(Tree, usize)>>,
    /// The leaves of those.
    blocks: Vec<MovingBlock<W>>,
}

/// What places of links lead to: first come those that lie in trees, of what stands still, of
/// meshes and bodies, and of what moves.
#[derive(Clone, Copy)]
pub struct Places {
    /// From here on: trees of meshes and bodies.
    pub below: usize,
    /// From here on: upper trees of what moves.
    pub moving: usize,
    /// From here on: parts of placements that stand still.
    pub part: usize,
    /// How many places each of those takes: its stripes, or one if they are not kept.
    part_size: usize,
    /// From here on: placements that move, and then bodies.
    pub whole: usize,
    /// From here on: blocks of triangles that move.
    pub block: usize,
    /// Behind all.
    pub end: usize,
}

impl Places {
    /// Whether anything moves.
    #[inline(always)]
    pub fn are_moving(&self) -> bool {
        self.whole < self.end
    }

    /// Whether parts of placements lie at their places.
    #[inline(always)]
    pub fn keep_parts(&self) -> bool {
        self.part_size > 1
    }
}

impl UpperTrees {
    /// Builds those of what moves; `tree` builds one.
    ///
    /// # Errors
    /// If there is not enough memory, or for limits of a tree.
    pub fn build(
        standing: Tree,
        (levels, moving, bodies): (&Levels, &MovingTriangles, &[Body]),
        tree: &(impl Fn(Arc<dyn TriangleSource>) -> Result<Tree, BuildError> + Sync),
    ) -> Result<Self, BuildError> {
        let (mut triangles, mut blocks) = (Vec::new(), Vec::new());
        if levels.still == levels.placements.len() {
            return Ok(Self { standing, whole: Vec::new(), triangles, blocks });
        }
        let build = |boxes| tree(Arc::new(Boxes(boxes)));
        let whole = |part| {
            let rest = moving.rest().iter();
            let rest = rest.map(|&rest| levels.box_of_moving(rest as usize, part));
            let bodies = bodies.iter().map(|body| body.bounds(levels, part));
            let boxes: Vec<Aabb> = rest.chain(bodies).collect();
            (!boxes.is_empty()).then(|| build(boxes)).transpose()
        };
        let parts = || (0..levels.timed_boxes.parts()).into_par_iter();
        let whole = parts().map(whole).collect::<Result<_, BuildError>>()?;
        let of_triangles = |part| {
            let over = moving.over(levels, part);
            let tree = (!over.is_empty())
                .then(|| build(over.iter().map(MovingTriangle::bounds).collect()));
            let Some(mut tree) = tree.transpose()? else { return Ok(None) };
            let block = |ids: &[PrimId; W]| {
                let ids = ids.iter().filter(|&&id| id != PrimId::NONE);
                MovingBlock::new(
                    &ids.map(|&id| (moving.locate(id), over[id.index()])).collect::<Vec<_>>(),
                )
            };
            let blocks: Vec<_> = tree.leaves().map(block).collect();
            tree.drop_leaves()?;
            Ok(Some((tree, blocks)))
        };
        let built: Vec<_> = parts().map(of_triangles).collect::<Result<_, BuildError>>()?;
        for built in built {
            triangles.push(built.map(|(tree, own)| {
                let first = blocks.len();
                blocks.extend(own);
                (tree, first)
            }));
        }
        Ok(Self { standing, whole, triangles, blocks })
    }

    /// All trees, in the order in which they are brought together.
    pub fn iter(&self) -> impl Iterator<Item = &Tree> + Clone {
        let triangles = self.triangles.iter().flatten().map(|(tree, _)| tree);
        std::iter::once(&self.standing).chain(self.whole.iter().flatten()).chain(triangles)
    }

    /// What places lead to, with `below` stripes of meshes and bodies, so many parts of placements,
    /// of so many stripes each if they are kept, and so much that moves as a whole.
    pub fn places(&self, below: usize, (parts, part_size): (usize, usize), whole: usize) -> Places {
        let stripes: usize = self.iter().map(WideBvh::count_stripes).sum();
        let standing = self.standing.count_stripes();
        let part = stripes + below;
        let whole_from = part + parts * part_size;
        let block = whole_from + whole;
        let (moving, end) = (standing + below, block + self.blocks.len());
        Places { below: standing, moving, part, part_size, whole: whole_from, block, end }
    }

    /// That of what stands still, the others in order, and the blocks, all linked to places; in the
    /// first, primitives are boxes from `first_box` on.
    pub fn link(
        self,
        places: &Places,
        first_box: usize,
    ) -> (Tree, Vec<Option<Tree>>, Vec<MovingBlock<W>>) {
        let Self { mut standing, mut whole, triangles, blocks } = self;
        link_boxes(&mut standing, 0, first_box, |number| places.part + number * places.part_size);
        // All links of a tree are moved by where it begins.
        let mut begin = places.moving;
        for tree in whole.iter_mut().flatten() {
            link_boxes(tree, begin, 0, |number| places.whole + number);
            begin += tree.count_stripes();
        }
        let mut of_triangles = Vec::with_capacity(triangles.len());
        for built in triangles {
            of_triangles.push(built.map(|(mut tree, first)| {
                let link = |leaf: usize| Some(Link::to_leaf(places.block + first + leaf - begin));
                let links: Vec<_> = (0..tree.leaves().len()).map(link).collect();
                tree.redirect(&links);
                begin += tree.count_stripes();
                tree
            }));
        }
        (standing, whole.into_iter().chain(of_triangles).collect(), blocks)
    }
}

/// Makes the ids of boxes, from `first_box` on, links to leaves at their places; those of triangles
/// are below, and [`PrimId::NONE`] is none, since there are fewer places than [`Link::LIMIT`]. A
/// leaf of one box is passed by: it is that place which a node leads to.
fn link_boxes(
    tree: &mut Tree,
    begin: usize,
    first_box: usize,
    place: impl Fn(usize) -> usize + Copy,
) {
    let number = |id: PrimId| id.index().checked_sub(first_box).filter(|_| id != PrimId::NONE);
    let only = |ids: &[PrimId; W]| number(ids[0]).filter(|_| ids[1] == PrimId::NONE);
    let link = |ids| only(ids).map(|number| Link::to_leaf(place(number) - begin));
    let links: Vec<_> = tree.leaves().map(link).collect();
    tree.redirect(&links);
    tree.relabel(|id| number(id).map_or(id, |number| PrimId(Link::to_leaf(place(number)).0)));
}
