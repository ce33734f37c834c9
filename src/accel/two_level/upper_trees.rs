//! The trees above the meshes: of what stands still and, for each part of the time, of what moves.

use std::sync::Arc;

use rayon::prelude::*;

use super::body::Body;
use super::levels::Levels;
use super::moving_triangles::MovingTriangles;
use super::sources::Boxes;
use super::trees::{Trees, W};
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
    pub blocks: Vec<MovingBlock<W>>,
}

/// What the places of leaves lead to: first come those that lie in the trees.
#[derive(Clone, Copy)]
pub struct Places {
    /// From here on: leaves of trees of placements that move.
    pub moving: usize,
    /// From here on: parts of placements that stand still.
    pub part: usize,
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
    pub fn iter(&self) -> impl Iterator<Item = &Tree> {
        let triangles = self.triangles.iter().flatten().map(|(tree, _)| tree);
        std::iter::once(&self.standing).chain(self.whole.iter().flatten()).chain(triangles)
    }

    /// What places lead to, where there are so many parts of placements, and placements that move.
    pub fn places(&self, parts: usize, whole: usize) -> Places {
        let moving = self.standing.arena.stripes().count();
        let part = self.iter().map(|tree| tree.arena.stripes().count()).sum();
        let whole_from = part + parts;
        let block = whole_from + whole;
        Places { moving, part, whole: whole_from, block, end: block + self.blocks.len() }
    }

    /// Brings them together; in the tree of what stands still, primitives are boxes from
    /// `first_box` on. `None` if there are too many nodes to link to.
    ///
    /// Leaves of one box are passed by: it is that which leads there.
    ///
    /// # Errors
    /// If there is not enough memory.
    pub fn bring_together(
        self,
        places: &Places,
        first_box: usize,
    ) -> Result<Option<(Trees, Vec<MovingBlock<W>>)>, BuildError> {
        let Self { mut standing, mut whole, triangles, blocks } = self;
        // All links of a tree are moved by where it begins.
        let mut begin = standing.arena.stripes().count();
        pass_by(&mut standing, places.part, first_box);
        if !places.are_moving() {
            return Ok(Some((Trees::single(standing), blocks)));
        }
        for tree in whole.iter_mut().flatten() {
            pass_by(tree, places.whole - begin, 0);
            begin += tree.arena.stripes().count();
        }
        let mut of_triangles = Vec::with_capacity(triangles.len());
        for built in triangles {
            of_triangles.push(built.map(|(mut tree, first)| {
                let link = |leaf: usize| Some(Link::to_leaf(places.block + first + leaf - begin));
                let links: Vec<_> = (0..tree.leaves().len()).map(link).collect();
                tree.redirect(&links);
                begin += tree.arena.stripes().count();
                tree
            }));
        }
        let all = std::iter::once(Some(standing)).chain(whole).chain(of_triangles);
        Ok(Trees::new(all.collect())?.map(|trees| (trees, blocks)))
    }
}

/// Leads links to leaves of one box, from `first_box` on, to places from `first` on instead.
fn pass_by(tree: &mut Tree, first: usize, first_box: usize) {
    let link = |ids: &[PrimId; W]| {
        let number = ids[0].index().checked_sub(first_box)?;
        (ids[1] == PrimId::NONE).then(|| Link::to_leaf(first + number))
    };
    let links: Vec<_> = tree.leaves().map(link).collect();
    tree.redirect(&links);
}
