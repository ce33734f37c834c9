//! Kd-trees.
//!
//! M. Hapala, V. Havran, "Review: Kd-tree traversal algorithms for ray tracing", Computer Graphics
//! Forum 30(1), 2011, is what "the review" means in here.
//!
//! A builder ([`build`]) makes a [`tree::KdTree`], plain data in depth-first order. A layout
//! ([`layout`]) puts its nodes into memory; links and boxes are derived from it for those walks
//! that need them; a walk ([`walk`]) visits leaves along a ray.
//!
//! # Why all walks find what brute force finds
//! *The slack is in the tree.* Before anything else a builder grows the own box of each triangle
//! by δ along each axis ([`slack`]). Flat triangles have thickness, and each triangle is in the
//! list of every leaf within δ of it.
//!
//! *Tame rays* start within three times the scene's longest edge of its centre, which is nearly
//! all. A plane's distance is `t(s) = (s - origin) * inverse`, one function, monotone in `s`
//! ([`ray::KdRay::t_split`]). A node's span `[enter, exit]` is cut at `t(s)`: with the tie rule
//! ([`ray::Crossing::of`]) the spans of the leaves that are visited cover the ray's own, so one of
//! them contains the `t` of the winner. Is the winner in that leaf's list? Say it is not: then there
//! is a plane among the leaf's ancestors with the leaf on one side and the triangle, grown, on the
//! other. Let the leaf be in front: `t <= t(s)`, but the triangle begins more than δ behind the
//! plane. The verdict clamps `t` to be at least `(lo - origin) * inverse * (1 - 2^-21)`, as rounded,
//! where `lo` is the near plane of the triangle's own box. With u = 2^-24 and x the distance from
//! origin to `lo` along the axis, that is at least `x (1 - 11u) / d`; and `t(s)` at most
//! `y (1 + 3u) / d`, where y < x - δ. Since x is at most four edges, δ = 2^-17 edges = 128u edges
//! exceeds 14u x, hence t(s) < t: a contradiction. Behind the plane it is the same with `exit`, and
//! planes behind the origin do not matter, since t > 0. Slopes of zero are huge numbers of their
//! sign, for which the same holds. The rest of δ covers the rounding of the boxes.
//!
//! So the candidates that a walk offers always contain the winner; what else it offers does no
//! harm, since the smallest `(t, id)` wins and the verdict does not depend on where a triangle was
//! met. A hit beyond the leaf's span is welcome. A walk may stop when a hit is strictly before the
//! span that is next, for a tie might be in there.
//!
//! *Walks compare distances, never points.* To find the leaf at a distance, or to begin again,
//! they compare that distance with `t(s)`: at or behind the plane means beyond it. A plane by which
//! a cell was left is crossed by the sign of the direction. So each leaf ends strictly behind the
//! one before, and nothing can loop.
//!
//! *All other rays*, and all rays of scenes so large that distances overflow, take the walk of
//! `walk::robust`, which visits the child in front of a plane up to `(s - origin) * inv_far` and
//! the one behind from `(s - origin) * inv_near` on, the slab test's two ends of the rounding
//! error. If the triangle is in front only, `t` is at most the distance of its box's far plane,
//! thus of `s`, by monotony; if behind only, likewise; if it is on both sides, one of the two spans
//! contains `t`, since the first ends where or after the second begins. No slack is needed.

pub mod build;
pub mod layout;
pub mod links;
pub mod ray;
mod rows;
pub mod slack;
pub mod tree;
mod validate;
pub mod walk;

pub use rows::*;
