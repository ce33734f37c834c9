//! Both levels, built.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::placement::{Shape, ToMesh, error_inside};
use super::sources::{FlatTriangles, MeshTriangles, Placed, PlacementBoxes};
use crate::accel::Phases;
use crate::geom::Placements;
use crate::math::{Affine3A, InstanceId, MeshId, PrimId};

/// A mesh that is kept apart: in a structure of its own, in its own space.
#[derive(Clone, Copy, Debug)]
pub struct Apart {
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
    /// The triangles of what is flattened.
    pub flat: FlatTriangles,
    shapes: Arc<[Option<Shape>]>,
}

/// A mesh of fewer triangles is flattened: a placement costs as much.
const FEW: usize = 16;

/// Each takes 104 bytes.
const MOST_WAYS: usize = 1 << 18;

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
        let small = find_small(placements, &uses);
        let shape = |(mesh, &uses): (usize, &u32)| {
            let mesh = MeshId::from_index(mesh);
            let worth_it = uses > 1 && placements.mesh_len(mesh) >= FEW;
            (worth_it && !small[mesh.index()]).then(|| Shape::new(placements, mesh)).flatten()
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
        let few = if apart.len() <= MOST_WAYS { &*apart } else { &[] };
        let ways = few.par_iter().map(|&placement| Way::new(placements, placement)).collect();
        let flat = FlatTriangles::new(placed.clone(), flat);
        phases.end("placements");
        Self { placements: apart.into(), ways, meshes, flat, shapes: shapes.into(), placed }
    }

    /// The way into a placement, by its number in the upper structure.
    #[inline(always)]
    pub fn way(&self, number: usize) -> Way {
        match self.ways.get(number) {
            Some(known) => *known,
            None => Way::new(self.placed.get(), self.placements[number]),
        }
    }

    /// A placement by its number in the upper structure, and where it stands.
    #[inline]
    pub fn placement(&self, prim: PrimId) -> (InstanceId, Affine3A) {
        let placement = self.placements[prim.index()];
        (placement, self.placed.get().to_world(placement))
    }

    /// The boxes of placements by those of their meshes, for the upper structure.
    pub fn boxes(&self) -> PlacementBoxes {
        let (placements, shapes) = (Arc::clone(&self.placements), Arc::clone(&self.shapes));
        PlacementBoxes { placed: self.placed.clone(), placements, shapes }
    }

    /// Whether there is time to look at all triangles of placements that are kept apart.
    pub fn are_few_triangles(&self) -> bool {
        let placements = self.placed.get();
        let len = |&placement: &InstanceId| placements.mesh_len(placements.mesh(placement));
        let total = self.placements.iter().map(len).try_fold(0, usize::checked_add);
        total.is_some_and(|total| total <= MOST_LOOKED_AT)
    }

    /// The triangles of a mesh that is kept apart.
    pub fn mesh(&self, mesh: usize) -> Option<MeshTriangles> {
        let slack = self.meshes[mesh].as_ref()?.slack;
        Some(MeshTriangles { placed: self.placed.clone(), mesh: MeshId::from_index(mesh), slack })
    }
}

/// So many triangles are flattened of meshes that are placed more than once: 150 MB.
const MOST_FLATTENED: u64 = 1 << 21;

/// Which meshes are small enough to be flattened however often they are placed: from the smallest
/// on, while all copies so made have no more than twice the triangles of all meshes. Small parts
/// lie within the boxes of others: a ray enters many, and that takes as long as some ten nodes. In
/// a hall of robots rays entered half as many placements, and took four fifths of the time.
fn find_small(placements: &dyn Placements, uses: &[u32]) -> Vec<bool> {
    let len = |mesh: usize| placements.mesh_len(MeshId::from_index(mesh)) as u64;
    let mut copied: Vec<usize> = (0..uses.len()).filter(|&mesh| uses[mesh] > 1).collect();
    copied.sort_by_key(|&mesh| len(mesh));
    let unique: u64 = (0..uses.len()).filter(|&mesh| uses[mesh] > 0).map(len).sum();
    let mut room = MOST_FLATTENED.min(2 * unique);
    let mut small = vec![false; uses.len()];
    for mesh in copied {
        let Some(left) = room.checked_sub(len(mesh) * u64::from(uses[mesh])) else { break };
        (small[mesh], room) = (true, left);
    }
    small
}

/// All triangles of placements are looked at if these are no more; it takes some 10 ms a million.
const MOST_LOOKED_AT: usize = 1 << 23;
