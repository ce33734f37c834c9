//! What callers see of a structure: two traits without type parameters.

use fearless_simd::Level;

use super::{AnyHit, Batch, BuildReport, ClosestHit, Counts, MemoryReport, PoolUse};
use crate::geom::Shaft;

/// A built structure: plain data, shared by all threads, never changed.
///
/// # Examples
/// ```
/// use std::sync::Arc;
///
/// use dapple::geom::{Triangle, TriangleList};
/// use dapple::math::{Ray, Vec3};
/// use dapple::{AccelSpec, Batch, ClosestHit, Isa};
///
/// let triangle = Triangle { a: Vec3::ZERO, b: Vec3::X, c: Vec3::Y };
/// let source = Arc::new(TriangleList(vec![triangle]));
/// let accel = dapple::build(&AccelSpec::default(), source, Isa::Auto)?;
/// let rays = [Ray::new(Vec3::new(0.25, 0.5, 2.0), -Vec3::Z, 0.0, f32::INFINITY)];
/// let mut hits = [ClosestHit::MISS];
/// accel.tracer().closest_hits(&Batch::new(&rays), &mut hits);
/// assert_eq!((hits[0].t, hits[0].u, hits[0].v), (2.0, 0.25, 0.5));
/// # Ok::<(), dapple::BuildError>(())
/// ```
pub trait Accel: Send + Sync {
    /// A tracer for one worker thread; it owns stacks, caches and pools.
    fn tracer(&self) -> Box<dyn Tracer + '_>;

    /// A tracer that counts its work: slower, and at the baseline instruction set.
    fn counting_tracer(&self) -> Box<dyn Tracer + '_>;

    /// The instruction set that the structure was built to be walked with.
    fn level(&self) -> Level;

    /// Exact bytes by part.
    fn memory(&self) -> MemoryReport;

    /// How it was built.
    fn report(&self) -> &BuildReport;
}

/// Answers slices of rays. One ray is a slice of one.
pub trait Tracer {
    /// Finds the nearest hit of each ray.
    ///
    /// # Panics
    /// If `hits` is not as long as the batch.
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]);

    /// Finds whether each ray hits anything.
    ///
    /// # Panics
    /// If `hits` is not as long as the batch.
    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]);

    /// The regions that this tracer is narrowed to; `None` if its structure gains nothing by them.
    fn regions(&mut self) -> Option<Box<dyn Regions + '_>> {
        None
    }

    /// What was counted since the tracer was made; all zero unless it counts.
    fn counts(&self) -> Counts;
}

/// Regions that a tracer is narrowed to, each within the one before: a screen, a tile of it, what a
/// light reaches.
///
/// A structure derives for each region what its rays need, on top of what it derived for the region
/// around it, and keeps that in a pool of the tracer's own until the region is left. Worth it for
/// many slices of rays within one region. Rays outside it are answered too.
pub trait Regions {
    /// Enters a region, within the one entered last.
    fn enter(&mut self, region: &Shaft);

    /// Leaves the region entered last; does nothing if there is none.
    fn leave(&mut self);

    /// Bytes of the pool.
    fn take_pool_use(&mut self) -> PoolUse;
}
