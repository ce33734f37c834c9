//! Ray-shooting structures: one trait, one table, the same answer to the bit.
//!
//! # Why every structure answers alike
//! 1. *One verdict.* Whether a triangle is hit, and `t`, `u`, `v`, is said by
//!    [`crate::geom::verdict()`] alone, a scalar function of the ray and the triangle. Blocks of
//!    triangles only filter, and never stop what the verdict would take ([`crate::geom::block`]).
//! 2. *One winner.* Of the hits with `t_min < t <= t_max` that pass the batch's filter, the
//!    smallest `(t, id)` wins ([`Closest`]). That is a minimum over a set: order cannot matter, as
//!    long as every candidate that could win is offered.
//! 3. *A hit lies in its own box.* The verdict takes a hit only if the slab test of the triangle's
//!    own box passes and clamps `t` into that interval. The slab test is monotone in the box
//!    ([`crate::geom::slab`]): every box around it is entered at or before `t` and left at or
//!    after it, in floating point. Culling a box only if `enter > t_max` or `enter > exit`, strictly,
//!    never loses the winner, nor one that ties with it. Builders of bounding volumes therefore
//!    start from [`crate::geom::own_box`] and only ever take unions.
//! 4. *In a kd-tree* the cells partition space, so a box is not enough: there the builder adds a
//!    slack to every triangle's box; its module tells why that is enough.
//!
//! A ray with a NaN or infinite part, or without a direction, misses: [`crate::math::Ray::new`]
//! sees to that, and keeps NaN out of all comparisons.
//!
//! # Adding a structure
//! Write a type that implements [`Traverse`] and add a row to [`VARIANTS`]. The command line, the
//! agreement tests, `validate` and the bench pick it up from there.

mod batch;
pub mod brute;
pub mod bvh;
mod coherent;
mod counters;
mod error;
pub mod kd;
mod options;
mod query;
mod report;
mod traverse;
mod variants;

use fearless_simd::Level;

pub use batch::{AnyHit, Batch, ClosestHit, HitFilter};
pub use counters::{Counters, Counts, Event, NotCounted};
pub use error::{BuildError, SpecError};
pub use options::{OptionSpec, Options, Value, Values};
pub use query::{
    Any, Closest, HitCriteria, PreparedRay, Query, test_block, test_each, test_triangle,
};
pub use report::{BuildReport, MemoryReport, Phases, PoolUse};
pub use traverse::Traverse;
pub use variants::{AccelSpec, BuildInput, VARIANTS, Variant, build};

use crate::geom::Shaft;

/// A built structure: plain data, shared by all threads, never changed.
pub trait Accel: Send + Sync {
    /// What one worker thread shoots with; it owns stacks, caches and pools.
    fn tracer(&self) -> Box<dyn Tracer + '_>;

    /// The same, counting its work; slower, and at the portable instruction set.
    fn counting_tracer(&self) -> Box<dyn Tracer + '_>;

    /// The instruction set that it was built to be walked with.
    fn level(&self) -> Level;

    /// The same structure narrowed to a region, for many slices of rays that lie in it: a screen, a
    /// tile, what a light reaches. Rays that the region does not hold are answered too. `None` if
    /// the structure has nothing to gain by it.
    fn view(&self, _: &Shaft) -> Option<Box<dyn Accel + '_>> {
        None
    }

    /// Exact bytes by part.
    fn memory(&self) -> MemoryReport;

    /// How it was built.
    fn report(&self) -> &BuildReport;
}

/// Answers slices of rays. One ray is a slice of one.
pub trait Tracer {
    /// The nearest hit of each ray.
    ///
    /// # Panics
    /// If `hits` is not as long as the batch.
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]);

    /// Whether each ray hits anything.
    ///
    /// # Panics
    /// If `hits` is not as long as the batch.
    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]);

    /// Narrows what follows to a region, until [`Tracer::leave`]: for many slices of rays that lie
    /// in it, such as those of a screen or of a tile of it. Regions are nested, each within the last.
    /// What a structure derives for one lies in a pool of this thread, upon that of the region
    /// around it, and goes when it is left. Rays that the region does not hold are answered too.
    fn enter(&mut self, _: &Shaft) {}

    /// Ends the innermost region; nothing happens if there is none.
    fn leave(&mut self) {}

    /// Bytes of this thread's pool.
    fn pool(&mut self) -> PoolUse {
        PoolUse::default()
    }

    /// What was counted since it was made; all zero unless it counts.
    fn counts(&self) -> Counts;
}
