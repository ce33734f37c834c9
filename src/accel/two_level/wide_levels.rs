//! Wide hierarchies on both levels, built.

use std::borrow::Cow;
use std::sync::Arc;

use super::levels::Levels;
use super::mesh_trees::MeshTrees;
use super::parts::{Part, open};
use super::sources::{Boxes, Together};
use crate::accel::bvh::link::Link;
use crate::accel::bvh::wide::arena::Stripes;
use crate::accel::bvh::wide::stack::{DEEPEST, Stack};
use crate::accel::bvh::wide::wide_bvh::{RAYS, WideBvh};
use crate::accel::{BuildError, Built, MemoryReport, Phases, Structure};
use crate::geom::{SlabRay, TriangleSource};
use crate::math::{PrimId, Ray};

/// Lanes of a vector, children of a node.
pub const W: usize = 8;

/// A hierarchy of placements and of what is flattened, and one of each mesh.
pub struct WideLevels {
    /// How the scene is divided.
    pub levels: Arc<Levels>,
    /// The upper tree.
    pub above: WideBvh<W>,
    /// Those of meshes.
    pub below: MeshTrees,
    /// Places of leaves from here on are parts of placements.
    pub first_part: usize,
    /// What the upper tree has of placements; none if it has them whole.
    parts: Vec<Part>,
    built: Built,
}

/// A link that no walk follows, since its key is zero; a leaf, so that it is no node either.
pub const BACK: Link = Link(1 << 31);

impl WideLevels {
    /// Puts placements and what is flattened into a tree, over the trees of meshes; `tree` builds
    /// one. `None` if they can't be walked together.
    ///
    /// # Errors
    /// If there is not enough memory, or for limits of a tree.
    pub fn build(
        levels: &Arc<Levels>,
        below: Vec<Option<WideBvh<W>>>,
        tree: impl Fn(Arc<dyn TriangleSource>) -> Result<WideBvh<W>, BuildError>,
        mut phases: Phases,
    ) -> Result<Option<Self>, BuildError> {
        let of_meshes = || below.iter().flatten();
        let deepest = of_meshes().map(|tree| tree.report().max_depth).max().unwrap_or(0);
        let nodes: usize = of_meshes().map(|tree| tree.report().nodes).sum();
        let leaves: usize = of_meshes().map(|tree| tree.report().leaves).sum();
        if !of_meshes().all(WideBvh::stores_triangles) {
            return Ok(None);
        }
        let Some(below) = MeshTrees::new(below)? else { return Ok(None) };
        phases.end("meshes");
        let (parts, boxes) = match open(levels, &below) {
            Some(parts) => {
                let (parts, boxes) = parts.into_iter().unzip();
                (parts, Box::new(Boxes(boxes)) as Box<dyn TriangleSource>)
            }
            None => (Vec::new(), Box::new(levels.boxes()) as Box<dyn TriangleSource>),
        };
        phases.end("parts of placements");
        let together = Together { flat: levels.flat.clone(), boxes };
        BuildError::check_count(together.len())?;
        let (count, first_box) = (together.len(), levels.flat.len());
        let mut above = tree(Arc::new(together))?;
        phases.end("tree of placements");
        // A level of its own each: the leaf of placements, and the way back.
        let depth = above.report().max_depth + deepest + 2;
        let first_part = above.arena.stripes().count();
        if depth > DEEPEST || first_part + count >= Link::LIMIT || !above.stores_triangles() {
            return Ok(None);
        }
        // A leaf of one part is passed by: its box is that which leads there.
        above.redirect(|ids| {
            let number = ids[0].index().checked_sub(first_box)?;
            (ids[1] == PrimId::NONE).then(|| Link::to_leaf(first_part + number))
        });
        let mut report = above.report().clone();
        (report.phases, report.triangles) = (phases.ended(), levels.placed.len());
        (report.nodes, report.leaves) = (report.nodes + nodes, report.leaves + leaves);
        let built = Built { level: above.level(), report };
        let levels = Arc::clone(levels);
        Ok(Some(Self { levels, above, below, first_part, parts, built }))
    }

    /// A part of a placement, by its number.
    #[inline(always)]
    pub fn part(&self, number: usize) -> Option<Cow<'_, Part>> {
        if let Some(part) = self.parts.get(number) {
            return Some(Cow::Borrowed(part));
        }
        let way = self.levels.way(number);
        let mesh = way.mesh.index();
        let (apart, root) = (self.levels.meshes[mesh].as_ref()?, self.below.root(mesh)?);
        Some(Cow::Owned(Part { way, root, grown: apart.grown, slack: apart.slack }))
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

/// What a tracer has for each ray in flight.
pub struct Scratch {
    /// What waits for it.
    pub stacks: Box<[Stack<W>]>,
    /// What it is in the placement that it has entered last.
    pub locals: Box<[Local]>,
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
        Scratch { stacks, locals: [Local::new(Ray::MISS); RAYS].into() }
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let list = self.levels.bytes() + size_of_val(&*self.parts);
        MemoryReport::new([
            ("placements and flat meshes", self.above.arena.bytes()),
            ("meshes", self.below.bytes()),
            ("list of placements", list),
        ])
    }
}
