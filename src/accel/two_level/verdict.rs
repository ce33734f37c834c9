//! Who says what is hit, on each level.

use std::cell::RefCell;

use super::levels::{Apart, Levels};
use super::placement::{Entered, LocalRay, enter, limit};
use crate::accel::{
    AnyHit, Batch, BlockFilter, ClosestHit, HitFilter, PreparedRay, Tracer, Verdict,
};
use crate::geom::{Triangle, intersect_triangle};
use crate::math::{Affine3A, InstanceId, PrimId, Ray, TriangleId, Vec3};
use crate::simd::baseline;

/// A ray within a placement: what its triangles are in the world decides.
pub struct Inside<'a> {
    /// The ray in the world.
    pub world: &'a PreparedRay<'a>,
    /// The greatest `t` that counts.
    pub t_max: f32,
    /// The placement.
    pub placement: InstanceId,
    /// From the mesh's space to the world.
    pub to_world: Affine3A,
    /// Whether it turns left into right.
    pub mirrored: bool,
    /// The world's `t` where the ray begins in the mesh's space.
    pub shift: f64,
    /// How far off vertices may be in the mesh's space.
    pub slack: f32,
}

impl<'a> Inside<'a> {
    /// A ray that has entered a placement of `apart`.
    pub fn new(
        world: &'a PreparedRay<'a>,
        t_max: f32,
        (placement, to_world): (InstanceId, Affine3A),
        apart: &Apart,
        shift: f64,
    ) -> Self {
        let mirrored = to_world.matrix3.determinant() < 0.0;
        let slack = apart.slack;
        Self { world, t_max, placement, to_world, mirrored, shift, slack }
    }

    /// What the exact test says of a triangle of the mesh.
    #[inline]
    pub fn test(
        &self,
        prim: PrimId,
        corners: &Triangle,
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        let [a, b, c] = corners.corners().map(|p: Vec3| self.to_world.transform_point3(p));
        let triangle =
            if self.mirrored { Triangle { a, b: c, c: b } } else { Triangle { a, b, c } };
        let PreparedRay { slab, shear, .. } = self.world;
        let [t, u, v] = intersect_triangle(baseline(), slab, shear, &triangle)?;
        let triangle = TriangleId { instance: self.placement, index: prim.0 };
        let hit = ClosestHit { t, u, v, triangle };
        let counts = if any { t <= nearest.t } else { hit.is_before(nearest) };
        (counts && self.world.criteria().accepts(&hit)).then_some(hit)
    }
}

impl Verdict for Inside<'_> {
    fn judge(
        &self,
        _: usize,
        (prim, corners): (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        self.test(prim, corners, nearest, any)
    }

    fn filter(&self) -> BlockFilter {
        BlockFilter::Near(self.slack)
    }

    fn t_max(&self, _: &Ray) -> f32 {
        self.t_max
    }

    fn limit(&self, t: f32) -> f32 {
        limit(self.shift, t)
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
    /// The rays of the batch.
    pub rays: &'a [Ray],
    /// The batch's filter.
    pub filter: Option<&'a dyn HitFilter>,
}

impl Above<'_, '_> {
    /// Holds a ray against all triangles of a placement.
    #[cold]
    fn test_all(&self, inside: &Inside<'_>, nearest: &ClosestHit, any: bool) -> Option<ClosestHit> {
        let placements = self.levels.placed.get();
        let mesh = placements.mesh(inside.placement);
        let (mut nearest, mut found) = (*nearest, None);
        for index in 0..placements.mesh_len(mesh) as u32 {
            let corners = placements.mesh_triangle(mesh, index);
            if let Some(hit) = inside.test(PrimId(index), &corners, &nearest, any) {
                (nearest, found) = (hit, Some(hit));
                if any {
                    break;
                }
            }
        }
        found
    }
}

impl Verdict for Above<'_, '_> {
    fn judge(
        &self,
        ray: usize,
        (prim, _): (PrimId, &Triangle),
        nearest: &ClosestHit,
        any: bool,
    ) -> Option<ClosestHit> {
        let (placement, to_world) = self.levels.placement(prim);
        let mesh = self.levels.placed.get().mesh(placement).index();
        let apart = self.levels.meshes[mesh].as_ref().expect("its mesh is kept apart");
        let world = &self.rays[ray];
        let entered = enter(&apart.grown, &to_world, world, nearest.t);
        let world = PreparedRay::new(world, ray, self.filter);
        let (ray, shift) = match entered {
            Entered::Missed => return None,
            Entered::Inside(LocalRay { ray, shift }) => (ray, shift),
            Entered::Far => {
                let inside = Inside::new(&world, nearest.t, (placement, to_world), apart, 0.0);
                return self.test_all(&inside, nearest, any);
            }
        };
        let inside = Inside::new(&world, nearest.t, (placement, to_world), apart, shift);
        let rays = [ray];
        let batch = Batch::new(&rays).with_verdict(&inside);
        let mut tracers = self.tracers.borrow_mut();
        let tracer = tracers[mesh].get_or_insert_with(|| (self.make)(mesh));
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
