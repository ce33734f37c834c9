//! What rays hit, as the renderer asks for it: hits are judged by their alpha where anything is
//! see-through, and found at the time of each ray where anything moves.

use crate::accel::{AnyHit, Batch, ClosestHit, HitFilter, Tracer};
use crate::camera::CameraRays;
use crate::integrator::{Interior, Path, interior_at};
use crate::math::{Ray, Vec3};
use crate::world::{AlphaFilter, World};

/// Rays that are traced together.
pub(super) struct Slice<'a> {
    /// The segments.
    pub rays: &'a [Ray],
    /// Their keys for the alpha filter; not asked for where nothing is see-through.
    pub keys: &'a [u64],
    /// Their times; not asked for where nothing moves.
    pub times: &'a [f32],
}

impl Slice<'_> {
    /// Calls `trace` with the rays, as structures take them.
    #[inline(always)]
    fn with_batch(&self, world: &World, trace: impl FnOnce(Batch<'_>)) {
        let times = world.moves().then_some(self.times);
        let filter = AlphaFilter::new(world, self.keys, times);
        let filter = world.is_see_through().then_some(&filter as &dyn HitFilter);
        trace(Batch::new(self.rays).with_filter(filter).with_times(times));
    }
}

/// Finds what each ray hits first, into `hits`; `grid` is the raster that the rays are, if they are
/// one.
pub(super) fn find_hits(
    world: &World,
    tracer: &mut dyn Tracer,
    slice: &Slice<'_>,
    grid: Option<(u32, u32)>,
    hits: &mut Vec<ClosestHit>,
) {
    hits.clear();
    hits.resize(slice.rays.len(), ClosestHit::MISS);
    slice.with_batch(world, |batch| {
        let batch = match grid {
            Some((width, height)) => batch.with_grid(width, height),
            None => batch,
        };
        tracer.closest_hits(&batch, hits);
    });
}

/// Finds whether anything is in the way of each ray, into `blocked`.
pub(super) fn find_blocked(
    world: &World,
    tracer: &mut dyn Tracer,
    slice: &Slice<'_>,
    blocked: &mut Vec<AnyHit>,
) {
    blocked.clear();
    blocked.resize(slice.rays.len(), AnyHit(false));
    slice.with_batch(world, |batch| tracer.any_hits(&batch, blocked));
}

/// Puts paths that start at the camera inside of the solids around it, where there are media.
pub(super) fn start_inside(
    world: &World,
    tracer: &mut dyn Tracer,
    camera: &CameraRays,
    paths: &mut [Path],
) {
    if !world.has_media() {
        return;
    }
    // Where nothing moves, the time of all is the same.
    let still =
        (!world.moves()).then(|| interior_around(world, tracer, camera.centre_at(0.0), 0.0));
    for path in paths {
        let time = path.time;
        path.start_in(
            still.unwrap_or_else(|| interior_around(world, tracer, camera.centre_at(time), time)),
        );
    }
}

/// The solids around a point at a `time` of the shutter: what is see-through there counts as whole.
fn interior_around(world: &World, tracer: &mut dyn Tracer, point: Vec3, time: f32) -> Interior {
    let times = [time];
    let times = world.moves().then_some(&times[..]);
    interior_at(world, (point, time), |ray| {
        let mut hit = [ClosestHit::MISS];
        tracer.closest_hits(&Batch::new(&[*ray]).with_times(times), &mut hit);
        hit[0]
    })
}
