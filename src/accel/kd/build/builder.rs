//! From options to a tree.

use std::sync::Arc;
use std::time::Instant;

use super::arena::Arena;
use super::input::TreeInput;
use super::prune::Pruned;
use super::sah::Costs;
use super::{binned, lists, minmax, sweep};
use crate::accel::kd::tree::{Base, KdTree, Leaves, Node};
use crate::accel::{BuildError, BuildReport, Options, Steps};
use crate::geom::TriangleSource;
use crate::math::Aabb;

impl KdTree {
    /// Builds a tree by its options.
    ///
    /// # Errors
    /// If there are more nodes or blocks of triangles than can be numbered.
    pub fn build(
        source: &Arc<dyn TriangleSource>,
        options: &Options,
        steps: &Steps<'_>,
    ) -> Result<Self, BuildError> {
        let start = Instant::now();
        let input = TreeInput::new(&**source, options, steps);
        let arena = match options.choice("build") {
            "binned" => build_binned(&input),
            "minmax" => build_minmax(&input),
            _ => build_cheaper_of_sweep_and_minmax(&input),
        }
        .arena;
        let TreeInput { bounds, slack, limits, .. } = input;
        let built = Instant::now();
        let mut report = gather_statistics(&arena, &bounds, &limits.costs);
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

/// Builds nodes by bins of centroids, pruned.
pub fn build_binned(input: &TreeInput<'_>) -> Pruned {
    prune(lists::build(input, binned::find_best), input)
}

/// Builds nodes by bins with exact counts, pruned.
pub fn build_minmax(input: &TreeInput<'_>) -> Pruned {
    prune(lists::build(input, minmax::find_best), input)
}

/// Choices that are best one by one do not add up to the best tree: along rows of equal things the
/// sweep cuts slivers off, which a choice of fewer planes does not offer (a field of bunnies costs
/// 5.3 by the sweep and 4.6 by bins). So the coarse tree is built beside the exact one, in less
/// than half of its time, and the cheaper is kept.
fn build_cheaper_of_sweep_and_minmax(input: &TreeInput<'_>) -> Pruned {
    let (exact, coarse) = rayon::join(|| build_sweep(input), || build_minmax(input));
    exact.or_cheaper(coarse)
}

/// Builds nodes by the exact sweep, pruned.
pub fn build_sweep(input: &TreeInput<'_>) -> Pruned {
    prune(sweep::build(input), input)
}

fn prune(arena: Arena, input: &TreeInput<'_>) -> Pruned {
    Pruned::new(arena, &input.bounds, &input.limits.costs)
}

/// Nodes that layouts can number: two of 32 bits are needed for the axis.
const NODE_LIMIT: usize = 1 << 30;

fn gather_statistics(arena: &Arena, bounds: &Aabb, costs: &Costs) -> BuildReport {
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
