//! The walk of a packet whose rays head any way: omnidirectional traversal.
//!
//! A. Reshetov, "Omnidirectional ray tracing traversal algorithm for kd-trees", 2006; J. A. Tsakok,
//! W. Bishop and A. Kennings, "kd-tree traversal techniques", 2008; section 4.7 of the review.
//!
//! What is near for one ray is far for another. So a node's children are visited in the order that
//! suits most, each ray carries both ends of its span along, and a hit ends nothing: it only closes
//! cells behind it. A ray crosses a cell if it enters before it leaves, and not behind its hit.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x8, mask32x8};

use super::leaf::Packet;
use super::spans::{Bundles, PerRay, Spans, any_lane, iter_bundles, load};
use crate::accel::kd::layout::{Nodes, View};
use crate::accel::kd::walk::todo::LEVELS;
use crate::accel::packet::{BUNDLES, PacketRays};
use crate::accel::{Counters, Event, Query};
use crate::geom::RayBundle;
use crate::math::NodeId;
use crate::simd::baseline;

/// How near children are told from far ones, ray by ray.
pub trait Classify {
    /// Where a bundle's rays meet a plane, and for which of them the child above it is the near
    /// one.
    fn classify<S: Simd>(
        simd: S,
        spans: &Spans,
        rays: &PacketRays,
        bundle: usize,
        plane: (usize, f32),
    ) -> (f32x8<S>, mask32x8<S>);
}

/// By the ray's direction (Reshetov 2006).
pub struct ByDirection;

impl Classify for ByDirection {
    #[inline(always)]
    fn classify<S: Simd>(
        simd: S,
        spans: &Spans,
        rays: &PacketRays,
        bundle: usize,
        (axis, split): (usize, f32),
    ) -> (f32x8<S>, mask32x8<S>) {
        let down = rays.heading(bundle).negative[axis] != 0;
        (spans.t_split(simd, bundle, axis, split), mask32x8::splat(simd, down))
    }
}

/// By the ray's origin (Tsakok et al. 2008): rays from one point all have the same near child,
/// whichever way they go. A plane behind the origin is infinitely far away. Zeros are told as
/// single rays do ([`super::super::walk::front_to_back::ByOrigin`]).
pub struct ByOrigin;

impl Classify for ByOrigin {
    #[inline(always)]
    fn classify<S: Simd>(
        simd: S,
        spans: &Spans,
        _: &PacketRays,
        bundle: usize,
        (axis, split): (usize, f32),
    ) -> (f32x8<S>, mask32x8<S>) {
        let t = spans.t_split(simd, bundle, axis, split);
        // One over a zero has its sign.
        let behind = t.simd_lt(0.0) | (t.simd_eq(0.0) & (f32x8::splat(simd, 1.0) / t).simd_lt(0.0));
        let t = behind.select(f32x8::splat(simd, f32::INFINITY), t);
        (t, spans.origin(simd, bundle, axis).simd_gt(split))
    }
}

/// What is put aside, and where rays enter the cells of each level.
pub struct Todo {
    entries: Box<[(NodeId, Bundles, usize); LEVELS]>,
    enter: Box<[[PerRay; BUNDLES]]>,
}

impl Default for Todo {
    fn default() -> Self {
        Self {
            entries: Box::new([(NodeId::NONE, 0, 0); LEVELS]),
            enter: vec![[[0.0; RayBundle::LANES]; BUNDLES]; LEVELS + 1].into_boxed_slice(),
        }
    }
}

/// The spans of a bundle in the children below and above a plane.
#[inline(always)]
fn split_spans<S: Simd, K: Classify>(
    simd: S,
    (spans, todo, rays): (&Spans, &Todo, &PacketRays),
    bundle: usize,
    plane: (usize, f32),
    level: usize,
) -> ([[f32x8<S>; 2]; 2], mask32x8<S>) {
    let (t, above_is_near) = K::classify(simd, spans, rays, bundle, plane);
    let enter = load(simd, &todo.enter[level][bundle]);
    let exit = load(simd, &spans.exit[level][bundle]);
    let (first, last) = (t.min(exit), enter.max(t));
    let below = [above_is_near.select(last, enter), above_is_near.select(exit, first)];
    let above = [above_is_near.select(enter, last), above_is_near.select(first, exit)];
    ([below, above], above_is_near)
}

