//! The walk of a packet by links between neighbouring nodes.
//!
//! S. Popov et al., "Stackless kd-tree traversal for high performance GPU ray tracing", 2007;
//! section 5.3 of the review. A link is not pushed down to the leaves behind a face, but leads to
//! the root of all that is behind it: the sibling of the leaf's parent, grandparent and so on.
//! Where only some rays of a packet enter a child, the others are put to rest until the packet
//! comes to its sibling; and there those join them that left the child by a link: the packet
//! regroups.
//!
//! Nothing is kept but, for each ray, how far it has come, where its span ends and the depth of the
//! node that it waits at. All that wait at one depth wait at the same node, the far sibling of an
//! ancestor of the leaf at hand: so nodes are remembered once for the packet. The deepest is the
//! first along the rays: no leaf is visited twice, and all rays come to all of theirs.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x8, mask32x8};

use super::leaf::Packet;
use super::spans::{Bundles, PerRay, Spans, any_lane, iter_bundles, load};
use crate::accel::kd::layout::{Nodes, View};
use crate::accel::kd::ropes::PacketRopes;
use crate::accel::kd::tree::LeafId;
use crate::accel::kd::walk::todo::LEVELS;
use crate::accel::packet::BUNDLES;
use crate::accel::{Counters, Event, Query};
use crate::geom::RayBundle;
use crate::math::NodeId;
use crate::simd::baseline;

/// Depth of rays that are under way.
const HERE: f32 = 1e3;
/// Depth of rays that have ended.
const NOWHERE: f32 = -1.0;

/// What rays wait for.
pub struct Waiting {
    /// Depths of the nodes that rays wait at.
    depths: Box<[PerRay; BUNDLES]>,
    /// By depth.
    nodes: [NodeId; LEVELS],
}

impl Default for Waiting {
    fn default() -> Self {
        let depths = Box::new([[NOWHERE; RayBundle::LANES]; BUNDLES]);
        Self { depths, nodes: [NodeId::NONE; LEVELS] }
    }
}

impl Waiting {
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, bundle: usize) -> f32x8<S> {
        load(simd, &self.depths[bundle])
    }

    /// The greatest depth at which rays wait.
    #[inline(always)]
    fn find_deepest<S: Simd>(&self, simd: S, bundles: Bundles) -> f32 {
        let mut deepest = f32x8::splat(simd, NOWHERE);
        for bundle in iter_bundles(bundles) {
            deepest = deepest.max(self.at(simd, bundle));
        }
        deepest.to_array().into_iter().fold(NOWHERE, f32::max)
    }

    /// Notes a node that rays are to wait at, by its depth.
    #[inline(always)]
    fn note_node(&mut self, ropes: &PacketRopes, node: NodeId) -> f32 {
        if node == NodeId::NONE {
            return NOWHERE;
        }
        let depth = ropes.depth(node);
        self.nodes[depth & (LEVELS - 1)] = node;
        depth as f32
    }

    /// Sets rays of a bundle to wait at a depth.
    #[inline(always)]
    fn put<S: Simd>(&mut self, simd: S, bundle: usize, rays: mask32x8<S>, depth: f32x8<S>) {
        self.depths[bundle] = rays.select(depth, self.at(simd, bundle)).to_array();
    }
}

/// Walks from the root.
#[inline(never)]
pub fn walk<Q: Query, C: Counters>(
    packet: &mut Packet<'_, Q, C>,
    ropes: &PacketRopes,
    spans: &mut Spans,
    waiting: &mut Waiting,
) {
    let simd = baseline();
    let negative = packet.rays.heading(0).negative;
    let all = spans.begin(simd, packet.rays, &packet.base.bounds);
    waiting.nodes[0] = packet.nodes.root();
    for bundle in iter_bundles(all) {
        let live = load(simd, &spans.enter[bundle]).simd_lt(f32::INFINITY);
        let root = live.select(f32x8::splat(simd, 0.0), f32x8::splat(simd, NOWHERE));
        waiting.depths[bundle] = root.to_array();
    }
    loop {
        let deepest = waiting.find_deepest(simd, all);
        if deepest < 0.0 {
            return;
        }
        // Wake those that wait here.
        let (mut depth, mut bundles) = (deepest as usize, 0);
        for bundle in iter_bundles(all) {
            let woken = waiting.at(simd, bundle).simd_eq(deepest);
            waiting.put(simd, bundle, woken, f32x8::splat(simd, HERE));
            bundles |= u64::from(any_lane(woken)) << bundle;
        }
        let mut node = waiting.nodes[depth & (LEVELS - 1)];
        let leaf = loop {
            let (axis, split, children) = match packet.nodes.view(node) {
                View::Inner { axis, split, children } => (axis, split, children),
                View::Leaf(leaf) => break leaf,
            };
            packet.counters.count(Event::InnerNode);
            depth += 1;
            let (near, far) = find_sides(simd, (axis, split), bundles, spans, waiting);
            if near == 0 {
                node = children[1 - negative[axis]];
                continue;
            }
            node = children[negative[axis]];
            if far != 0 {
                packet.counters.count(Event::Push);
                put_to_rest(simd, (axis, split), far, depth, spans, waiting);
                waiting.nodes[depth & (LEVELS - 1)] = children[1 - negative[axis]];
                bundles = near;
            }
        };
        visit(simd, packet, ropes, (leaf, negative, bundles), spans, waiting);
    }
}

