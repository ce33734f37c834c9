//! Who says what is hit, on each level.

use std::cell::RefCell;

use fearless_simd::Simd;

use super::levels::Levels;
use super::placement::{Entered, LocalRay, ToMesh, limit};
use crate::accel::{
    AnyHit, Batch, BlockFilter, ClosestHit, HitFilter, PreparedRay, Tracer, Verdict,
};
use crate::geom::{Placements, Posed, Triangle, intersect_triangle};
use crate::math::{Affine3A, InstanceId, PrimId, Ray, TriangleId, Vec3};
use crate::simd::baseline;

/// A ray within a placement: what its triangles are in the world decides.
#[derive(Clone, Copy)]
pub struct Inside {
    /// The placement.
    pub placement: InstanceId,
    /// The world's `t` where the ray begins in the mesh's space.
    shift: f64,
    /// How far off vertices may be in the mesh's space.
    pub slack: f32,
    /// Whether the placement, or its mesh, does not stand still.
    pub moves: bool,
}

impl Inside {
    /// A ray that has entered a placement at `shift`, of a mesh whose boxes are grown by `slack`.
    #[inline(always)]
    pub fn new(placement: InstanceId, slack: f32, shift: f64) -> Self {
        Self { placement, shift, slack, moves: false }
    }

    /// The same, of a placement that moves.
    pub fn moving(self) -> Self {
        Self { moves: true, ..self }
    }

