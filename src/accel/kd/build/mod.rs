//! Builds: where to split, when to stop. They know nothing of layouts and traversals.
//!
//! All of them go top-down by the surface area heuristic (MacDonald and Booth 1990; Wald and
//! Havran, "On building fast kd-trees for ray tracing, and on doing that in O(N log N)", 2006)
//! and share the costs, the rule when to stop and the recursion over parts of a tree. They give
//! the same tree on any number of threads: what runs in parallel depends on sizes only.
//!
//! `sah` builds two trees, by `sweep` and by `minmax`, and keeps the cheaper.

mod arena;
mod binned;
mod bins;
mod lists;
mod minmax;
mod prune;
mod sah;
mod sweep;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

pub use arena::Arena;
use prune::Pruned;
pub use sah::{Costs, Plane};

use super::slack::{Slack, bounds_of};
use super::tree::{Base, KdTree, Leaves, Node};
use crate::accel::{BuildError, BuildReport, OptionSpec, Options, Value, Values};
use crate::geom::TriangleSource;
use crate::math::{Aabb, TriangleId};

/// The options of all kd-trees that a builder reads.
pub const OPTIONS: [OptionSpec; 5] = [
    OptionSpec {
        name: "build",
        summary: "how planes are found; sah: by the exact sweep, or as minmax if that tree is cheaper",
        values: Values::Choice(&["sah", "minmax", "binned"]),
        default: Value::Choice("sah"),
    },
    OptionSpec {
        name: "cost",
        summary: "cost of testing a triangle in steps down the tree, for the heuristic",
        values: Values::Number(0.01, 100.0),
        default: Value::Number(0.3),
    },
    OptionSpec {
        name: "empty",
        summary: "share of the cost that cutting off empty space is worth",
        values: Values::Number(0.0, 0.9),
        default: Value::Number(0.1),
    },
    OptionSpec {
        name: "depth",
        summary: "levels of the tree at most; 0: 8 + 1.3 log2 of the triangles",
        values: Values::Integer(0, 60),
        default: Value::Integer(0),
    },
    OptionSpec {
        name: "leaf",
        summary: "triangles of a leaf that is never divided; four are tested at once",
        values: Values::Integer(1, 64),
        default: Value::Integer(4),
    },
];

/// Children are built at once down to this level, if there are enough triangles.
const FORK_LEVELS: usize = 8;
const FORK_COUNT: usize = 1024;

/// What a builder needs to know.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// What the heuristic reckons with.
    pub costs: Costs,
    /// Deepest level of a leaf.
    pub depth: usize,
    /// Leaves of this many triangles are never divided.
    pub leaf: usize,
}

impl Settings {
    fn new(options: &Options, triangles: usize) -> Self {
        let depth = match options.integer("depth") {
            0 => 8 + (1.3 * libm::log2(triangles.max(1) as f64)) as usize,
            depth => depth as usize,
        };
        Self {
            costs: Costs {
                traversal_cost: 1.0,
                intersection_cost: options.number("cost"),
                empty_bonus: options.number("empty"),
            },
            depth: depth.min(60),
            leaf: options.integer("leaf") as usize,
        }
    }

    /// Whether a node is to be a leaf, given the best plane. `failed` counts the splits on the way
    /// down that did not pay by themselves: some are allowed, since the greedy choice does not see
    /// that two splits pay together (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4.4.2).
    /// [`prune`] takes back those that don't.
    fn stops(&self, count: usize, best: Option<&Plane>, failed: &mut u32) -> bool {
        let Some(best) = best else { return true };
        let leaf = self.costs.expected_cost(count);
        if best.cost > leaf {
            *failed += 1;
        }
        (best.cost > 4.0 * leaf && count < 16) || *failed == 3
    }
}

