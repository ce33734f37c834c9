//! Both levels, built.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::placement::{Shape, ToMesh, error_inside, world_box};
use super::sources::{FlatTriangles, MeshTriangles, Placed, PlacementBoxes};
use super::spans::Spans;
use super::timed_boxes::TimedBoxes;
use crate::accel::small_meshes::{MeshUse, find_small};
use crate::accel::{Phases, PreparedRay};
use crate::geom::{Motions, Placements, TriangleSource};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId};
use crate::motion::Piece;
use crate::simd::prefetch;

/// A mesh that is kept apart: in a structure of its own, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
    /// How far off the vertices of its placements may be in its space.
    pub off: f32,
    /// By how much its boxes are grown.
    pub slack: f32,
    /// What holds all of them, with room for a ray to begin in.
    pub grown: [DVec3; 2],
}

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
    /// The placements that are kept apart; what the upper structure numbers.
    pub placements: Arc<[InstanceId]>,
    /// The ways into them, as long as they are few; else each is computed when it is needed.
    ways: Vec<Way>,
    /// Of each mesh that is kept apart what it takes.
    pub meshes: Vec<Option<Apart>>,
    /// The structures of meshes.
    pub spans: Spans,
    /// The triangles of what is flattened.
    pub flat: FlatTriangles,
    shapes: Arc<[Option<Shape>]>,
    /// The boxes of all placements if anything moves, else none; see [`find_boxes`].
    boxes: Arc<[Aabb]>,
    /// Those of what moves at its times.
    timed_boxes: TimedBoxes,
}

/// A mesh of fewer triangles is flattened: a placement costs as much.
const FEW: usize = 16;

/// Each takes 104 bytes.
const MOST_WAYS: usize = 1 << 18;

impl Levels {
    /// Divides a scene. Meshes that are placed once are flattened, and with them what can't be kept
    /// apart, see [`super::placement`]; unless `copies`, all that stands still is. What moves is
    /// always kept apart.
    pub fn new(placed: Placed, copies: bool, phases: &mut Phases) -> Self {
        let placements = placed.get();
        let motions = placements.motions();
        let moves = |placement: &InstanceId| motions.is_some_and(|it| it.is_moving(*placement));
        let mut used = find_uses(placements);
        for placement in (0..placements.len()).map(InstanceId::from_index).filter(moves) {
            used[placements.mesh(placement).index()].moves = true;
        }
        let small = find_small(&used);
        let shape = |(mesh, &MeshUse { uses, moves, .. }): (usize, &MeshUse)| {
            let mesh = MeshId::from_index(mesh);
            let worth_it = copies && uses > 1 && placements.mesh_len(mesh) >= FEW;
            let worth_it = moves || (worth_it && !small[mesh.index()]);
            worth_it.then(|| Shape::new(placements, mesh)).flatten()
        };
        let shapes: Vec<Option<Shape>> = used.par_iter().enumerate().map(shape).collect();
        let error = |placement: usize| {
            let placement = InstanceId::from_index(placement);
            let shape = shapes[placements.mesh(placement).index()].as_ref()?;
            match motions.filter(|motions| motions.is_moving(placement)) {
                Some(motions) => Some(error_over_time(shape, motions, placement)),
                None if copies => error_inside(shape, &placements.to_world(placement)),
                None => None,
            }
        };
        let mut off = vec![-1.0_f32; shapes.len()];
        let (mut apart, mut flat) = (Vec::new(), Vec::new());
        const GROUP: usize = 1 << 16;
        for first in (0..placements.len()).step_by(GROUP) {
            let group = first..placements.len().min(first + GROUP);
            let errors: Vec<Option<f32>> = group.clone().into_par_iter().map(error).collect();
            for (placement, error) in group.map(InstanceId::from_index).zip(errors) {
                match error {
                    Some(error) => {
                        let most = &mut off[placements.mesh(placement).index()];
                        *most = most.max(error);
                        apart.push(placement);
                    }
                    None => flat.push(placement),
                }
            }
        }
        let keep = |(shape, &off): (&Option<Shape>, &f32)| {
            let shape = shape.as_ref().filter(|_| off >= 0.0)?;
            let slack = shape.slack(off);
            Some(Apart { off, slack, grown: shape.grown(slack) })
        };
        let meshes = shapes.iter().zip(&off).map(keep).collect();
        // Without copies all that is kept apart moves, and has no way but at a time.
        let few = if copies && apart.len() <= MOST_WAYS { &*apart } else { &[] };
        let ways = few.par_iter().map(|&placement| Way::new(placements, placement)).collect();
        let boxes = find_boxes(placements, &apart, &shapes).into();
        let timed_boxes = TimedBoxes::new(placements, &apart, &shapes);
        let spans = Spans::new(placements);
        let flat = FlatTriangles::new(placed.clone(), flat);
        phases.end("placements");
        let (placements, shapes) = (apart.into(), shapes.into());
        Self { placed, placements, ways, meshes, spans, flat, shapes, boxes, timed_boxes }
    }

