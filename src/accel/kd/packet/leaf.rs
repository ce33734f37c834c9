//! A packet in a tree, and its tests of leaves.

use fearless_simd::Simd;

use super::cone::Cone;
use super::spans::{Bundles, iter_bundles};
use crate::accel::kd::layout::Compact;
use crate::accel::kd::tree::{Base, LeafId, Leaves, Slot};
use crate::accel::kd::walk::With;
use crate::accel::packet::{BUNDLES, EnteredRays, PacketContext, PacketRays};
use crate::accel::{Batch, Counters, Event, Query};
use crate::geom::Triangle;

/// Tests the triangles of a leaf by the rays of a packet, with some instruction set.
///
/// Walks are compiled once, for the baseline; only this exists for each instruction set. It costs
/// an indirect call for each leaf that is not empty.
pub trait PacketTest<Q, C>: Sync {
    /// Prepares rays for boxes and triangles.
    fn prepare(&self, rays: &mut PacketRays);

    /// Tests some triangles; those that a cone is known to miss are left out.
    fn test(
        &self,
        packet: &mut Packet<'_, Q, C>,
        slots: &[Slot],
        cone: Option<&Cone>,
        entered: &mut EnteredRays<'_>,
    );
}

/// A packet in a tree: what all walks carry along.
pub struct Packet<'a, Q, C> {
    /// What all walks share.
    pub base: &'a Base,
    /// The nodes.
    pub nodes: &'a Compact,
    /// The slice.
    pub batch: Batch<'a>,
    /// The rays.
    pub rays: &'a mut PacketRays,
    /// What is asked of them.
    pub queries: &'a mut [Q],
    /// How leaves are tested.
    pub test: &'a dyn PacketTest<Q, C>,
    /// Which triangles were tested lately.
    pub tested: &'a mut Tested,
    /// What is counted.
    pub counters: &'a mut C,
}

/// Triangles that a packet has tested lately, and which rays have: those need not meet them again,
/// since the exact test does not depend on where it is asked, and what it found was offered.
///
/// J. Amanatides and A. Woo, "A fast voxel traversal algorithm for ray tracing", 1987: mailboxes.
pub struct Tested {
    slots: [Option<Slot>; Self::COUNT],
    /// Of each the rays by bundles.
    rays: Box<[[u8; BUNDLES]; Self::COUNT]>,
}

impl Default for Tested {
    fn default() -> Self {
        Self { slots: [None; Self::COUNT], rays: Box::new([[0; BUNDLES]; Self::COUNT]) }
    }
}

impl Tested {
    /// A power of two. One slot evicts another that it equals modulo this.
    const COUNT: usize = 32;

    /// Drops all entries.
    pub fn clear(&mut self) {
        self.slots = [None; Self::COUNT];
    }

    /// The rays that have met a triangle.
    #[inline(always)]
    fn rays_that_met(&mut self, slot: Slot) -> &mut [u8; BUNDLES] {
        let place = slot.index() & (Self::COUNT - 1);
        if self.slots[place] != Some(slot) {
            self.slots[place] = Some(slot);
            self.rays[place] = [0; BUNDLES];
        }
        &mut self.rays[place]
    }
}

/// Takes those rays off that have met a triangle; false if none is left.
#[inline(always)]
fn strike_off(
    entered: &EnteredRays<'_>,
    tested: &mut [u8; BUNDLES],
    fresh: &mut [u8; BUNDLES],
) -> bool {
    let mut any = 0;
    for &bundle in entered.bundles {
        let bundle = usize::from(bundle);
        fresh[bundle] = entered.lanes[bundle] & !tested[bundle];
        tested[bundle] |= entered.lanes[bundle];
        any |= fresh[bundle];
    }
    any != 0
}

impl<S: Simd, Q: Query, C: Counters> PacketTest<Q, C> for With<S> {
    fn prepare(&self, rays: &mut PacketRays) {
        self.0.vectorize(
            #[inline(always)]
            || rays.prepare(self.0),
        );
    }

    fn test(
        &self,
        packet: &mut Packet<'_, Q, C>,
        slots: &[Slot],
        cone: Option<&Cone>,
        entered: &mut EnteredRays<'_>,
    ) {
        self.0.vectorize(
            #[inline(always)]
            || test_all(self.0, packet, slots, cone, entered),
        );
    }
}

#[inline(always)]
fn test_all<S: Simd, Q: Query, C: Counters>(
    simd: S,
    packet: &mut Packet<'_, Q, C>,
    slots: &[Slot],
    cone: Option<&Cone>,
    entered: &mut EnteredRays<'_>,
) {
    let leaves: &Leaves = &packet.base.leaves;
    for &slot in slots {
        let (id, [a, b, c]) = (leaves.id(slot), leaves.corners(slot).map(|[x, y, z, _]| [x, y, z]));
        let triangle = Triangle { a: a.into(), b: b.into(), c: c.into() };
        if let Some(cone) = cone {
            packet.counters.count(Event::TriangleTest);
            packet.counters.add(Event::TriangleLane, Cone::CORNERS);
            if cone.misses(&triangle) {
                continue;
            }
        }
        let mut fresh = [0; BUNDLES];
        if !strike_off(entered, packet.tested.rays_that_met(slot), &mut fresh) {
            continue;
        }
        let before = fresh;
        let Packet { batch, rays, queries, counters, .. } = &mut *packet;
        let counters = &mut **counters;
        let mut context = PacketContext { simd, batch: *batch, rays, queries, counters };
        let mut left = EnteredRays { bundles: entered.bundles, lanes: &mut fresh };
        context.test_triangle((id, &triangle), &mut left);
        if Q::ANY {
            for &bundle in entered.bundles {
                let bundle = usize::from(bundle);
                entered.lanes[bundle] &= !(before[bundle] & !fresh[bundle]);
            }
        }
    }
}

impl<Q: Query, C: Counters> Packet<'_, Q, C> {
    /// Tests a leaf by the rays that entered it, of some bundles.
    #[inline(always)]
    pub fn test_leaf(
        &mut self,
        leaf: LeafId,
        cone: Option<&Cone>,
        bundles: Bundles,
        lanes: &mut [u8; BUNDLES],
    ) {
        self.counters.count(Event::Leaf);
        if leaf.is_empty() || bundles == 0 {
            return;
        }
        let mut list = [0; BUNDLES];
        let mut count = 0;
        for bundle in iter_bundles(bundles) {
            list[count] = bundle as u8;
            count += 1;
        }
        let (base, test) = (self.base, self.test);
        let mut entered = EnteredRays { bundles: &list[..count], lanes };
        test.test(self, base.leaves.triangles(leaf), cone, &mut entered);
    }
}