impl KdTree {
    /// Builds a tree by its options.
    ///
    /// # Errors
    /// If there are more nodes or blocks of triangles than can be numbered.
    pub fn build(source: &Arc<dyn TriangleSource>, options: &Options) -> Result<Self, BuildError> {
        let start = Instant::now();
        let nodes = Nodes::new(&**source, options);
        let arena = match options.choice("build") {
            "binned" => nodes.binned(),
            "minmax" => nodes.minmax(),
            _ => nodes.cheaper_of_sweep_and_minmax(),
        }
        .arena;
        let Nodes { bounds, slack, settings, .. } = nodes;
        let built = Instant::now();
        let mut report = statistics(&arena, &bounds, &settings.costs);
        let references = arena.ids.len();
        let leaves = Leaves::new(&**source, arena.ids, &arena.ends)
            .filter(|_| arena.nodes.len() < NODE_LIMIT)
            .ok_or(BuildError::TooLarge {
                needed: (arena.nodes.len() * 8 + references * 4) as u64,
                limit: NODE_LIMIT as u64 * 8,
            })?;
        let base = Base { bounds, slack, leaves, source: Arc::clone(source) };
        report.triangles = source.len();
        report.phases = vec![
            ("tree", (built - start).as_secs_f64()),
            ("leaves", built.elapsed().as_secs_f64()),
        ];
        Ok(Self { nodes: arena.nodes, base: Arc::new(base), report })
    }

    /// The depth of the deepest leaf.
    pub fn depth(&self) -> usize {
        self.report.max_depth
    }
}

/// Builds nodes, pruned.
struct Nodes<'a> {
    source: &'a dyn TriangleSource,
    bounds: Aabb,
    slack: Slack,
    settings: Settings,
}

impl<'a> Nodes<'a> {
    fn new(source: &'a dyn TriangleSource, options: &Options) -> Self {
        let own = bounds_of(source);
        let mut settings = Settings::new(options, source.len());
        let slack = Slack::new(&own).unwrap_or_else(|| {
            settings.depth = 0;
            Slack::NONE
        });
        Self { source, bounds: slack.grow(&own), slack, settings }
    }

    fn binned(&self) -> Pruned {
        self.pruned(lists::build(self, binned::best))
    }

    fn minmax(&self) -> Pruned {
        self.pruned(lists::build(self, minmax::best))
    }

    /// Choices that are best one by one do not add up to the best tree: along rows of equal things
    /// the sweep cuts slivers off, which a choice of fewer planes does not offer (a field of
    /// bunnies costs 5.3 by the sweep and 4.6 by bins). So the coarse tree is built beside the
    /// exact one, in less than half of its time, and the cheaper is kept.
    fn cheaper_of_sweep_and_minmax(&self) -> Pruned {
        let sweep = || self.pruned(sweep::build(self));
        let (exact, coarse) = rayon::join(sweep, || self.minmax());
        exact.or_cheaper(coarse)
    }

    fn pruned(&self, arena: Arena) -> Pruned {
        Pruned::new(arena, &self.bounds, &self.settings.costs)
    }

    /// All triangles with their boxes, in order.
    fn references(&self) -> Vec<Reference> {
        let reference = |i| {
            let id = TriangleId::from_index(i);
            let bounds = self.source.triangle(id).bounds();
            Reference { bounds: self.slack.grow(&bounds), id }
        };
        (0..self.source.len()).into_par_iter().map(reference).collect()
    }
}

/// Nodes that layouts can number: two of 32 bits are needed for the axis.
const NODE_LIMIT: usize = 1 << 30;

fn statistics(arena: &Arena, bounds: &Aabb, costs: &Costs) -> BuildReport {
    let mut report = BuildReport::default();
    let mut leaf_depths = 0;
    let root_area = bounds.half_area().max(f64::MIN_POSITIVE);
    arena.for_each_cell(*bounds, |node, cell, depth| {
        // Where coordinates are so large that areas overflow, there is nothing but the root.
        let area = if root_area.is_finite() { cell.half_area() / root_area } else { 1.0 };
        match node {
            Node::Inner { .. } => {
                report.nodes += 1;
                report.sah_cost += area * costs.traversal_cost;
            }
            Node::Leaf(leaf) => {
                report.leaves += 1;
                leaf_depths += depth;
                report.max_depth = report.max_depth.max(depth);
                report.sah_cost += area * costs.leaf_cost(arena.list(leaf).len());
            }
        }
    });
    report.mean_leaf = arena.ids.len() as f64 / report.leaves as f64;
    report.mean_depth = leaf_depths as f64 / report.leaves as f64;
    report
}

/// A triangle's box, grown by the slack.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// The box.
    pub bounds: Aabb,
    /// The triangle.
    pub id: TriangleId,
}