/// Which bundles have rays that are in front of a plane, and which behind it.
#[inline(always)]
fn find_sides<S: Simd>(
    simd: S,
    (axis, split): (usize, f32),
    bundles: Bundles,
    spans: &Spans,
    waiting: &Waiting,
) -> (Bundles, Bundles) {
    let (mut near, mut far) = (0, 0);
    for bundle in iter_bundles(bundles) {
        let here = waiting.at(simd, bundle).simd_eq(HERE);
        let t = spans.t_split(simd, bundle, axis, split);
        let behind = t.simd_le(load(simd, &spans.enter[bundle]));
        near |= u64::from(any_lane(here & !behind)) << bundle;
        far |= u64::from(any_lane(here & behind)) << bundle;
    }
    (near, far)
}

/// Puts rays behind a plane to rest.
#[inline(always)]
fn put_to_rest<S: Simd>(
    simd: S,
    (axis, split): (usize, f32),
    bundles: Bundles,
    depth: usize,
    spans: &Spans,
    waiting: &mut Waiting,
) {
    for bundle in iter_bundles(bundles) {
        let here = waiting.at(simd, bundle).simd_eq(HERE);
        let t = spans.t_split(simd, bundle, axis, split);
        let behind = here & t.simd_le(load(simd, &spans.enter[bundle]));
        waiting.put(simd, bundle, behind, f32x8::splat(simd, depth as f32));
    }
}

/// Tests a leaf, and follows its links.
#[inline(always)]
fn visit<S: Simd, Q: Query, C: Counters>(
    simd: S,
    packet: &mut Packet<'_, Q, C>,
    ropes: &PacketRopes,
    (leaf, negative, bundles): (LeafId, [usize; 3], Bundles),
    spans: &mut Spans,
    waiting: &mut Waiting,
) {
    let cell = ropes.cell(leaf);
    let links = [0, 1, 2]
        .map(|axis| waiting.note_node(ropes, ropes.behind(leaf, axis, 1 - negative[axis])));
    let mut entered = 0;
    for bundle in iter_bundles(bundles) {
        let here = waiting.at(simd, bundle).simd_eq(HERE);
        let far = |axis: usize| {
            if negative[axis] == 0 { cell.max[axis] } else { cell.min[axis] }
        };
        let mut exit = spans.t_split(simd, bundle, 0, far(0));
        let mut next = f32x8::splat(simd, links[0]);
        for axis in 1..3 {
            let t = spans.t_split(simd, bundle, axis, far(axis));
            let first = t.simd_lt(exit);
            exit = first.select(t, exit);
            next = first.select(f32x8::splat(simd, links[axis]), next);
        }
        let enters = here & load(simd, &spans.enter[bundle]).simd_lt(exit);
        spans.entered[bundle] = enters.to_bitmask() as u8;
        entered |= u64::from(any_lane(enters)) << bundle;
        spans.exit[1][bundle] = exit.to_array();
        waiting.put(simd, bundle, here, next);
    }
    // Rays that end are struck off in there.
    packet.test_leaf(leaf, None, entered, &mut spans.entered.clone());
    for bundle in iter_bundles(bundles) {
        let enter = load(simd, &spans.enter[bundle]);
        let mask = mask32x8::from_bitmask(simd, u64::from(spans.entered[bundle]));
        let exit = mask.select(load(simd, &spans.exit[1][bundle]), enter);
        let [_, t_max] = packet.rays.bundle(bundle).spans(simd);
        let over = mask & (t_max.simd_lt(exit) | exit.simd_ge(load(simd, &spans.exit[0][bundle])));
        waiting.put(simd, bundle, over, f32x8::splat(simd, NOWHERE));
        spans.enter[bundle] = exit.to_array();
    }
}
