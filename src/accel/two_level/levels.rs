//! Both levels, built.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::placement::{Shape, ToMesh, error_inside};
use super::sources::{FlatTriangles, MeshTriangles, Placed, PlacementBoxes};
use crate::accel::Phases;
use crate::geom::{Motions, Placements, TriangleSource};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId};
use crate::motion::Piece;

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

/// How a scene is divided: which placements are kept apart, and which are flattened together.
pub struct Levels {
    /// The scene.
    pub placed: Placed,
    /// The placements that are kept apart; what the upper structure numbers.
    pub placements: Arc<[InstanceId]>,
    /// The ways back, as long as they are few; else each is computed when it is needed.
    to_mesh: Vec<ToMesh>,
    /// Of each mesh that is kept apart what it takes.
    pub meshes: Vec<Option<Apart>>,
    shapes: Arc<[Option<Shape>]>,
    flat: Vec<InstanceId>,
    /// The boxes of those that move, by their numbers in the upper structure.
    moving: Arc<HashMap<u32, Aabb>>,
}

/// As many uses of a mesh as say that it moves.
const MOVES: u32 = u32::MAX;

/// A mesh of fewer triangles is flattened: a placement costs as much.
const FEW: usize = 16;

/// Ways back take 96 bytes each.
const MOST_WAYS_BACK: usize = 1 << 18;

impl Levels {
    /// Divides a scene. Meshes that are placed once are flattened, and with them what can't be kept
    /// apart, see [`super::placement`]; unless `copies`, all that stands still is. What moves is
    /// always kept apart.
    pub fn new(placed: Placed, copies: bool, phases: &mut Phases) -> Self {
        let placements = placed.get();
        let motions = placements.motions();
        let moves = |placement| motions.is_some_and(|motions| motions.is_moving(placement));
        let mut uses = vec![0_u32; placements.meshes()];
        for placement in 0..placements.len() {
            let placement = InstanceId::from_index(placement);
            let mesh = placements.mesh(placement).index();
            uses[mesh] = if moves(placement) { MOVES } else { uses[mesh].saturating_add(1) };
        }
        let shape = |(mesh, &uses): (usize, &u32)| {
            let mesh = MeshId::from_index(mesh);
            let worth_it = copies && uses > 1 && placements.mesh_len(mesh) >= FEW;
            (worth_it || uses == MOVES).then(|| Shape::new(placements, mesh)).flatten()
        };
        let shapes: Vec<Option<Shape>> = uses.par_iter().enumerate().map(shape).collect();
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
        let moving = Arc::new(boxes_over_time(placements, &apart, &shapes));
        let to_mesh: Vec<ToMesh> = if copies && placements.len() <= MOST_WAYS_BACK {
            let all = (0..placements.len()).into_par_iter().map(InstanceId::from_index);
            all.map(|placement| ToMesh::new(&placements.to_world(placement))).collect()
        } else {
            Vec::new()
        };
        phases.end("placements");
        let placements = apart.into();
        Self { placements, to_mesh, meshes, shapes: shapes.into(), flat, moving, placed }
    }

    /// Whether anything moves.
    pub fn are_moving(&self) -> bool {
        !self.moving.is_empty()
    }

    /// The way into the space of a placement's mesh, which stands still.
    #[inline(always)]
    pub fn to_mesh(&self, placement: InstanceId) -> ToMesh {
        match self.to_mesh.get(placement.index()) {
            Some(known) => *known,
            None => ToMesh::new(&self.placed.get().to_world(placement)),
        }
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

    /// The way into the space of a placement's mesh, where it stands at `to_world` at a ray's time;
    /// `None` if that is no way for a ray.
    #[inline]
    pub fn to_mesh_from(&self, placement: InstanceId, to_world: &Affine3A) -> Option<ToMesh> {
        let placements = self.placed.get();
        if placements.motions().is_none_or(|motions| !motions.is_moving(placement)) {
            return Some(self.to_mesh(placement));
        }
        let mesh = placements.mesh(placement).index();
        let (shape, apart) = (self.shapes[mesh].as_ref()?, self.meshes[mesh].as_ref()?);
        let error = error_inside(shape, to_world)?;
        (error <= apart.off).then(|| ToMesh::new(to_world))
    }

    /// The boxes of placements, for the upper structure.
    pub fn boxes(&self) -> PlacementBoxes {
        let (placements, shapes) = (Arc::clone(&self.placements), Arc::clone(&self.shapes));
        let moving = Arc::clone(&self.moving);
        PlacementBoxes { placed: self.placed.clone(), placements, shapes, moving }
    }

    /// The triangles of a mesh that is kept apart.
    pub fn mesh(&self, mesh: usize) -> Option<MeshTriangles> {
        let slack = self.meshes[mesh].as_ref()?.slack;
        Some(MeshTriangles { placed: self.placed.clone(), mesh: MeshId::from_index(mesh), slack })
    }

    /// What is flattened, if anything.
    pub fn flat(&self) -> Option<FlatTriangles> {
        let flat = FlatTriangles::new(self.placed.clone(), self.flat.clone());
        (!flat.is_empty()).then_some(flat)
    }
}

/// The boxes of those of some placements that move, by their numbers among these.
fn boxes_over_time(
    placements: &dyn Placements,
    apart: &[InstanceId],
    shapes: &[Option<Shape>],
) -> HashMap<u32, Aabb> {
    let over_time = |(number, &placement): (usize, &InstanceId)| {
        let motions = placements.motions().filter(|motions| motions.is_moving(placement))?;
        let shape = shapes[placements.mesh(placement).index()].as_ref()?;
        Some((number as u32, shape.box_over_time(motions, placement)))
    };
    apart.par_iter().enumerate().filter_map(over_time).collect()
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
