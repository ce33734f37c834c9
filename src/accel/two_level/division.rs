//! Which placements are kept apart, and which are flattened.

use glam::DVec3;
use rayon::prelude::*;

use super::placement::{Shape, error_inside};
use crate::accel::small_meshes::{MeshUse, find_small};
use crate::geom::{Motions, Placements};
use crate::math::{InstanceId, MeshId};
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
    /// Whether it changes its shape.
    pub deforming: bool,
}

impl Apart {
    fn new(shape: &Shape, off: f32, deforming: bool) -> Self {
        let slack = shape.slack(off);
        Self { off, slack, grown: shape.grown(slack), deforming }
    }

    /// Of a stiff body; `None` if its vertices are off by too much.
    pub fn of_body(shape: &Shape, off: f64) -> Option<Self> {
        shape.allows(off).then(|| Self::new(shape, off as f32, false))
    }

    /// Allows for vertices that are `off` in the space of a mesh of a `shape`.
    pub fn allow(&mut self, shape: &Shape, off: f32) {
        if off > self.off {
            *self = Self::new(shape, off, self.deforming);
        }
    }
}

/// A scene's placements, divided.
pub struct Division {
    /// Those that are kept apart, in order, but for what moves, which comes last.
    pub apart: Vec<InstanceId>,
    /// How many of these stand still.
    pub still: usize,
    /// Those that are flattened, in order.
    pub flat: Vec<InstanceId>,
    /// Of each mesh that may be kept apart.
    pub shapes: Vec<Option<Shape>>,
    /// Of each that is.
    pub meshes: Vec<Option<Apart>>,
}

/// A mesh of fewer triangles is flattened: a placement costs as much.
const FEW: usize = 16;

/// So many placements are looked at side by side.
const GROUP: usize = 1 << 16;

impl Division {
    /// Divides a scene. Meshes that are placed once are flattened, and with them what can't be kept
    /// apart, see [`super::placement`]; unless `copies`, all that stands still is. What moves is
    /// always kept apart.
    pub fn new(placements: &dyn Placements, copies: bool) -> Self {
        let motions = placements.motions();
        let moves = |placement: &InstanceId| motions.is_some_and(|it| it.is_moving(*placement));
        let shapes = find_shapes(placements, copies, moves);
        let error = |placement: InstanceId| {
            let shape = shapes[placements.mesh(placement).index()].as_ref()?;
            match motions.filter(|motions| motions.is_moving(placement)) {
                Some(motions) => Some(error_over_time(shape, motions, placement)),
                None if copies => error_inside(shape, &placements.to_world(placement)),
                None => None,
            }
        };
        let mut off = vec![-1.0_f32; shapes.len()];
        let (mut apart, mut flat) = (Vec::new(), Vec::new());
        for first in (0..placements.len()).step_by(GROUP) {
            let group = first..placements.len().min(first + GROUP);
            let group = group.into_par_iter().map(InstanceId::from_index);
            let errors: Vec<_> = group.map(|placement| (placement, error(placement))).collect();
            for (placement, error) in errors {
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
        apart.sort_by_key(moves);
        let still = apart.partition_point(|placement| !moves(placement));
        let keep = |(mesh, (shape, &off)): (usize, (&Option<Shape>, &f32))| {
            let shape = shape.as_ref().filter(|_| off >= 0.0)?;
            let mesh = MeshId::from_index(mesh);
            let deforming = motions.is_some_and(|motions| motions.is_deforming(mesh));
            Some(Apart::new(shape, off, deforming))
        };
        let meshes = shapes.iter().zip(&off).enumerate().map(keep).collect();
        Self { apart, still, flat, shapes, meshes }
    }
}

/// The shapes of those meshes that are worth a structure of their own.
fn find_shapes(
    placements: &dyn Placements,
    copies: bool,
    moves: impl Fn(&InstanceId) -> bool,
) -> Vec<Option<Shape>> {
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
    used.par_iter().enumerate().map(shape).collect()
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
