//! Options, and the rule when to stop.

use super::sah::{Costs, Plane};
use crate::accel::{OptionSpec, Options, Value, Values};

/// The options of all kd-trees that a builder reads.
pub const OPTIONS: [OptionSpec; 5] = [
    OptionSpec {
        name: "build",
        summary: "how planes are found; sah: by the exact sweep, or as minmax if that tree is \
                  cheaper",
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
/// So many triangles are enough for that.
const FORK_COUNT: usize = 1024;

/// Whether the children of a node of so many triangles are built at once.
pub fn forks(depth: usize, count: usize) -> bool {
    depth < FORK_LEVELS && count >= FORK_COUNT
}

/// What a builder reckons with, and when it stops.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// What the heuristic reckons with.
    pub costs: Costs,
    /// Deepest level of a leaf.
    pub depth: usize,
    /// Leaves of this many triangles are never divided.
    pub leaf: usize,
}

impl Limits {
    /// Reads the options, for so many triangles.
    pub fn new(options: &Options, triangles: usize) -> Self {
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
    /// [`super::prune`] takes back those that don't.
    pub fn stops(&self, count: usize, best: Option<&Plane>, failed: &mut u32) -> bool {
        let Some(best) = best else { return true };
        let leaf = self.costs.expected_cost(count);
        if best.cost > leaf {
            *failed += 1;
        }
        (best.cost > 4.0 * leaf && count < 16) || *failed == 3
    }
}