    /// Bytes of the lists of placements, and of the ways and boxes that are kept.
    pub fn bytes(&self) -> usize {
        let lists = size_of_val(&*self.placements) + size_of_val(&*self.boxes);
        lists + size_of_val(&*self.ways) + self.timed_boxes.bytes()
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

    /// The way into a placement that stands still, by its number in the upper structure.
    #[inline(always)]
    pub fn way(&self, number: usize) -> Way {
        match self.ways.get(number) {
            Some(known) => *known,
            None => Way::new(self.placed.get(), self.placements[number]),
        }
    }

    /// Prefetches the way into a placement, if it is kept.
    #[inline(always)]
    pub fn prefetch_way(&self, number: usize) {
        prefetch(&self.ways, number, size_of::<Way>());
    }

    /// Whether a ray may meet a placement at a time, before `t_max`, as far as boxes tell.
    #[inline]
    pub fn may_meet(&self, prim: PrimId, time: f32, world: &PreparedRay<'_>, t_max: f32) -> bool {
        self.timed_boxes.at(prim.index(), time).is_none_or(|held| {
            let (slab, t_min) = world.for_boxes();
            let (enter, exit) = slab.interval(held);
            enter.max(t_min) <= exit.min(t_max)
        })
    }

    /// A placement by its number in the upper structure, and where it stands at a time.
    #[inline]
    pub fn placement(&self, prim: PrimId, time: f32) -> (InstanceId, Affine3A) {
        let placement = self.placements[prim.index()];
        let placements = self.placed.get();
        let to_world = match placements.motions() {
            None => placements.to_world(placement),
            Some(motions) => motions.to_world_at(placement, time),
        };
        (placement, to_world)
    }

    /// The way into a placement's mesh, where it stands at `to_world` at a ray's time; `None` if
    /// that is no way for a ray.
    #[inline]
    pub fn to_mesh(&self, prim: PrimId, to_world: &Affine3A) -> Option<ToMesh> {
        let placements = self.placed.get();
        let placement = self.placements[prim.index()];
        if placements.motions().is_none_or(|motions| !motions.is_moving(placement)) {
            return Some(self.way(prim.index()).to_mesh);
        }
        let mesh = placements.mesh(placement).index();
        let (shape, apart) = (self.shapes[mesh].as_ref()?, self.meshes[mesh].as_ref()?);
        let error = error_inside(shape, to_world)?;
        (error <= apart.off).then(|| ToMesh::new(to_world))
    }

    /// The boxes of placements by those of their meshes, for the upper structure.
    pub fn boxes(&self) -> PlacementBoxes {
        let (placements, shapes) = (Arc::clone(&self.placements), Arc::clone(&self.shapes));
        let known = Arc::clone(&self.boxes);
        PlacementBoxes { placed: self.placed.clone(), placements, shapes, known }
    }

    /// What holds all that is kept apart, over all of the time; `None` where that is not known.
    pub fn bounds(&self) -> Option<Aabb> {
        let all = || self.boxes.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        (!self.boxes.is_empty()).then(all)
    }

    /// Whether there is time to look at all triangles of placements that are kept apart.
    pub fn are_few_triangles(&self) -> bool {
        let placements = self.placed.get();
        let len = |&placement: &InstanceId| placements.mesh_len(placements.mesh(placement));
        let total = self.placements.iter().map(len).try_fold(0, usize::checked_add);
        total.is_some_and(|total| total <= MOST_LOOKED_AT)
    }

    /// What structure number `structure` holds of a mesh, if that is kept apart.
    pub fn mesh(&self, structure: usize) -> Option<MeshTriangles> {
        let (mesh, span) = self.spans.locate(structure);
        let slack = self.meshes[mesh.index()].as_ref()?.slack;
        Some(MeshTriangles { placed: self.placed.clone(), mesh, slack, span })
    }
}

/// How far off the vertices of a moving placement may be in its mesh's space, wherever that is
/// little enough; with some room, since only the middles of pieces are looked at: at other times
/// each ray looks for itself.
fn error_over_time(shape: &Shape, motions: &dyn Motions, placement: InstanceId) -> f32 {
    let pieces = shape.pieces(motions, placement);
    let error = |piece: &Piece| {
        error_inside(shape, &motions.to_world_at(placement, piece.middle)).unwrap_or(0.0)
    };
    1.5 * pieces.iter().map(error).fold(0.0, f32::max)
}

/// All meshes, and how each is placed.
pub fn find_uses(placements: &dyn Placements) -> Vec<MeshUse> {
    let mesh = |mesh| {
        let mesh = MeshId::from_index(mesh);
        MeshUse::new(placements.mesh_len(mesh) as u64, placements.mesh_bounds(mesh))
    };
    let mut used: Vec<MeshUse> = (0..placements.meshes()).into_par_iter().map(mesh).collect();
    for placement in (0..placements.len()).map(InstanceId::from_index) {
        used[placements.mesh(placement).index()].place(&placements.to_world(placement));
    }
    used
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
