//! Both levels, built.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::division::{Apart, Division};
use super::outline::Outline;
use super::placement::{Shape, ToMesh, world_box};
use super::sources::{FlatTriangles, MeshTriangles, Placed, PlacementBoxes};
use super::spans::Spans;
use super::timed_boxes::TimedBoxes;
use super::timed_ways::TimedWays;
use crate::accel::{Phases, PreparedRay};
use crate::geom::{Placements, TriangleSource};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId};

/// The way into a placement.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    /// The placement.
    pub placement: InstanceId,
    /// Its mesh.
    pub mesh: MeshId,
    /// Into the mesh's space.
    pub to_mesh: ToMesh,
}

impl Way {
    #[inline]
    fn new(placements: &dyn Placements, placement: InstanceId) -> Self {
        let to_mesh = ToMesh::new(&placements.to_world(placement));
        Self { placement, mesh: placements.mesh(placement), to_mesh }
    }
}

/// How a scene is divided: which placements are kept apart, and which are flattened together.
pub struct Levels {
    /// The scene.
    pub placed: Placed,
    /// The placements that are kept apart, what moves last; what the upper structure numbers.
    pub placements: Arc<[InstanceId]>,
    /// How many of them stand still.
    pub still: usize,
    /// The ways into those, if they are kept; else each is computed when it is needed.
    ways: OnceLock<Vec<Way>>,
    /// Those into what moves, where only its shape does and nothing is off by too much; as long as
    /// they are few.
    ways_of_moving: Vec<Option<ToMesh>>,
    /// Of each mesh that is kept apart what it takes.
    pub meshes: Vec<Option<Apart>>,
    /// The structures of meshes.
    pub spans: Spans,
    /// The triangles of what is flattened.
    pub flat: FlatTriangles,
    /// What all placements of a mesh have in common, of each that is kept apart.
    pub shapes: Arc<[Option<Shape>]>,
    /// The boxes of all placements if anything moves, else none; see [`find_boxes`].
    boxes: Arc<[Aabb]>,
    /// Those of what moves at its times.
    pub timed_boxes: TimedBoxes,
    /// The ways into that, as far as they were asked for.
    pub timed_ways: TimedWays,
}

/// Each takes 104 bytes.
const MOST_WAYS: usize = 1 << 18;

impl Levels {
    /// Divides a scene, see [`Division::new`].
    pub fn new(placed: Placed, copies: bool, phases: &mut Phases) -> Self {
        let placements = placed.get();
        let Division { apart, still, flat, shapes, meshes } = Division::new(placements, copies);
        let boxes = find_boxes(placements, &apart, &shapes).into();
        let spans = Spans::new(placements);
        let timed_boxes = TimedBoxes::new(placements, &apart[still..], &shapes, &spans);
        let flat = FlatTriangles::new(placed.clone(), flat);
        phases.end("placements");
        let (placements, shapes) = (apart.into(), shapes.into());
        let mut levels = Self {
            placed,
            placements,
            still,
            ways: OnceLock::new(),
            ways_of_moving: Vec::new(),
            meshes,
            spans,
            flat,
            shapes,
            boxes,
            timed_boxes,
            timed_ways: TimedWays::default(),
        };
        levels.ways_of_moving = levels.find_ways_of_moving();
        levels
    }

    /// Has ways into some of what moves, by its numbers, in order. Boxes of meshes may grow by
    /// that.
    #[must_use]
    pub fn with_timed_ways(mut self, moving: &[u32]) -> Self {
        let all = &self.placements[self.still..];
        let known = (&*self.shapes, &self.timed_boxes);
        let (placements, meshes) = (self.placed.get(), &mut self.meshes);
        self.timed_ways = TimedWays::new(placements, (all, moving), known, meshes);
        self
    }

