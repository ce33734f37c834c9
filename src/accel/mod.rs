//! Ray-shooting structures: one trait, one table, the same hits to the bit.
//!
//! # Why every structure finds the same hits
//! 1. *One exact test.* Whether a ray hits a triangle, and the hit's `t`, `u` and `v`, is decided
//!    by [`crate::geom::intersect_triangle()`], or, for packets, by
//!    [`crate::geom::RayBundle::intersect_triangle`]: the same additions and multiplications in the
//!    same order for eight rays at once. A test holds the two to the same bits. Blocks of triangles
//!    only filter, and never reject what the exact test would accept ([`crate::geom::block`]).
//! 2. *One winner.* Of the hits with `t_min < t <= t_max` that pass the batch's filter, the one
//!    with the smallest `(t, id)` wins ([`Closest`]). That is a minimum over a set, so the order of
//!    visits does not matter, as long as every candidate that could win is offered.
//! 3. *A hit lies in its own box.* The exact test accepts a hit only if the ray passes the slab
//!    test of the triangle's own box, and clamps `t` into that interval. The slab test is monotone
//!    in the box ([`crate::geom::slab`]): in floating point, too, a ray enters every box around the
//!    own box at or before `t`, and leaves it at or after `t`. Culling a box only if `enter >
//!    t_max` or `enter > exit`, strictly, never loses the winner, nor a hit that ties with it. So
//!    builders of bounding volumes start from [`crate::geom::own_box`] and only ever take unions.
//! 4. *In a kd-tree* cells partition space, so a box is not enough: the builder adds a slack to
//!    every triangle's box. [`kd`] says why that is enough.
//!
//! A ray with a NaN or infinite part, or without a direction, misses everything:
//! [`crate::math::Ray::new`] sees to that, and keeps NaN out of all comparisons.
//!
//! # The way of a ray
//! A caller hands a [`Batch`] to a [`Tracer`]. Its worker (`traverse`) chooses the code of the
//! instruction set and calls [`Traverse::trace`] with a [`SliceContext`]. Structures that walk ray
//! by ray ([`WalkRay`]) get a [`RayContext`] for each; structures for packets cut the slice
//! themselves (`packet`). A walk tests leaves by [`RayContext::test_block`], which filters and
//! then asks the exact test.
//!
//! # Adding a structure
//! Write a type that implements [`Structure`] and either [`WalkRay`] or [`Traverse`], and add a row
//! to [`VARIANTS`]. The command line, the agreement tests, `validate` and the bench find it there.

mod batch;
pub mod brute;
pub mod bvh;
mod context;
mod counters;
mod error;
mod flat;
mod footprint;
mod hit;
mod instances;
mod interface;
pub mod kd;
mod located;
mod narrowing;
mod options;
mod packet;
mod query;
mod report;
mod sah;
mod side_by_side;
mod small_meshes;
mod steps;
mod traverse;
mod two_level;
mod variant;
mod variants;
mod verdict;

pub use batch::Batch;
pub use context::{RayContext, SliceContext};
pub use counters::{Counters, Counts, Event, NotCounted};
pub use error::{BuildError, SpecError};
pub use footprint::Footprint;
pub use hit::{AnyHit, ClosestHit, HitFilter};
pub use instances::Instances;
pub use interface::{Accel, Regions, Tracer};
pub use options::{OptionSpec, Options, Value, Values};
pub use query::{Any, Closest, HitCriteria, PreparedRay, Query};
pub use report::{BuildReport, MemoryReport, Phases, PoolUse};
pub use small_meshes::MeshUse;
pub use steps::Steps;
pub use traverse::{Built, Structure, Traverse, WalkRay};
pub use variant::{BuildInput, Variant};
pub use variants::{AccelSpec, VARIANTS, build, build_metered};
pub use verdict::{BlockFilter, Verdict};
