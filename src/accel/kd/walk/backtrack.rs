//! Back up by parents to the first box that goes on, then down again.
//!
//! - T. Foley, J. Sugerman, "KD-tree acceleration structures for a GPU raytracer", 2005: boxes and
//!   parents in every node (section 5.1.1 and algorithm 3 of the review).
//! - V. Havran, J. Bittner, "Ray tracing with sparse boxes", 2007: in the nodes of every Nth level
//!   only; the last such node on the way down is kept, and the way up begins there (5.1.2).
//!
//! A box goes on if it is left strictly behind where the leaf was left, by the distances of its
//! planes. Ours cuts the span on the way down, as restart does, so that leaves need no box of
//! their own. Boxes at the rim are infinite.

use super::interface::Walk;
use super::visit::Visit;
use crate::accel::kd::layout::{Compact, Layout, Nodes, View};
use crate::accel::kd::ray::{Crossing, Span};
use crate::accel::kd::tree::KdTree;
use crate::accel::{Counters, Event, Query};
use crate::math::{Aabb, NodeId, smaller};

/// A node's box, the node, and the record of the next one above.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Record {
    cell: Aabb,
    node: NodeId,
    /// Itself for the root.
    parent: u32,
}

/// Which nodes have records.
pub trait Recorded: Send + Sync {
    /// `depths` are those of all nodes, `every` the levels from one recorded node to the next.
    fn new(depths: &[u8], every: usize) -> Self;

    /// The number of a node's record, if it has one.
    fn record(&self, at: NodeId) -> Option<usize>;

    /// Bytes.
    fn bytes(&self) -> usize;
}

/// All.
#[derive(Debug)]
pub struct EveryNode;

impl Recorded for EveryNode {
    fn new(_: &[u8], _: usize) -> Self {
        Self
    }

    #[inline(always)]
    fn record(&self, at: NodeId) -> Option<usize> {
        Some(at.index())
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Those of every Nth level: a bit for each node, and how many bits are set before each word.
#[derive(Debug)]
pub struct EveryNth {
    words: Vec<(u64, u32)>,
}

impl Recorded for EveryNth {
    fn new(depths: &[u8], every: usize) -> Self {
        let mut before = 0;
        let word = |depths: &[u8]| {
            let bits = depths.iter().enumerate().fold(0_u64, |bits, (i, &depth)| {
                bits | (u64::from((depth as usize).is_multiple_of(every)) << i)
            });
            let word = (bits, before);
            before += bits.count_ones();
            word
        };
        Self { words: depths.chunks(64).map(word).collect() }
    }

    #[inline(always)]
    fn record(&self, at: NodeId) -> Option<usize> {
        let (bits, before) = self.words[at.index() / 64];
        let bit = 1_u64 << (at.0 % 64);
        (bits & bit != 0).then(|| before as usize + (bits & (bit - 1)).count_ones() as usize)
    }

    fn bytes(&self) -> usize {
        size_of_val(&*self.words)
    }
}

/// Walks by boxes and parents.
#[derive(Debug)]
pub struct Backtrack<R> {
    layout: Compact,
    recorded: R,
    records: Vec<Record>,
}

impl<R: Recorded> Backtrack<R> {
    /// Derives boxes and parents from a tree, for the nodes of every `every`th level.
    pub fn new(tree: &KdTree, every: usize) -> Self {
        let mut depths = vec![0; tree.nodes.len()];
        tree.for_each_cell(KdTree::SPACE, |at, _, depth| depths[at.index()] = depth as u8);
        let recorded = R::new(&depths, every);
        let mut records: Vec<Record> = Vec::new();
        // The records on the way from the root to the node that is visited, with their depths.
        let mut way: Vec<(usize, u32)> = Vec::new();
        tree.for_each_cell(KdTree::SPACE, |at, cell, depth| {
            if recorded.record(at).is_some() {
                while way.last().is_some_and(|&(above, _)| above >= depth) {
                    way.pop();
                }
                let this = records.len() as u32;
                let parent = way.last().map_or(this, |&(_, record)| record);
                records.push(Record { cell: *cell, node: at, parent });
                way.push((depth, this));
            }
        });
        Self { layout: Compact::new(tree), recorded, records }
    }
}

impl<R: Recorded> Walk for Backtrack<R> {
    type Scratch = ();

    fn nodes(&self) -> &dyn Nodes {
        &self.layout
    }

    fn scratch(&self) {}

    #[inline(never)]
    fn walk<Q: Query, C: Counters>(&self, visit: &mut Visit<'_, Q, C>, span: Span, (): &mut ()) {
        let ray = visit.kd_ray;
        let end = span.exit;
        let mut enter = span.enter;
        let mut record = 0;
        loop {
            let (mut at, mut span) = loop {
                let Record { cell, node, parent } = &self.records[record];
                visit.counters.count(Event::BoxTest);
                let (exit, _) = ray.exit(cell);
                if exit > enter || record == 0 {
                    break (*node, Span { enter, exit: smaller(exit, end) });
                }
                record = *parent as usize;
            };
            let leaf = loop {
                let (axis, split, children) = match self.layout.view(at) {
                    View::Inner { axis, split, children } => (axis, split, children),
                    View::Leaf(leaf) => break leaf,
                };
                visit.counters.count(Event::InnerNode);
                let t_split = ray.t_split(axis, split);
                let near = ray.near(axis);
                match Crossing::of(t_split, span) {
                    Crossing::Far => at = children[1 - near],
                    Crossing::Near => at = children[near],
                    Crossing::Both => (at, span.exit) = (children[near], t_split),
                }
                if let Some(lower) = self.recorded.record(at) {
                    record = lower;
                }
            };
            if visit.ends_in_leaf(leaf, span.exit) || span.exit >= end {
                return;
            }
            visit.counters.count(Event::Restart);
            enter = span.exit;
        }
    }

    fn memory(&self) -> Vec<(&'static str, usize)> {
        vec![("boxes", size_of_val(&*self.records) + self.recorded.bytes())]
    }
}
