//! Wide hierarchies on both levels, built.

use std::borrow::Cow;
use std::sync::Arc;

use super::body::Body;
use super::levels::Levels;
use super::moved::Moved;
use super::moving_blocks::MovingBlocks;
use super::moving_triangles::MovingTriangles;
use super::parts::{Part, find_parts};
use super::sources::{Boxes, FlatTriangles, Together};
use super::trees::{Trees, W, count_stripes};
use super::upper_trees::{Places, UpperTrees};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::stack::{DEEPEST, Stack};
use crate::accel::bvh::wide::wide_bvh::{RAYS, WideBvh};
use crate::accel::{BuildError, BuildReport, Built, MemoryReport, Phases, Structure};
use crate::geom::TriangleSource;
use crate::math::Ray;

/// A hierarchy of placements and of what is flattened, and one of each mesh. Of what moves there is
/// one for each part of the time.
pub struct WideLevels {
    /// How the scene is divided.
    pub levels: Arc<Levels>,
    /// What is flattened and in the upper tree; nothing where anything moves.
    pub flat: FlatTriangles,
    /// What moves and is in the upper trees by its triangles.
    pub moving: MovingBlocks,
    /// What moves as stiff bodies.
    pub bodies: Vec<Body>,
    /// All trees: the upper one of what stands still; those of meshes, then of bodies; the upper
    /// ones of placements that move, and of triangles that do, by parts of the time. Behind them
    /// lie the parts of placements, if they are kept.
    pub trees: Trees,
    /// What links lead to.
    pub places: Places,
    built: Built,
}

/// A link that no walk follows, since its key is zero; a leaf, so that it is no node either.
pub const BACK: Link = Link(Link::LEAF);

impl WideLevels {
    /// Puts placements and `flat` triangles into a tree, and what moves into others, over the trees
    /// of meshes and then of bodies; `tree` builds one with some room. `None` if they can't be
    /// walked together.
    ///
    /// # Errors
    /// If there is not enough memory, or for limits of a tree.
    pub fn build(
        levels: &Arc<Levels>,
        (flat, moving, bodies): (FlatTriangles, MovingTriangles, Vec<Body>),
        below: Vec<Option<WideBvh<W>>>,
        tree: impl Fn(Arc<dyn TriangleSource>, usize) -> Result<WideBvh<W>, BuildError> + Sync,
        phases: &mut Phases,
    ) -> Result<Option<Self>, BuildError> {
        let below_stripes = count_stripes(&below);
        let stored = below.iter().flatten().all(WideBvh::stores_triangles);
        if !stored || below_stripes >= Link::LIMIT {
            return Ok(None);
        }
        phases.end("meshes");
        let (parts, boxes): (Vec<Part>, Box<dyn TriangleSource>) = match find_parts(levels, &below)
        {
            Some(parts) => {
                let (parts, boxes) = parts.into_iter().unzip();
                (parts, Box::new(Boxes(boxes)))
            }
            None => (Vec::new(), Box::new(levels.boxes_of_still())),
        };
        phases.end("parts of placements");
        let (first_box, still_parts) = (flat.len(), boxes.len());
        let part_size = if parts.is_empty() { 1 } else { Part::STRIPES };
        let together = Together { flat: flat.clone(), boxes };
        BuildError::check_count(together.len())?;
        let part_stripes = parts.len() * part_size;
        // Where anything moves there will be other trees between them.
        let room = if levels.are_moving() { 0 } else { below_stripes + part_stripes };
        let standing = tree(Arc::new(together), room)?;
        if !standing.stores_triangles() {
            return Ok(None);
        }
        let (level, tree) = (standing.level(), |source| tree(source, 0));
        let above = UpperTrees::build(standing, (levels, &moving, &bodies), &tree)?;
        phases.end("tree of placements");
        // A level of its own each: the leaf of placements, the way back, and two more roots.
        let deepest = |depth: usize, tree: &WideBvh<W>| depth.max(tree.report().max_depth);
        let depth = above.iter().fold(0, deepest) + below.iter().flatten().fold(0, deepest) + 4;
        let whole = moving.rest().len() + bodies.len();
        let places = above.places(below_stripes, (still_parts, part_size), whole);
        if depth > DEEPEST || places.end >= Link::LIMIT {
            return Ok(None);
        }
        let mut report = sum_up(above.iter().chain(below.iter().flatten()));
        let (standing, above, blocks) = above.link(&places, first_box);
        let others = below.into_iter().chain(above).collect();
        let mut trees = Trees::new(standing, others, part_stripes)?;
        for (stripes, part) in trees.room_mut().chunks_exact_mut(Part::STRIPES).zip(&parts) {
            stripes.copy_from_slice(&part.to_stripes(places.below));
        }
        phases.end("trees together");
        (report.phases, report.triangles) = (phases.clone().ended(), levels.placed.len());
        let levels = Arc::clone(levels);
        let moving = MovingBlocks { levels: Arc::clone(&levels), triangles: moving, blocks };
        let built = Built { level, report };
        Ok(Some(Self { levels, flat, moving, bodies, trees, places, built }))
    }