/// Which bundles have rays that cross the child below a plane, and which the one above; and which
/// child comes first: the only one that any cross, or the nearer one of most.
#[inline(always)]
fn find_crossed_sides<S: Simd, K: Classify>(
    simd: S,
    state: (&Spans, &Todo, &PacketRays),
    bundles: Bundles,
    plane: (usize, f32),
    level: usize,
) -> ([Bundles; 2], usize) {
    let (mut into, mut votes) = ([0; 2], 0);
    for bundle in iter_bundles(bundles) {
        let (sides, above_is_near) = split_spans::<_, K>(simd, state, bundle, plane, level);
        for (into, [enter, exit]) in into.iter_mut().zip(sides) {
            *into |= u64::from(any_lane(enter.simd_lt(exit))) << bundle;
        }
        let above = above_is_near.to_bitmask().count_ones() as i32;
        votes += RayBundle::LANES as i32 - 2 * above;
    }
    let first = match into {
        [0, _] => 1,
        [_, 0] => 0,
        _ => usize::from(votes < 0),
    };
    (into, first)
}

/// Walks from the root.
#[inline(never)]
pub fn walk<K: Classify, Q: Query, C: Counters>(
    packet: &mut Packet<'_, Q, C>,
    spans: &mut Spans,
    todo: &mut Todo,
) {
    let simd = baseline();
    let all = spans.begin(simd, packet.rays, &packet.base.bounds);
    todo.enter[0] = *spans.enter;
    todo.entries[0] = (packet.nodes.root(), all, 0);
    let mut pending = 1;
    while pending > 0 {
        pending -= 1;
        let (mut node, bundles, mut level) = todo.entries[pending & (LEVELS - 1)];
        let mut bundles = find_crossing(simd, packet.rays, spans, todo, bundles, level);
        if bundles == 0 {
            continue;
        }
        let leaf = loop {
            let (plane, children) = match packet.nodes.view(node) {
                View::Inner { axis, split, children } => ((axis, split), children),
                View::Leaf(leaf) => break leaf,
            };
            packet.counters.count(Event::InnerNode);
            let state = (&*spans, &*todo, &*packet.rays);
            let (into, first) = find_crossed_sides::<_, K>(simd, state, bundles, plane, level);
            if into[1 - first] == 0 {
                (node, bundles) = (children[first], into[first]);
                continue;
            }
            for bundle in iter_bundles(bundles) {
                let state = (&*spans, &*todo, &*packet.rays);
                let (sides, _) = split_spans::<_, K>(simd, state, bundle, plane, level);
                // The first one level down; the other in this level's place.
                for (side, level) in [(first, level + 1), (1 - first, level)] {
                    let [enter, exit] = sides[side];
                    todo.enter[level][bundle] = enter.to_array();
                    spans.exit[level][bundle] = exit.to_array();
                }
            }
            packet.counters.count(Event::Push);
            todo.entries[pending & (LEVELS - 1)] = (children[1 - first], into[1 - first], level);
            pending += 1;
            (node, bundles, level) = (children[first], into[first], level + 1);
        };
        let bundles = find_crossing(simd, packet.rays, spans, todo, bundles, level);
        packet.test_leaf(leaf, None, bundles, &mut spans.entered);
    }
}

/// Those bundles that have rays that cross the cell of a level; finds of each which.
#[inline(always)]
fn find_crossing<S: Simd>(
    simd: S,
    rays: &PacketRays,
    spans: &mut Spans,
    todo: &Todo,
    bundles: Bundles,
    level: usize,
) -> Bundles {
    let mut left = 0;
    for bundle in iter_bundles(bundles) {
        let enter = load(simd, &todo.enter[level][bundle]);
        let [_, t_max] = rays.bundle(bundle).spans(simd);
        let crosses = enter.simd_lt(load(simd, &spans.exit[level][bundle])) & enter.simd_le(t_max);
        spans.entered[bundle] = crosses.to_bitmask() as u8;
        left |= u64::from(any_lane(crosses)) << bundle;
    }
    left
}
