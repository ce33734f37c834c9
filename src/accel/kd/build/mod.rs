//! Builds: where to split, when to stop. They know nothing of layouts and traversals.
//!
//! All of them go top-down by the surface area heuristic (MacDonald and Booth 1990; Wald and
//! Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006)
//! and share the costs, the rule when to stop and the recursion over parts of a tree. They give
//! the same tree on any number of threads: what runs in parallel depends on sizes only.
//!
//! `build=sah` builds two trees, by `sweep` and by `minmax`, and keeps the cheaper.

mod arena;
mod binned;
mod bins;
mod builder;
mod input;
mod limits;
mod lists;
mod minmax;
mod prune;
mod sah;
mod sweep;
#[cfg(test)]
mod tests;

pub use limits::OPTIONS;
