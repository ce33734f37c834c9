//! The longest common traversal sequence: leaves that all rays of a packet come to in one order.
//!
//! V. Havran and J. Bittner, "LCTS: ray shooting using longest common traversal sequences", 2000;
//! K. Dmitriev, V. Havran and H.-P. Seidel, "Faster ray tracing with SIMD shaft culling", 2004;
//! sections 4.1 and 4.3 of the review.
//!
//! The four corners of the packet's cone go through the tree side by side. As long as each node is
//! crossed by all in the same manner, and surely ([`super::cone`]), so it is by all rays, and the
//! rays themselves need not be asked: they are tested in the leaves, one leaf after the other,
//! empty ones passed by. Where corners differ the common sequence ends, and the packet walks on
//! from there by itself, with what the corners put aside.
//!
//! A termination object, one that all corners hit, would end the sequence of leaves. Ours ends when
//! every ray has been hit, strictly before the leaf's end: each ray needs the triangle's exact test
//! for itself in any case, and then it is known, for any object, convex or not. Since leaves are
//! tested as they come, nothing that lies before it can be missed.
//!
//! Why no ray misses a leaf: a plane is surely before or behind the span of all rays, or surely
//! within, so each ray would have chosen the same by itself. Spans of the sequence begin at zero
//! and never end, where a ray's own begin in the root's box: so a ray may be tested in leaves in
//! front of that, or behind its end, which does no harm.

use fearless_simd::{Simd, SimdBase};

use super::cone::{Cone, Distances, is_surely_before};
use super::front_to_back::{At, Todo};
use super::leaf::Packet;
use super::spans::{Bundles, Spans, end_rays, iter_bundles, load};
use crate::accel::kd::layout::{Nodes, View};
use crate::accel::kd::tree::LeafId;
use crate::accel::kd::walk::todo::LEVELS;
use crate::accel::packet::PacketRays;
use crate::accel::{Counters, Event, Query};
use crate::math::NodeId;
use crate::simd::baseline;

/// A plane by which a cell is entered or left; none at the rim.
type Face = Option<(usize, f32)>;

/// Follows the corners as far as they go together. What is left is to be done by a walk.
#[inline(never)]
pub fn follow<Q: Query, C: Counters>(
    packet: &mut Packet<'_, Q, C>,
    (cone, culls): (&Cone, bool),
    spans: &mut Spans,
    todo: &mut Todo,
) {
    let simd = baseline();
    let all = spans.begin(simd, packet.rays, &packet.base.bounds);
    if all == 0 {
        return;
    }
    // Where rays end is kept in level 0, the leaf at hand is in level 1.
    let negative = packet.rays.heading(0).negative;
    let mut pending = [(NodeId::NONE, None, [0.0; 4]); LEVELS];
    let mut waiting = 0;
    let (mut node, mut entry, mut exit): (NodeId, Face, Face) = (packet.nodes.root(), None, None);
    let (mut enter_at, mut exit_at): (Distances, Distances) = ([0.0; 4], [f32::INFINITY; 4]);
    loop {
        let leaf = loop {
            let (axis, split, children) = match packet.nodes.view(node) {
                View::Inner { axis, split, children } => (axis, split, children),
                View::Leaf(leaf) => break leaf,
            };
            packet.counters.count(Event::InnerNode);
            let (t, near) = (cone.distances(axis, split), negative[axis]);
            if is_surely_before(&t, &enter_at) {
                node = children[1 - near];
            } else if is_surely_before(&exit_at, &t) {
                node = children[near];
            } else if is_surely_before(&enter_at, &t) && is_surely_before(&t, &exit_at) {
                packet.counters.count(Event::Push);
                pending[waiting & (LEVELS - 1)] = (children[1 - near], exit, exit_at);
                waiting += 1;
                (node, exit, exit_at) = (children[near], Some((axis, split)), t);
            } else {
                pending[waiting & (LEVELS - 1)] = (node, exit, exit_at);
                begin_at(simd, entry, all, packet.rays, spans);
                let left = pending[..=waiting & (LEVELS - 1)].iter();
                hand_over(left.map(|&(node, exit, _)| (node, exit)), all, spans, todo);
                return;
            }
        };
        if leaf.is_empty() {
            packet.counters.count(Event::Leaf);
        } else {
            begin_at(simd, entry, all, packet.rays, spans);
            end_at(simd, exit, all, 1, spans);
            if ends_in_leaf(simd, packet, (leaf, culls.then_some(cone)), all, spans) {
                return;
            }
        }
        if waiting == 0 {
            return;
        }
        waiting -= 1;
        (entry, enter_at) = (exit, exit_at);
        (node, exit, exit_at) = pending[waiting & (LEVELS - 1)];
    }
}

/// Tests a leaf, whose spans are in level 1; true if every ray has ended.
#[inline(always)]
fn ends_in_leaf<S: Simd, Q: Query, C: Counters>(
    simd: S,
    packet: &mut Packet<'_, Q, C>,
    (leaf, cone): (LeafId, Option<&Cone>),
    all: Bundles,
    spans: &mut Spans,
) -> bool {
    let crossing = spans.find_crossing(simd, all, 1);
    packet.test_leaf(leaf, cone, crossing, &mut spans.entered);
    spans.leave(simd, packet.rays, crossing, 1);
    spans.find_crossing(simd, all, 0) == 0
}

/// Begins the spans of all levels at a plane.
#[inline(always)]
fn begin_at<S: Simd>(simd: S, entry: Face, bundles: Bundles, rays: &PacketRays, spans: &mut Spans) {
    let Some((axis, split)) = entry else { return };
    for number in iter_bundles(bundles) {
        let enter = load(simd, &spans.enter[number]);
        let come = enter.max(spans.t_split(simd, number, axis, split));
        spans.enter[number] = end_rays(simd, rays, number, come).to_array();
    }
}

/// Ends the spans of a level by a plane.
#[inline(always)]
fn end_at<S: Simd>(simd: S, exit: Face, bundles: Bundles, level: usize, spans: &mut Spans) {
    for number in iter_bundles(bundles) {
        let end = load(simd, &spans.exit[0][number]);
        let end = match exit {
            Some((axis, split)) => end.min(spans.t_split(simd, number, axis, split)),
            None => end,
        };
        spans.exit[level][number] = end.to_array();
    }
}

/// Leaves nodes to a walk, those that come last first.
fn hand_over(
    nodes: impl Iterator<Item = (NodeId, Face)>,
    all: Bundles,
    spans: &mut Spans,
    todo: &mut Todo,
) {
    for (i, (node, exit)) in nodes.enumerate() {
        // Level 0 stays as it is: all others are made from it.
        let level = if exit.is_none() { 0 } else { i + 1 };
        if exit.is_some() {
            end_at(baseline(), exit, all, level, spans);
        }
        todo.push(At::Node(node), all, level);
    }
}