    fn find_ways_of_moving(&self) -> Vec<Option<ToMesh>> {
        let placements = self.placed.get();
        let Some(motions) = placements.motions() else { return Vec::new() };
        let moving = &self.placements[self.still..];
        if moving.len() > MOST_WAYS || !moving.iter().any(|&placement| motions.stays(placement)) {
            return Vec::new();
        }
        let find = |(moving, &placement): (usize, &InstanceId)| {
            let stays = motions.stays(placement).then(|| placements.to_world(placement));
            stays.and_then(|to_world| self.find_way(self.still + moving, &to_world))
        };
        moving.par_iter().enumerate().map(find).collect()
    }

    /// Bytes of the lists of placements, and of the ways and boxes that are kept.
    pub fn bytes(&self) -> usize {
        let lists = size_of_val(&*self.placements) + size_of_val(&*self.boxes);
        let ways = self.ways.get().map_or(0, |ways| size_of_val(&**ways));
        let ways = ways + size_of_val(&*self.ways_of_moving);
        lists + ways + self.timed_boxes.bytes() + self.timed_ways.bytes()
    }

    /// How many triangles and placements the structures are built over.
    pub fn count_primitives(&self) -> usize {
        let meshes = (0..self.spans.len()).filter_map(|structure| self.mesh(structure));
        self.placements.len() + self.flat.len() + meshes.map(|mesh| mesh.len()).sum::<usize>()
    }

    /// Whether anything moves.
    pub fn are_moving(&self) -> bool {
        self.placed.get().motions().is_some()
    }

    /// The structure, or the first of them, of the mesh of a placement, by its number.
    #[inline]
    pub fn structure_of(&self, number: usize) -> usize {
        self.spans.of_mesh(self.placed.get().mesh(self.placements[number])).start
    }

    /// Keeps the ways into what stands still, as long as they are few.
    pub fn keep_ways(&self) {
        let placements = self.placed.get();
        // What moves has no way but at a time.
        let few = if self.still <= MOST_WAYS { &self.placements[..self.still] } else { &[] };
        let way = |&placement: &InstanceId| Way::new(placements, placement);
        self.ways.get_or_init(|| few.par_iter().map(way).collect());
    }

    /// The way into a placement that stands still, by its number in the upper structure.
    #[inline(always)]
    pub fn way(&self, number: usize) -> Way {
        match self.ways.get().and_then(|ways| ways.get(number)) {
            Some(known) => *known,
            None => Way::new(self.placed.get(), self.placements[number]),
        }
    }

    /// Whether a ray may meet a placement at a time, before `t_max`, as far as boxes tell.
    #[inline]
    pub fn may_meet(&self, prim: PrimId, time: f32, world: &PreparedRay<'_>, t_max: f32) -> bool {
        let Some(moving) = prim.index().checked_sub(self.still) else { return true };
        self.timed_boxes.at(moving, time).is_none_or(|held| {
            let (slab, t_min) = world.for_boxes();
            let (enter, exit) = slab.interval(held);
            enter.max(t_min) <= exit.min(t_max)
        })
    }

    /// A placement by its number in the upper structure, and where it stands at a time.
    #[inline]
    pub fn placement(&self, prim: PrimId, time: f32) -> (InstanceId, Affine3A) {
        let placement = self.placements[prim.index()];
        (placement, self.to_world_at(placement, time))
    }

    /// Where a placement stands at a time.
    #[inline]
    pub fn to_world_at(&self, placement: InstanceId, time: f32) -> Affine3A {
        let placements = self.placed.get();
        match placements.motions() {
            None => placements.to_world(placement),
            Some(motions) => motions.to_world_at(placement, time),
        }
    }

    /// The way into a placement's mesh, where it stands at `to_world` at a ray's time; `None` if
    /// that is no way for a ray.
    #[inline]
    pub fn to_mesh(&self, prim: PrimId, to_world: &Affine3A) -> Option<ToMesh> {
        match prim.index().checked_sub(self.still) {
            None => Some(self.way(prim.index()).to_mesh),
            Some(moving) => match self.ways_of_moving.get(moving) {
                Some(Some(known)) => Some(*known),
                _ => self.find_way(prim.index(), to_world),
            },
        }
    }

