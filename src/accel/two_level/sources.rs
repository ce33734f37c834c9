//! What the structures of two levels are built over.

use std::sync::Arc;

use super::placement::{Shape, world_box};
use crate::geom::{Numbering, Placements, Triangle, TriangleSource, own_box};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId, TriangleId};

/// A scene's triangles, of which there are placements.
#[derive(Clone)]
pub struct Placed(Arc<dyn TriangleSource>);

impl Placed {
    /// `None` if its triangles are not of placed meshes.
    pub fn new(source: Arc<dyn TriangleSource>) -> Option<Self> {
        source.placements().is_some().then_some(Self(source))
    }

    /// How many triangles they have.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The placements.
    #[inline]
    pub fn get(&self) -> &dyn Placements {
        self.0.placements().expect("checked when it was made")
    }
}

/// A mesh in its own space.
pub struct MeshTriangles {
    /// Whose mesh it is.
    pub placed: Placed,
    /// The mesh.
    pub mesh: MeshId,
    /// By how much its boxes are grown.
    pub slack: f32,
    /// From when to when it is asked about, if it changes its shape.
    pub span: [f32; 2],
}

impl MeshTriangles {
    fn is_deforming(&self) -> bool {
        let motions = self.placed.get().motions();
        motions.is_some_and(|motions| motions.is_deforming(self.mesh))
    }
}

impl TriangleSource for MeshTriangles {
    fn len(&self) -> usize {
        self.placed.get().mesh_len(self.mesh)
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        if self.is_deforming() {
            return ends(&self.own_box(prim));
        }
        self.placed.get().mesh_triangle(self.mesh, prim.0)
    }

    fn own_box(&self, prim: PrimId) -> Aabb {
        let placements = self.placed.get();
        let own = match placements.motions() {
            Some(motions) => motions.own_box_over(self.mesh, prim.0, self.span),
            None => own_box(&placements.mesh_triangle(self.mesh, prim.0)),
        };
        Aabb { min: own.min - self.slack, max: own.max + self.slack }
    }

    fn slack(&self) -> f32 {
        if self.is_deforming() { 0.0 } else { self.slack }
    }

    /// A mesh that changes its shape is known by the boxes of its triangles over time.
    fn boxes(&self) -> usize {
        if self.is_deforming() { self.len() } else { 0 }
    }
}

/// The ends of a box, for a source of boxes.
fn ends(&Aabb { min, max }: &Aabb) -> Triangle {
    Triangle { a: min, b: max, c: max }
}

/// The triangles of some placements in the world, one after the other.
#[derive(Clone)]
pub struct FlatTriangles {
    placed: Placed,
    placements: Arc<[InstanceId]>,
    numbering: Arc<Numbering>,
}

impl FlatTriangles {
    /// The triangles of placements, which are in order.
    pub fn new(placed: Placed, placements: Vec<InstanceId>) -> Self {
        let count = |&placement: &InstanceId| {
            let placements = placed.get();
            placements.mesh_len(placements.mesh(placement))
        };
        let numbering = Arc::new(Numbering::new(placements.iter().map(count)));
        Self { placed, placements: placements.into(), numbering }
    }

    /// The placements.
    pub fn placements(&self) -> &[InstanceId] {
        &self.placements
    }

    /// The place among these of the one that has a triangle, and the triangle's number there.
    #[inline]
    pub fn find(&self, prim: PrimId) -> (usize, u32) {
        self.numbering.find(u64::from(prim.0))
    }
}

impl TriangleSource for FlatTriangles {
    fn len(&self) -> usize {
        self.numbering.count()
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        self.placed.get().placed_triangle(self.locate(prim))
    }

    fn locate(&self, prim: PrimId) -> TriangleId {
        let (at, index) = self.find(prim);
        TriangleId { instance: self.placements[at], index }
    }
}

/// The boxes of placements in the world: what the upper structure is built over.
pub struct PlacementBoxes {
    /// Whose they are.
    pub placed: Placed,
    /// Which of them.
    pub placements: Arc<[InstanceId]>,
    /// Of each mesh that is kept apart.
    pub shapes: Arc<[Option<Shape>]>,
    /// Those that are known already: all, or none.
    pub known: Arc<[Aabb]>,
}

impl PlacementBoxes {
    /// The box of a placement.
    pub fn world_box(&self, prim: PrimId) -> Aabb {
        if let Some(known) = self.known.get(prim.index()) {
            return *known;
        }
        let placement = self.placements[prim.index()];
        let placements = self.placed.get();
        let to_world: Affine3A = placements.to_world(placement);
        let shape = self.shapes[placements.mesh(placement).index()].as_ref();
        world_box(shape.expect("its mesh is kept apart"), &to_world)
    }
}

impl TriangleSource for PlacementBoxes {
    fn len(&self) -> usize {
        self.placements.len()
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        ends(&self.world_box(prim))
    }

    fn own_box(&self, prim: PrimId) -> Aabb {
        self.world_box(prim)
    }

    fn boxes(&self) -> usize {
        self.len()
    }
}

/// Boxes of parts of placements.
pub struct Boxes(pub Vec<Aabb>);

impl TriangleSource for Boxes {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        ends(&self.0[prim.index()])
    }

    fn own_box(&self, prim: PrimId) -> Aabb {
        self.0[prim.index()]
    }

    fn boxes(&self) -> usize {
        self.len()
    }
}

/// What is flattened, and behind it boxes of placements, for one tree of both.
pub struct Together {
    /// The former.
    pub flat: FlatTriangles,
    /// The latter.
    pub boxes: Box<dyn TriangleSource>,
}

impl Together {
    /// Whose a number is.
    #[inline]
    fn find(&self, prim: PrimId) -> (&dyn TriangleSource, PrimId) {
        match prim.index().checked_sub(self.flat.len()) {
            None => (&self.flat, prim),
            Some(number) => (&*self.boxes, PrimId::from_index(number)),
        }
    }
}

impl TriangleSource for Together {
    fn len(&self) -> usize {
        self.flat.len() + self.boxes.len()
    }

    fn triangle(&self, prim: PrimId) -> Triangle {
        let (source, prim) = self.find(prim);
        source.triangle(prim)
    }

    fn own_box(&self, prim: PrimId) -> Aabb {
        let (source, prim) = self.find(prim);
        source.own_box(prim)
    }

    fn boxes(&self) -> usize {
        self.boxes.len()
    }
}