    /// A part of a placement that stands still, by its place.
    #[inline(always)]
    pub fn part<'a>(&self, stripes: Stripes<'a, W>, place: usize) -> Option<Cow<'a, Part>> {
        if self.places.keep_parts() {
            return Some(Cow::Borrowed(stripes.read(place)));
        }
        let number = place - self.places.part;
        Part::whole(&self.levels, number, |structure| self.root_of_mesh(structure)).map(Cow::Owned)
    }

    /// What moves as a whole, by its number in the upper trees.
    #[inline(always)]
    pub fn mover(&self, number: usize) -> Mover {
        let rest = self.moving.triangles.rest();
        match rest.get(number) {
            Some(&placement) => Mover::Placement(placement as usize),
            None => Mover::Body(number - rest.len()),
        }
    }

    /// The root of a body's tree.
    #[inline(always)]
    pub fn root_of_body(&self, body: usize) -> Option<Link> {
        self.trees.root(1 + self.levels.spans.len() + body)
    }

    /// The root of a mesh's tree, by the number of the structure.
    #[inline(always)]
    pub fn root_of_mesh(&self, structure: usize) -> Option<Link> {
        self.trees.root(1 + structure)
    }

    /// The root of the upper tree of what stands still.
    #[inline(always)]
    pub fn root_of_standing(&self) -> Option<Link> {
        self.trees.root(0)
    }

    /// The roots of the upper trees of what moves, at a time.
    #[inline(always)]
    pub fn roots_of_moving(&self, time: f32) -> [Option<Link>; 2] {
        let timed = &self.levels.timed_boxes;
        let (part, parts) = (timed.part(time), timed.parts());
        let first = 1 + self.levels.spans.len() + self.bodies.len() + part;
        [self.trees.root(first), self.trees.root(first + parts)]
    }

    /// Prefetches what a link leads to if that moves; whether it does.
    #[inline(always)]
    pub fn prefetch_moving(&self, link: Link, time: f32) -> bool {
        let place = link.place();
        if !link.is_leaf() || place < self.places.whole {
            return false;
        }
        match place.checked_sub(self.places.block) {
            Some(block) => self.moving.prefetch(block),
            None => match self.mover(place - self.places.whole) {
                Mover::Placement(number) => {
                    let part = self.levels.timed_boxes.part(time);
                    self.levels.timed_ways.prefetch(number, part);
                }
                Mover::Body(number) => self.bodies[number].prefetch(time),
            },
        }
        true
    }
}

/// How trees were built, in all.
fn sum_up<'a>(trees: impl Iterator<Item = &'a WideBvh<W>> + Clone) -> BuildReport {
    let first = trees.clone().find(|tree| tree.root.is_some());
    let first = first.map(|tree| tree.report().clone()).unwrap_or_default();
    let nodes = trees.clone().map(|tree| tree.report().nodes).sum();
    let leaves = trees.map(|tree| tree.report().leaves).sum();
    BuildReport { nodes, leaves, ..first }
}

/// What moves as a whole.
#[derive(Clone, Copy)]
pub enum Mover {
    /// A placement, by its number among those that move.
    Placement(usize),
    /// A body.
    Body(usize),
}

/// What a tracer has for each ray in flight.
pub struct Scratch {
    /// What waits for it.
    pub stacks: Box<[Stack<W>]>,
    /// What it is in the space of the mesh that it has entered last.
    pub locals: Box<[Ray]>,
    /// That placement, if it moves.
    pub moved: Box<[Moved]>,
}

impl Structure for WideLevels {
    type Scratch = Scratch;

    fn scratch(&self) -> Scratch {
        let with_bottom = |_| {
            let mut stack = Stack::new();
            stack.put(0, BACK, &mut 0);
            stack
        };
        let stacks = (0..RAYS).map(with_bottom).collect();
        let locals = [Ray::MISS; RAYS].into();
        Scratch { stacks, locals, moved: [Moved::default(); RAYS].into() }
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let Places { below, moving, part, whole, .. } = self.places;
        let bytes = |stripes: usize| stripes * size_of::<[f32; W]>();
        let parts = if self.places.keep_parts() { bytes(whole - part) } else { 0 };
        let bodies = self.bodies.iter().map(Body::bytes).sum::<usize>();
        let list = self.levels.bytes() + self.moving.triangles.bytes() + bodies + parts;
        MemoryReport::new([
            ("placements and flat meshes", bytes(below + part - moving)),
            ("triangles that move", size_of_val(&*self.moving.blocks)),
            ("meshes", bytes(moving - below)),
            ("list of placements", list),
        ])
    }
}
