//! What rays hit, as the renderer asks for it: hits are judged by their alpha where anything is
//! see-through.

use crate::accel::{Batch, ClosestHit, HitFilter, Tracer};
use crate::integrator::{Interior, interior_at};
use crate::math::{Ray, Vec3};
use crate::world::{AlphaFilter, World};

/// Finds what each ray hits first, into `hits`. `keys` are those of the rays for the alpha filter,
/// not asked for where nothing is see-through; `grid` is the raster that they are, if they are one.
pub(super) fn find_hits(
    world: &World,
    tracer: &mut dyn Tracer,
    (rays, keys): (&[Ray], &[u64]),
    grid: Option<(u32, u32)>,
    hits: &mut Vec<ClosestHit>,
) {
    hits.clear();
    hits.resize(rays.len(), ClosestHit::MISS);
    let filter = AlphaFilter::new(world, keys);
    let filter = world.is_see_through().then_some(&filter as &dyn HitFilter);
    let mut batch = Batch::new(rays).with_filter(filter);
    if let Some((width, height)) = grid {
        batch = batch.with_grid(width, height);
    }
    tracer.closest_hits(&batch, hits);
}

/// The solids around a point: what is see-through there counts as whole.
pub(super) fn interior_around(world: &World, tracer: &mut dyn Tracer, point: Vec3) -> Interior {
    interior_at(world, point, |ray| {
        let mut hit = [ClosestHit::MISS];
        tracer.closest_hits(&Batch::new(&[*ray]), &mut hit);
        hit[0]
    })
}