    /// What the exact test says of a triangle of the mesh and the ray in the world.
    #[inline(always)]
    pub fn test<S: Simd>(
        &self,
        simd: S,
        (to_world, world): (&Affine3A, &PreparedRay<'_>),
        (prim, corners): (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        let triangle = place(to_world, corners);
        let [t, u, v] = intersect_triangle(simd, &world.slab, &world.shear, &triangle)?;
        let triangle = TriangleId { instance: self.placement, index: prim.0 };
        let hit = ClosestHit { t, u, v, triangle };
        let counts = if any { t <= nearest.t } else { hit.is_before(nearest) };
        (counts && world.criteria().accepts(&hit)).then_some(hit)
    }

    /// See [`Verdict::limit`].
    #[inline(always)]
    pub fn limit(&self, t: f32) -> f32 {
        limit(self.shift, t)
    }
}

/// A triangle in the world, by its corners in the mesh's space; counter-clockwise from the front,
/// mirrored or not.
#[inline(always)]
pub fn place(to_world: &Affine3A, corners: &Triangle) -> Triangle {
    let [a, b, c] = corners.corners().map(
        #[inline(always)]
        |p: Vec3| to_world.transform_point3(p),
    );
    let mirrored = to_world.matrix3.determinant() < 0.0;
    if mirrored { Triangle { a, b: c, c: b } } else { Triangle { a, b, c } }
}

/// Holds a ray against all triangles of a placement, as it stands at a time: for those that can't
/// be taken into its space.
pub fn nearest_of_all(
    placements: &dyn Placements,
    (inside, time): (&Inside, f32),
    world: &PreparedRay<'_>,
    nearest: &ClosestHit,
    any: bool,
) -> Option<ClosestHit> {
    let mesh = placements.mesh(inside.placement);
    let motions = placements.motions();
    let to_world = match motions {
        None => placements.to_world(inside.placement),
        Some(motions) => motions.to_world_at(inside.placement, time),
    };
    let posed = motions.map(|motions| motions.mesh_at(mesh, time));
    let (mut nearest, mut found) = (*nearest, None);
    for index in 0..placements.mesh_len(mesh) as u32 {
        let corners = match &posed {
            None => placements.mesh_triangle(mesh, index),
            Some(posed) => posed.triangle(index),
        };
        let hit =
            inside.test(baseline(), (&to_world, world), (PrimId(index), &corners), &nearest, any);
        if let Some(hit) = hit {
            (nearest, found) = (hit, Some(hit));
            if any {
                break;
            }
        }
    }
    found
}

/// What a mesh's structure asks of a ray within a placement.
struct Below<'a> {
    inside: Inside,
    to_world: Affine3A,
    world: &'a PreparedRay<'a>,
    /// The greatest `t` that counts.
    t_max: f32,
    /// The mesh at the ray's time, if it changes its shape.
    deforming: Option<Posed<'a>>,
}

impl Verdict for Below<'_> {
    fn judge(
        &self,
        _: usize,
        (prim, corners): (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        let corners = match &self.deforming {
            None => *corners,
            Some(posed) => posed.triangle(prim.0),
        };
        let at = (&self.to_world, self.world);
        self.inside.test(baseline(), at, (prim, &corners), nearest, any)
    }

    fn filter(&self) -> BlockFilter {
        match self.deforming {
            None => BlockFilter::Near(self.inside.slack),
            Some(_) => BlockFilter::Boxes,
        }
    }

    fn t_max(&self, _: &Ray) -> f32 {
        self.t_max
    }

    fn limit(&self, t: f32) -> f32 {
        self.inside.limit(t)
    }
}

/// Rays among placements: what a placement holds is asked of its mesh's structure.
pub struct Above<'a, 't> {
    /// Both levels.
    pub levels: &'a Levels,
    /// The tracers of the meshes' structures, as far as they were asked yet.
    pub tracers: &'a RefCell<Vec<Option<Box<dyn Tracer + 't>>>>,
    /// Makes one.
    pub make: &'a dyn Fn(usize) -> Box<dyn Tracer + 't>,
    /// The rays that are asked about.
    pub rays: &'a [Ray],
    /// Their numbers in the batch.
    pub numbers: &'a [u32],
    /// The batch's filter.
    pub filter: Option<&'a dyn HitFilter>,
    /// The times of the batch's rays.
    pub times: Option<&'a [f32]>,
}

impl Verdict for Above<'_, '_> {
    fn judge(
        &self,
        ray: usize,
        (prim, _): (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        let number = self.numbers[ray] as usize;
        let time = self.times.map_or(0.0, |times| times[number]);
        let world = &PreparedRay::new(&self.rays[ray], number, self.filter);
        if !self.levels.may_meet(prim, time, world, nearest.t) {
            return None;
        }
        let (placement, to_world) = self.levels.placement(prim, time);
        let placements = self.levels.placed.get();
        let mesh = placements.mesh(placement);
        let apart = self.levels.meshes[mesh.index()].as_ref().expect("its mesh is kept apart");
        let to_mesh = self.levels.to_mesh(prim, &to_world);
        let enter = |to_mesh: ToMesh| to_mesh.enter(&apart.grown, &world.ray, nearest.t);
        let entered = to_mesh.map_or(Entered::Far, enter);
        let inside = |shift| Inside::new(placement, apart.slack, shift);
        let (ray, shift) = match entered {
            Entered::Missed => return None,
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => {
                return nearest_of_all(placements, (&inside(0.0), time), world, nearest, any);
            }
        };
        let deforming = placements.motions().filter(|motions| motions.is_deforming(mesh));
        let deforming = deforming.map(|motions| motions.mesh_at(mesh, time));
        let inside = inside(shift);
        let below = Below { inside, to_world, world, t_max: nearest.t, deforming };
        let rays = [ray];
        let batch = Batch::new(&rays).with_verdict(&below);
        let mut tracers = self.tracers.borrow_mut();
        let number = self.levels.spans.find(mesh, time);
        let tracer = tracers[number].get_or_insert_with(|| (self.make)(number));
        if any {
            let mut answer = [AnyHit(false)];
            tracer.any_hits(&batch, &mut answer);
            return answer[0].0.then_some(*nearest);
        }
        let mut hit = [ClosestHit::MISS];
        tracer.closest_hits(&batch, &mut hit);
        hit[0].is_before(nearest).then_some(hit[0])
    }

    fn filter(&self) -> BlockFilter {
        BlockFilter::Boxes
    }

    fn t_max(&self, ray: &Ray) -> f32 {
        ray.t_max()
    }

    fn limit(&self, t: f32) -> f32 {
        t
    }
}
