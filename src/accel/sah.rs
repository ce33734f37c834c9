//! The surface area heuristic: the formula that all builders share.
//!
//! J. Goldsmith and J. Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987;
//! J. D. MacDonald and K. S. Booth, "Heuristics for Ray Tracing Using Space Subdivision", 1990. A
//! ray that crosses a node crosses a part of it with the probability of the part's surface over the
//! node's, so a split costs
//!
//! ```text
//! traversal_cost + intersection_cost * (area_0 * count_0 + area_1 * count_1) / area
//! ```
//!
//! Hierarchies ([`super::bvh::sah`]) compare splits of one node, where only the sum differs;
//! kd-trees ([`super::kd::build`]) need the cost itself, less a bonus for parts that are empty.

/// The sum over both parts of a split of area times count: intersection tests to expect, times the
/// node's area if the areas are not shares of it.
#[inline(always)]
pub fn expected_tests([a, b]: [(f64, f64); 2]) -> f64 {
    a.0 * a.1 + b.0 * b.1
}
