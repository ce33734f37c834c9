//! Wide hierarchies on both levels, built.

use std::borrow::Cow;
use std::sync::Arc;

use rayon::prelude::*;

use super::levels::Levels;
use super::parts::{Part, open};
use super::sources::{Boxes, FlatTriangles, Together};
use super::trees::Trees;
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::stack::{DEEPEST, Stack};
use crate::accel::bvh::wide::wide_bvh::{RAYS, WideBvh};
use crate::accel::{BuildError, Built, MemoryReport, Phases, Structure};
use crate::geom::{SlabRay, TriangleSource};
use crate::math::{Affine3A, MeshId, PrimId, Ray};

/// Lanes of a vector, children of a node.
pub const W: usize = 8;

/// A hierarchy of placements and of what is flattened, and one of each mesh. Of what moves there is
/// one for each part of the time.
pub struct WideLevels {
    /// How the scene is divided.
    pub levels: Arc<Levels>,
    /// What is flattened and in the upper tree; nothing where anything moves.
    pub flat: FlatTriangles,
    /// The upper trees: of what stands still, then of what moves, by parts of the time.
    pub above: Trees,
    /// Those of meshes.
    pub below: Trees,
    /// Places of leaves of the upper trees from here on are of what moves.
    pub first_moving: usize,
    /// Places of leaves from here on are parts of placements, and behind them what moves.
    pub first_part: usize,
    /// How many parts, or whole placements, stand still.
    pub still_parts: usize,
    /// What the upper tree has of placements; none if it has them whole.
    parts: Vec<Part>,
    built: Built,
}

/// A link that no walk follows, since its key is zero; a leaf, so that it is no node either.
pub const BACK: Link = Link(1 << 31);

impl WideLevels {
    /// Puts placements and `flat` triangles into a tree, over the trees of meshes; `tree` builds
    /// one. `None` if they can't be walked together.
    ///
    /// # Errors
    /// If there is not enough memory, or for limits of a tree.
    pub fn build(
        levels: &Arc<Levels>,
        flat: FlatTriangles,
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
        let moving = build_moving(levels, &tree)?;
        phases.end("tree of placements");
        let of_all = || std::iter::once(&standing).chain(&moving);
        // A level of its own each: the leaf of placements, the way back, and a second root.
        let depth = of_all().map(|tree| tree.report().max_depth).max().unwrap_or(0) + deepest + 3;
        let first_moving = standing.arena.stripes().count();
        let first_part: usize = of_all().map(|tree| tree.arena.stripes().count()).sum();
        let count = still_parts + levels.placements.len() - levels.still;
        let are_walkable = of_all().all(WideBvh::stores_triangles);
        if depth > DEEPEST || first_part + count >= Link::LIMIT || !are_walkable {
            return Ok(None);
        }
        let first = of_all().find(|tree| tree.root.is_some()).unwrap_or(&standing);
        let mut report = first.report().clone();
        (report.phases, report.triangles) = (phases.clone().ended(), levels.placed.len());
        report.nodes = of_all().map(|tree| tree.report().nodes).sum::<usize>() + nodes;
        report.leaves = of_all().map(|tree| tree.report().leaves).sum::<usize>() + leaves;
        let built = Built { level: standing.level(), report };
        let numbers = (first_part, first_box, still_parts);
        let Some(above) = bring_together(standing, moving, numbers)? else { return Ok(None) };
        let levels = Arc::clone(levels);
        Ok(Some(Self {
            levels,
            flat,
            above,
            below,
            first_moving,
            first_part,
            still_parts,
            parts,
            built,
        }))
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

    /// The root of the upper tree of what moves, at a time.
    #[inline(always)]
    pub fn root_of_moving(&self, time: f32) -> Option<Link> {
        self.above.root(1 + self.levels.timed_boxes.part(time))
    }

    /// Whether there are such trees.
    #[inline(always)]
    pub fn has_moving_trees(&self) -> bool {
        self.first_moving < self.first_part
    }

    /// Prefetches what a link leads to: a node or a leaf among `stripes`, or a part of a placement.
    #[inline(always)]
    pub fn prefetch(&self, stripes: Stripes<'_, W>, link: Link) {
        let place = link.place();
        let number = place.wrapping_sub(self.first_part);
        if self.parts.is_empty() {
            // Both: one of them is there already.
            self.levels.prefetch_way(number.min(place));
            stripes.prefetch(link);
        } else {
            stripes.prefetch_or((&self.parts, number), place < self.first_part, link);
        }
    }
}

/// The trees of what moves over each part of the time; none if nothing does.
fn build_moving(
    levels: &Levels,
    tree: &(impl Fn(Arc<dyn TriangleSource>) -> Result<WideBvh<W>, BuildError> + Sync),
) -> Result<Vec<WideBvh<W>>, BuildError> {
    if levels.still == levels.placements.len() {
        return Ok(Vec::new());
    }
    let over = |part| tree(Arc::new(Boxes(levels.boxes_of_moving(part))));
    (0..levels.timed_boxes.parts()).into_par_iter().map(over).collect()
}

/// Brings the upper trees together. Leaves of one box are passed by: it is that which leads there;
/// links lead to its placement, by where parts of placements begin and by how many numbers there
/// are before those of the tree's boxes.
fn bring_together(
    mut standing: WideBvh<W>,
    mut moving: Vec<WideBvh<W>>,
    (first_part, first_box, still_parts): (usize, usize, usize),
) -> Result<Option<Trees>, BuildError> {
    let pass_by = |tree: &mut WideBvh<W>, first_tree: usize, first_box: usize, before: usize| {
        tree.redirect(|ids| {
            let number = ids[0].index().checked_sub(first_box)?;
            let place = first_part + before + number - first_tree;
            (ids[1] == PrimId::NONE).then(|| Link::to_leaf(place))
        });
    };
    pass_by(&mut standing, 0, first_box, 0);
    if moving.is_empty() {
        return Ok(Some(Trees::single(standing)));
    }
    let mut first_tree = standing.arena.stripes().count();
    for tree in &mut moving {
        pass_by(tree, first_tree, 0, still_parts);
        first_tree += tree.arena.stripes().count();
    }
    Trees::new(std::iter::once(standing).chain(moving).map(Some).collect())
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

/// A placement at the time of a ray.
#[derive(Clone, Copy, Default)]
pub struct Moved {
    /// Where it stands.
    pub to_world: Affine3A,
    /// The time, from 0 to 1.
    pub time: f32,
    /// Its mesh, if that changes its shape.
    pub deforming: Option<MeshId>,
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
        let list = self.levels.bytes() + size_of_val(&*self.parts);
        MemoryReport::new([
            ("placements and flat meshes", self.above.bytes()),
            ("meshes", self.below.bytes()),
            ("list of placements", list),
        ])
    }
}