    /// The way into a placement that stands at `to_world`, if no vertex is off by more than its
    /// mesh allows for.
    fn find_way(&self, number: usize, to_world: &Affine3A) -> Option<ToMesh> {
        let mesh = self.placed.get().mesh(self.placements[number]).index();
        let (shape, apart) = (self.shapes[mesh].as_ref()?, self.meshes[mesh].as_ref()?);
        let to_mesh = ToMesh::new(to_world);
        (to_mesh.error(shape, to_world)? <= apart.off).then_some(to_mesh)
    }

    /// The boxes of placements by those of their meshes, for the upper structure.
    pub fn boxes(&self) -> PlacementBoxes {
        let (placements, shapes) = (Arc::clone(&self.placements), Arc::clone(&self.shapes));
        let known = Arc::clone(&self.boxes);
        PlacementBoxes { placed: self.placed.clone(), placements, shapes, known }
    }

    /// The boxes of those that stand still.
    pub fn boxes_of_still(&self) -> PlacementBoxes {
        let all = self.boxes();
        if self.still == self.placements.len() {
            return all;
        }
        PlacementBoxes { placements: self.placements[..self.still].into(), ..all }
    }

    /// The boxes of those that move over a part of the time, of [`TimedBoxes::parts`].
    pub fn boxes_of_moving(&self, part: usize) -> Vec<Aabb> {
        let moving = 0..self.placements.len() - self.still;
        moving.map(|moving| self.box_of_moving(moving, part)).collect()
    }

    /// The box of one of them.
    pub fn box_of_moving(&self, moving: usize, part: usize) -> Aabb {
        *self.timed_boxes.over(moving, part, &self.boxes[self.still + moving])
    }

    /// What holds all that is kept apart over each part of the time, if anything moves.
    pub fn outline(&self) -> Option<Outline> {
        self.placed.get().motions()?;
        let still = &self.boxes[..self.still];
        let still = still.iter().copied().reduce(Aabb::union);
        let over = |part| self.boxes_of_moving(part).into_iter().chain(still).collect();
        Some(Outline::new(self.timed_boxes.parts(), over))
    }

    /// Whether there is time to look at all triangles of placements that are kept apart and stand
    /// still.
    pub fn are_few_triangles(&self) -> bool {
        let placements = self.placed.get();
        let len = |&placement: &InstanceId| placements.mesh_len(placements.mesh(placement));
        let total = self.placements[..self.still].iter().map(len).try_fold(0, usize::checked_add);
        total.is_some_and(|total| total <= MOST_LOOKED_AT)
    }

    /// What structure number `structure` holds of a mesh, if that is kept apart.
    pub fn mesh(&self, structure: usize) -> Option<MeshTriangles> {
        let (mesh, span) = self.spans.locate(structure);
        let slack = self.meshes[mesh.index()].as_ref()?.slack;
        Some(MeshTriangles { placed: self.placed.clone(), mesh, slack, span })
    }
}

/// All triangles of placements are looked at if these are no more; it takes some 10 ms a million.
const MOST_LOOKED_AT: usize = 1 << 23;

/// The boxes of placements if anything moves, of what does over all of the time. Else none: they
/// are found as fast when they are needed.
fn find_boxes(
    placements: &dyn Placements,
    apart: &[InstanceId],
    shapes: &[Option<Shape>],
) -> Vec<Aabb> {
    let Some(motions) = placements.motions() else { return Vec::new() };
    let find = |&placement: &InstanceId| {
        let shape = shapes[placements.mesh(placement).index()].as_ref();
        let shape = shape.expect("its mesh is kept apart");
        if motions.is_moving(placement) {
            shape.box_over_time(motions, placement)
        } else {
            world_box(shape, &placements.to_world(placement))
        }
    };
    apart.par_iter().map(find).collect()
}
