//! Shafts: convex regions that hold all rays of a batch, so that a box is decided on for all of
//! them at once.
//!
//! A. Reshetov, A. Soupikov and J. Hurley, "Multi-level ray tracing algorithm", 2005, cull boxes by
//! the planes around a bundle of rays. Ours stand in the frame of the bundle's corner rays, not of
//! an axis of the world: so the four planes fit a tile of a picture however the camera is turned.
//!
//! # Why no ray is lost
//! A region is an intersection of half-spaces `n · x <= c`. It *holds* a ray if for each of them
//! `n · o <= c`, and either `n · d <= 0` or the ray's end lies in it too: so all of its points do.
//! A box is *missed* if the least `n · x` in it is above `c` by more than a slack, for one of the
//! planes. Claim: then the slab test ([`super::slab`]), clipped to the ray's own interval, does
//! not take the box for any ray that is held. For suppose that it does, at some `t` between its
//! `enter` and `exit`.
//!
//! *The point at `t` is near the box.* A distance to a plane is off by less than 2^-20 of itself
//! (two roundings of the inverse, 4 ulps of slack, two more roundings). So along each axis the
//! point is within 2^-20 of the distance from origin to plane of the box, which is at most the sum
//! `b + o` of the largest coordinates of box and origins along that axis. Where a component of the
//! direction is below 2^-126 the slab test takes that instead; then the point may be off by `t`
//! times 2^-125, and `t` is at most 2^21 times the sum along the direction's largest component,
//! which is above 2^-20.
//!
//! *The planes are rounded.* The least `n · x` of a box is three products and their sum, off by
//! less than 2^-22 of `Σ |n| b`; the offset `c` likewise, of `Σ |n| o + |c|`. The sign of `n · d`
//! is settled by widening slopes by 2^-18 where a region is made from rays, by double precision
//! where a ray is asked about: what that leaves is below 2^-50 of `|n| |d| t`, and `|d| t` is at
//! most `b + o` along each axis. An error at a segment's end counts by `t` over its length, since
//! `n · x` is linear along it.
//!
//! *The slack* is 2^-18 of `Σ |n| (b + o) + |c|`, with 2^-80 of the largest coordinate added to
//! each of `b` and `o`, plus 2^-120 for products that underflow: more than all of these together.
//! Directions whose largest component is not within 2^-20 to 2^20, and origins beyond 2^100, are
//! held by no shaft, and boxes that reach beyond 2^100 are never missed: so nothing overflows.

mod holds;
mod of_rays;
mod region;
#[cfg(test)]
mod tests;

pub use region::Shaft;
