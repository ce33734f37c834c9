//! Wide hierarchies on both levels, built.

use std::borrow::Cow;
use std::sync::Arc;

use super::body::Body;
use super::levels::Levels;
use super::moved::Moved;
use super::moving_blocks::MovingBlocks;
use super::moving_triangles::MovingTriangles;
use super::parts::{Part, open};
use super::sources::{Boxes, FlatTriangles, Together};
use super::trees::{Trees, W};
use super::upper_trees::{Places, UpperTrees};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::stack::{DEEPEST, Stack};
use crate::accel::bvh::wide::wide_bvh::{RAYS, WideBvh};
use crate::accel::{BuildError, Built, MemoryReport, Phases, Structure};
use crate::geom::{SlabRay, TriangleSource};
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
    /// The upper trees: of what stands still, then of placements that move, and of triangles that
    /// do, by parts of the time.
    pub above: Trees,
    /// Those of meshes, then those of bodies.
    pub below: Trees,
    /// What leaves of the upper trees are.
    pub places: Places,
    /// What the upper tree has of placements; none if it has them whole.
    parts: Vec<Part>,
    built: Built,
}

/// A link that no walk follows, since its key is zero; a leaf, so that it is no node either.
pub const BACK: Link = Link(1 << 31);

impl WideLevels {
    /// Puts placements and `flat` triangles into a tree, and what moves into others, over the trees
    /// of meshes and then of bodies; `tree` builds one. `None` if they can't be walked together.
    ///
    /// # Errors
    /// If there is not enough memory, or for limits of a tree.
    pub fn build(
        levels: &Arc<Levels>,
        (flat, moving, bodies): (FlatTriangles, MovingTriangles, Vec<Body>),
        below: Vec<Option<WideBvh<W>>>,
        tree: impl Fn(Arc<dyn TriangleSource>) -> Result<WideBvh<W>, BuildError> + Sync,
        phases: &mut Phases,
    ) -> Result<Option<Self>, BuildError> {
        let of_meshes = || below.iter().flatten();
        let deepest = of_meshes().map(|tree| tree.report().max_depth).max().unwrap_or(0);
        let nodes: usize = of_meshes().map(|tree| tree.report().nodes).sum();
        let leaves: usize = of_meshes().map(|tree| tree.report().leaves).sum();
        if !of_meshes().all(WideBvh::stores_triangles) {
            return Ok(None);
        }
        let Some(below) = Trees::new(below)? else { return Ok(None) };
        phases.end("meshes");
        let (parts, boxes) = match open(levels, &below) {
            Some(parts) => {
                let (parts, boxes) = parts.into_iter().unzip();
                (parts, Box::new(Boxes(boxes)) as Box<dyn TriangleSource>)
            }
            None => (Vec::new(), Box::new(levels.boxes_of_still()) as Box<dyn TriangleSource>),
        };
        phases.end("parts of placements");
        let (first_box, still_parts) = (flat.len(), boxes.len());
        let together = Together { flat: flat.clone(), boxes };
        BuildError::check_count(together.len())?;
        let standing = tree(Arc::new(together))?;
        if !standing.stores_triangles() {
            return Ok(None);
        }
        let level = standing.level();
        let trees = UpperTrees::build(standing, (levels, &moving, &bodies), &tree)?;
        phases.end("tree of placements");
        // A level of its own each: the leaf of placements, the way back, and two more roots.
        let depth = trees.iter().map(|tree| tree.report().max_depth).max().unwrap_or(0);
        let places = trees.places(still_parts, moving.rest().len() + bodies.len());
        if depth + deepest + 4 > DEEPEST || places.end >= Link::LIMIT {
            return Ok(None);
        }
        let first = trees.iter().find(|tree| tree.root.is_some());
        let mut report = first.map(|tree| tree.report().clone()).unwrap_or_default();
        (report.phases, report.triangles) = (phases.clone().ended(), levels.placed.len());
        report.nodes = trees.iter().map(|tree| tree.report().nodes).sum::<usize>() + nodes;
        report.leaves = trees.iter().map(|tree| tree.report().leaves).sum::<usize>() + leaves;
        let built = Built { level, report };
        let Some((above, blocks)) = trees.bring_together(&places, first_box)? else {
            return Ok(None);
        };
        let levels = Arc::clone(levels);
        let moving = MovingBlocks { levels: Arc::clone(&levels), triangles: moving, blocks };
        Ok(Some(Self { levels, flat, moving, bodies, above, below, places, parts, built }))
    }

    /// A part of a placement that stands still, by its number.
    #[inline(always)]
    pub fn part(&self, number: usize) -> Option<Cow<'_, Part>> {
        if let Some(part) = self.parts.get(number) {
            return Some(Cow::Borrowed(part));
        }
        let way = self.levels.way(number);
        let root = self.below.root(self.levels.spans.of_mesh(way.mesh).start)?;
        let apart = self.levels.meshes[way.mesh.index()].as_ref()?;
        Some(Cow::Owned(Part { way, root, grown: apart.grown, slack: apart.slack }))
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
        self.below.root(self.levels.spans.len() + body)
    }

    /// The roots of the upper trees of what moves, at a time.
    #[inline(always)]
    pub fn roots_of_moving(&self, time: f32) -> [Option<Link>; 2] {
        let timed = &self.levels.timed_boxes;
        let (part, parts) = (timed.part(time), timed.parts());
        [self.above.root(1 + part), self.above.root(1 + parts + part)]
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

    /// Prefetches what a link leads to: a node or a leaf among `stripes`, or a part of a placement.
    #[inline(always)]
    pub fn prefetch(&self, stripes: Stripes<'_, W>, link: Link) {
        let place = link.place();
        let number = place.wrapping_sub(self.places.part);
        if self.parts.is_empty() {
            // Both: one of them is there already.
            self.levels.prefetch_way(number.min(place));
            stripes.prefetch(link);
        } else {
            stripes.prefetch_or((&self.parts, number), place < self.places.part, link);
        }
    }
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
    /// What it is in the placement that it has entered last.
    pub locals: Box<[Local]>,
    /// That placement, if it moves.
    pub moved: Box<[Moved]>,
}

/// A ray in the space of a mesh, and for boxes there.
#[derive(Clone, Copy)]
pub struct Local {
    /// The ray.
    pub ray: Ray,
    /// For boxes.
    pub slab: SlabRay,
}

impl Local {
    /// A ray in the space of a mesh.
    #[inline(always)]
    pub fn new(ray: Ray) -> Self {
        Self { ray, slab: SlabRay::new(&ray) }
    }
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
        let locals = [Local::new(Ray::MISS); RAYS].into();
        Scratch { stacks, locals, moved: [Moved::default(); RAYS].into() }
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let bodies = self.bodies.iter().map(Body::bytes).sum::<usize>();
        let list = self.levels.bytes() + self.moving.triangles.bytes() + bodies;
        let list = list + size_of_val(&*self.parts);
        MemoryReport::new([
            ("placements and flat meshes", self.above.bytes()),
            ("triangles that move", size_of_val(&*self.moving.blocks)),
            ("meshes", self.below.bytes()),
            ("list of placements", list),
        ])
    }
}
