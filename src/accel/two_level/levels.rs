//! Both levels, built.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::placement::{Shape, ToMesh, error_inside};
use super::sources::{FlatTriangles, MeshTriangles, Placed, PlacementBoxes};
use crate::accel::Phases;
use crate::geom::TriangleSource;
use crate::math::{Affine3A, InstanceId, MeshId, PrimId};

/// A mesh that is kept apart: in a structure of its own, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
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
}

/// A mesh of fewer triangles is flattened: a placement costs as much.
const FEW: usize = 16;

/// Ways back take 96 bytes each.
const MOST_WAYS_BACK: usize = 1 << 18;

impl Levels {
    /// Divides a scene. Meshes that are placed once are flattened, and with them what can't be kept
    /// apart; see [`super::placement`].
    pub fn new(placed: Placed, phases: &mut Phases) -> Self {
        let placements = placed.get();
        let mut uses = vec![0_u32; placements.meshes()];
        for placement in 0..placements.len() {
            let mesh = placements.mesh(InstanceId::from_index(placement)).index();
            uses[mesh] = uses[mesh].saturating_add(1);
        }
        let shape = |(mesh, &uses): (usize, &u32)| {
            let mesh = MeshId::from_index(mesh);
            let worth_it = uses > 1 && placements.mesh_len(mesh) >= FEW;
            worth_it.then(|| Shape::new(placements, mesh)).flatten()
        };
        let shapes: Vec<Option<Shape>> = uses.par_iter().enumerate().map(shape).collect();
        let error = |placement: usize| {
            let placement = InstanceId::from_index(placement);
            let shape = shapes[placements.mesh(placement).index()].as_ref()?;
            error_inside(shape, &placements.to_world(placement))
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
            Some(Apart { slack, grown: shape.grown(slack) })
        };
        let meshes = shapes.iter().zip(&off).map(keep).collect();
        let to_mesh: Vec<ToMesh> = if placements.len() <= MOST_WAYS_BACK {
            let all = (0..placements.len()).into_par_iter().map(InstanceId::from_index);
            all.map(|placement| ToMesh::new(&placements.to_world(placement))).collect()
        } else {
            Vec::new()
        };
        phases.end("placements");
        Self { placements: apart.into(), to_mesh, meshes, shapes: shapes.into(), flat, placed }
    }

    /// The way into the space of a placement's mesh.
    #[inline(always)]
    pub fn to_mesh(&self, placement: InstanceId) -> ToMesh {
        match self.to_mesh.get(placement.index()) {
            Some(known) => *known,
            None => ToMesh::new(&self.placed.get().to_world(placement)),
        }
    }

    /// A placement by its number in the upper structure, and where it stands.
    #[inline]
    pub fn placement(&self, prim: PrimId) -> (InstanceId, Affine3A) {
        let placement = self.placements[prim.index()];
        (placement, self.placed.get().to_world(placement))
    }

    /// The boxes of placements, for the upper structure.
    pub fn boxes(&self) -> PlacementBoxes {
        let (placements, shapes) = (Arc::clone(&self.placements), Arc::clone(&self.shapes));
        PlacementBoxes { placed: self.placed.clone(), placements, shapes }
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
