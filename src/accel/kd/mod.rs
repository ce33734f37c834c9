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
//! Let u be 2^-24, half an ulp of one, and the unit of length the longest edge of the box of all
//! triangles.
//!
//! *The slack is in the tree.* Before anything else a builder grows each triangle by δ = 128u along
//! each axis ([`slack`]), and then puts it into the list of every leaf that it touches. So flat
//! triangles have thickness, and lists hold all triangles within δ of their cells.
//!
//! *Tame rays* start within three edges of the centre of the scene: nearly all. Planes and origin
//! are then at most four edges apart. A plane's distance is `t(s) = (s - origin) * inverse`, one
//! function, monotone in `s` ([`ray::KdRay::t_split`]), within 3u of the truth. A node's span
//! `[enter, exit]` is cut at `t(s)`. By the tie rule ([`ray::Crossing::of`]) the spans of the leaves
//! that are visited cover the ray's own; so one of these leaves has a span with the `t` of the
//! winner in it. Is the winner in its list? Say it is not; then among the leaf's ancestors there is
//! a plane with the leaf on one side and the triangle, grown, on the other. Let the leaf be the one
//! in front: `t <= t(s)`, but the triangle begins more than δ behind the plane. The verdict clamps
//! `t` to at least the slab test's distance of the near plane `lo` of the triangle's own box, which
//! is `x (1 - 11u) / d` or more, where x is the distance from the origin to `lo` along the axis;
//! and `t(s)` is `y (1 + 3u) / d` or less, where y < x - δ. As x is at most 4, δ exceeds 14u x, and
//! `t(s) < t`: a contradiction. With the leaf behind the plane it is the same with far planes.
//! Planes behind the origin do not matter, since `t > 0`. Components of zero are huge slopes of
//! their sign, and the same holds. What is left of δ covers the rounding of the boxes.
//!
//! *With clipped triangles* (`build=sah`) a list holds the triangles within δ of the cell, not
//! those whose boxes are. The point at the winner's `t` is in the cell but for 3u of distances of
//! at most 4, and for the rounding of `t`: 16u in all. By how the verdict finds `t` it is the point
//! of the triangle with the same weights, but for the rounding of the weights; a triangle that is
//! edge-on to within 2^-30 being missed, that is 3 * 2^-52 * 2^30 of the triangle's size, or less
//! than 32u across and along the ray. Together less than δ. (A walk that compares rounded points
//! with planes adds 8u of 4, or 32u: still less.)
//!
//! So the candidates that a walk offers contain the winner; what else it offers does no harm,
//! since the smallest `(t, id)` wins and the verdict does not depend on where a triangle was met.
//! A hit beyond the leaf's span is welcome. A walk may stop when a hit is strictly before the span
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
//! error. If a triangle's box is in front only, its `t` is at most the distance of the box's far
//! plane, thus of `s`, by monotony; if behind only, likewise; if it is on both sides, one of the
//! two spans contains `t`, since the second begins before the first ends. No slack is needed. With
//! clipped triangles the same walk follows the true point of the hit, in double precision, from
//! cell to cell; that is within δ of the triangle for origins up to 2^26 times as far as those of
//! tame rays. Beyond, all triangles are tested.

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
