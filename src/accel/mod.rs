//! Ray-shooting structures: one trait, one table, the same answer to the bit.
//!
//! # Why every structure answers alike
//! 1. *One exact test.* Whether a triangle is hit, and `t`, `u`, `v`, is said by
//!    [`crate::geom::intersect_triangle()`] alone, a scalar function of the ray and the triangle.
//!    Blocks of triangles only filter, and never stop what the exact test would take
//!    ([`crate::geom::block`]).
//! 2. *One winner.* Of the hits with `t_min < t <= t_max` that pass the batch's filter, the
//!    smallest `(t, id)` wins ([`Closest`]). That is a minimum over a set: order cannot matter, as
//!    long as every candidate that could win is offered.
//! 3. *A hit lies in its own box.* The exact test takes a hit only if the slab test of the
//!    triangle's own box passes and clamps `t` into that interval. The slab test is monotone in the
//!    box ([`crate::geom::slab`]): every box around it is entered at or before `t` and left at or
//!    after it, in floating point. Culling a box only if `enter > t_max` or `enter > exit`,
//!    strictly, never loses the winner, nor one that ties with it. Builders of bounding volumes
//!    therefore start from [`crate::geom::own_box`] and only ever take unions.
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
mod context;
mod counters;
mod error;
mod interface;
pub mod kd;
mod narrowing;
mod options;
mod packet;
mod query;
mod report;
mod sah;
mod traverse;
mod variant;
mod variants;

pub use batch::{AnyHit, Batch, ClosestHit, HitFilter};
pub use context::{RayContext, SliceContext};
pub use counters::{Counters, Counts, Event, NotCounted};
pub use error::{BuildError, SpecError};
pub use interface::{Accel, Regions, Tracer};
pub use options::{OptionSpec, Options, Value, Values};
pub use query::{Any, Closest, HitCriteria, PreparedRay, Query};
pub use report::{BuildReport, MemoryReport, Phases, PoolUse};
pub use traverse::{Structure, Traverse, WalkRay};
pub use variant::{BuildInput, Variant};
pub use variants::{AccelSpec, VARIANTS, build};
