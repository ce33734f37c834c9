//! Kd-trees.
//!
//! M. Hapala, V. Havran, "Review: Kd-tree traversal algorithms for ray tracing", Computer Graphics
//! Forum 30(1), 2011, is what "the review" means in here.
//!
//! A builder ([`build`]) makes a [`tree::KdTree`], plain data in depth-first order. A layout
//! ([`layout`]) puts its nodes into memory; links and boxes are derived from it for those walks
//! that need them; a walk ([`walk`]) visits leaves along a ray, or (`packet`) along many.
//! [`wide_nodes`] are a form of the tree for one walk alone, that by vector instructions.
//!
//! # Why all walks find what brute force finds
//! Let u be 2^-24, half an ulp of one, and the unit of length the longest edge of the box of all
//! triangles.
//!
//! *The slack is in the tree.* A builder puts each triangle into the list of every leaf whose cell
//! it comes within δ = 128u of, along each axis: the triangle itself, clipped, not just its box
//! ([`slack`]; [`tree::KdTree::validate`] holds it). So flat triangles have thickness.
//!
//! *Tame rays* start within three edges of the centre of the scene: nearly all. Planes and origin
//! are then at most four edges apart. A plane's distance is `t(s) = (s - origin) * inverse`, one
//! function, monotone in `s` ([`ray::KdRay::t_split`]), within 3u of the truth. A node's span
//! `[enter, exit]` is cut at `t(s)`. By the tie rule ([`ray::Crossing::of`]) the spans of the
//! leaves that are visited cover the ray's own; so one of these leaves has a span with the `t` of
//! the winner in it. Is the winner in its list?
//!
//! The point at `t` is inside the leaf's cell, but for the 3u of distances of at most 4: by 12u.
//! And it is near the winner. The exact test's `t` is that of the point of the triangle which has
//! the exact test's weights. Were they exact, it would be on the ray; they are off by the rounding
//! of a difference of products, and as a triangle that is edge-on to within 2^-30 is missed, by at
//! most 3 * 2^-52 * 2^30 = 12u of its size in all, doubled by the shear. Rounding `t` moves the
//! point by another 4u, and the clamp into the triangle's own box only moves it back towards the
//! truth, which is in there. The sum, 40u, is less than δ; the rest is for the rounding of boxes
//! and of coordinates. (A walk that compares rounded points with planes adds 8u of 4, 32u: still
//! less.) Planes behind the origin do not matter, since `t > 0`, and components of zero are huge
//! slopes of their sign, for which the same holds, and which no hit is clamped by
//! ([`crate::geom::SlabRay::is_beyond`]). So the winner is within δ of the leaf's cell.
//!
//! So the candidates that a walk offers contain the winner; what else it offers does no harm, since
//! the smallest `(t, id)` wins and the exact test does not depend on where a triangle was met. A
//! hit beyond the leaf's span is welcome. A walk may stop when a hit is strictly before the span
//! that is next, for a tie might be in there.
//!
//! *Walks compare distances, never points.* To find the leaf at a distance, or to begin again,
//! they compare that distance with `t(s)`: at or behind the plane means beyond it. A plane by which
//! a cell was left is crossed by the sign of the direction. So each leaf ends strictly behind the
//! one before, and nothing can loop; and all walks test the same leaves in the same order.
//!
//! *All other rays*, and all rays of scenes so large that distances overflow, take the walk of
//! `walk::robust`, which visits the child in front of a plane up to `(s - origin) * inv_far` and
//! the one behind from `(s - origin) * inv_near` on, the slab test's two ends of the rounding
//! error. It follows the true point of the hit from cell to cell: if that is in front of a plane,
//! its true distance is at most the first, if it is behind, at least the second, whatever the
//! rounding. In double precision it is within δ of the triangle for origins up to 2^26 times as far
//! as those of tame rays. Beyond, all triangles are tested, their own boxes first.

pub mod build;
pub mod layout;
mod packet;
pub mod ray;
pub mod ropes;
pub mod slack;
pub mod tree;
mod validate;
mod variants;
pub mod walk;
pub mod wide_nodes;

pub use variants::*;
