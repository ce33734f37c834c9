//! The walk of a packet whose rays all head the same way: front to back, as a single ray's.
//!
//! It begins at the root, at a cell, or in a tree of branches, where each side brings its own cell,
//! or goes on where another walk left off.

use super::cells::Cell;
use super::leaf::Packet;
use super::spans::{Bundles, Spans};
use crate::accel::kd::layout::{Nodes, View};
use crate::accel::kd::walk::todo::LEVELS;
use crate::accel::narrowing::{Branches, Step};
use crate::accel::{Counters, Event, Query};
use crate::math::NodeId;
use crate::simd::baseline;

/// Where a walk goes on.
#[derive(Clone, Copy)]
pub enum At {
    /// At a node whose spans are known.
    Node(NodeId),
    /// In another cell, that spans must be narrowed to.
    Cell(Step<Cell>),
}

/// Nodes for later, each with the bundles that may cross it and the level of its spans.
pub struct Todo {
    entries: Box<[(At, Bundles, usize); LEVELS]>,
    len: usize,
}

impl Default for Todo {
    fn default() -> Self {
        Self { entries: Box::new([(At::Node(NodeId::NONE), 0, 0); LEVELS]), len: 0 }
    }
}

impl Todo {
    /// Drops all entries.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Keeps a node.
    #[inline(always)]
    pub fn push(&mut self, at: At, bundles: Bundles, level: usize) {
        self.entries[self.len & (LEVELS - 1)] = (at, bundles, level);
        self.len += 1;
    }

    /// The node that was kept last.
    #[inline(always)]
    fn pop(&mut self) -> Option<(At, Bundles, usize)> {
        self.len = self.len.checked_sub(1)?;
        Some(self.entries[self.len & (LEVELS - 1)])
    }
}

/// Walks what is to be done.
#[inline(never)]
pub fn walk<Q: Query, C: Counters>(
    packet: &mut Packet<'_, Q, C>,
    branches: Branches<'_, Cell>,
    spans: &mut Spans,
    todo: &mut Todo,
) {
    let simd = baseline();
    let negative = packet.rays.heading(0).negative;
    while let Some((mut at, bundles, mut level)) = todo.pop() {
        let mut bundles = spans.find_crossing(simd, bundles, level);
        // Down the branches.
        let mut node = loop {
            let step = match at {
                At::Node(node) => break node,
                At::Cell(step) => step,
            };
            bundles = spans.clip(simd, (&step.place.bounds, negative), bundles, level);
            if bundles == 0 || step.is_plain() {
                break step.place.node;
            }
            let View::Inner { axis, .. } = packet.nodes.view(step.place.node) else {
                break step.place.node;
            };
            packet.counters.count(Event::InnerNode);
            packet.counters.count(Event::Push);
            let (sides, near) = (branches.sides(step), negative[axis]);
            todo.push(At::Cell(sides[1 - near]), bundles, level);
            spans.keep_all(bundles, level);
            (at, level) = (At::Cell(sides[near]), level + 1);
        };
        if bundles == 0 {
            continue;
        }
        // Down the tree.
        let leaf = loop {
            let (axis, split, children) = match packet.nodes.view(node) {
                View::Inner { axis, split, children } => (axis, split, children),
                View::Leaf(leaf) => break leaf,
            };
            packet.counters.count(Event::InnerNode);
            let near = negative[axis];
            let (into_near, into_far) = spans.split(simd, (axis, split), bundles, level);
            if into_near == 0 {
                (node, bundles) = (children[1 - near], into_far);
                continue;
            }
            (node, bundles) = (children[near], into_near);
            if into_far != 0 {
                packet.counters.count(Event::Push);
                todo.push(At::Node(children[1 - near]), into_far, level);
                spans.keep_near(simd, into_near, level);
                level += 1;
            }
        };
        let bundles = spans.find_crossing(simd, bundles, level);
        packet.test_leaf(leaf, None, bundles, &mut spans.entered);
        spans.leave(simd, packet.rays, bundles, level);
    }
}
