//! What a structure reports of its size and how it was built.

use std::time::Instant;

/// Exact bytes by part.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MemoryReport {
    /// Names and bytes.
    pub parts: Vec<(&'static str, usize)>,
}

impl MemoryReport {
    /// A report of some parts.
    pub fn new(parts: impl Into<Vec<(&'static str, usize)>>) -> Self {
        Self { parts: parts.into() }
    }

    /// All bytes.
    pub fn total(&self) -> usize {
        self.parts.iter().map(|(_, bytes)| bytes).sum()
    }
}

/// What a thread derives from a structure for the rays at hand takes memory too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PoolUse {
    /// Bytes in use, at most, since this was asked last.
    pub peak: usize,
    /// Bytes that the pool has taken.
    pub size: usize,
}

/// A clock for the phases of a build, one after another.
#[derive(Clone, Debug)]
pub struct Phases {
    /// When the one that runs began.
    start: Instant,
    ended: Vec<(&'static str, f64)>,
}

impl Phases {
    /// The first phase begins.
    pub fn start() -> Self {
        Self { start: Instant::now(), ended: Vec::with_capacity(6) }
    }

    /// The phase that runs was the one of this name, and ends; the next one begins.
    pub fn end(&mut self, name: &'static str) {
        self.ended.push((name, self.start.elapsed().as_secs_f64()));
        self.start = Instant::now();
    }

    /// Names and seconds.
    pub fn ended(self) -> Vec<(&'static str, f64)> {
        self.ended
    }
}

/// How a structure was built and what came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BuildReport {
    /// Names of phases and their seconds.
    pub phases: Vec<(&'static str, f64)>,
    /// Triangles given.
    pub triangles: usize,
    /// Inner nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Triangles of a leaf, on average.
    pub mean_leaf: f64,
    /// Depth of a leaf, on average; the root has depth 0.
    pub mean_depth: f64,
    /// Depth of the deepest leaf.
    pub max_depth: usize,
    /// Expected cost of a random ray through the root's box by the surface area heuristic, in the
    /// structure's own unit: not to be compared between trees of different kinds.
    pub sah_cost: f64,
}

impl BuildReport {
    /// Seconds in all.
    pub fn seconds(&self) -> f64 {
        self.phases.iter().map(|(_, seconds)| seconds).sum()
    }
}
