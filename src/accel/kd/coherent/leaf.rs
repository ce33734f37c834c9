//! A packet in a tree, and its tests of leaves.

use fearless_simd::Simd;

use super::super::layout::Compact;
use super::super::tree::{Base, LeafId, Leaves, Slot};
use super::super::walk::With;
use super::cone::Cone;
use super::spans::{Bundles, of_set};
use crate::accel::coherent::{Ask, BUNDLES, Order, Rays};
use crate::accel::{Batch, Counters, Event, Query};
use crate::geom::Triangle;

/// Tests the triangles of a leaf by the rays of a packet, with some instruction set.
///
/// Walks are compiled once, for the baseline; only this exists for each instruction set. It costs an
/// indirect call for each leaf that is not empty.
pub trait PacketTest<Q, C>: Sync {
    /// Tests some triangles; those that a cone is known to miss are left out.
    fn test(
        &self,
        packet: &mut Packet<'_, Q, C>,
        slots: &[Slot],
        cone: Option<&Cone>,
        order: &mut Order<'_>,
    );
}

/// A packet in a tree: what all walks carry along.
pub struct Packet<'a, Q, C> {
    /// What all walks share.
    pub base: &'a Base,
    /// The nodes.
    pub nodes: &'a Compact,
    /// The slice.
    pub batch: &'a Batch<'a>,
    /// The rays.
    pub rays: &'a mut Rays,
    /// What is asked of them.
    pub queries: &'a mut [Q],
    /// How leaves are tested.
    pub test: &'a dyn PacketTest<Q, C>,
    /// What is counted.
    pub counters: &'a mut C,
}

impl<S: Simd, Q: Query, C: Counters> PacketTest<Q, C> for With<S> {
    fn test(
        &self,
        packet: &mut Packet<'_, Q, C>,
        slots: &[Slot],
        cone: Option<&Cone>,
        order: &mut Order<'_>,
    ) {
        self.0.vectorize(
            #[inline(always)]
            || test_all(self.0, packet, slots, cone, order),
        );
    }
}

#[inline(always)]
fn test_all<S: Simd, Q: Query, C: Counters>(
    simd: S,
    packet: &mut Packet<'_, Q, C>,
    slots: &[Slot],
    cone: Option<&Cone>,
    order: &mut Order<'_>,
) {
    let leaves: &Leaves = &packet.base.leaves;
    for &slot in slots {
        let (id, [a, b, c]) = (leaves.id(slot), leaves.corners(slot).map(|[x, y, z, _]| [x, y, z]));
        let triangle = Triangle { a: a.into(), b: b.into(), c: c.into() };
        if let Some(cone) = cone {
            packet.counters.count(Event::Search);
            if cone.misses(&triangle) {
                continue;
            }
        }
        let mut ask = Ask { simd, batch: packet.batch, queries: &mut *packet.queries };
        packet.rays.test(&mut ask, (id, &triangle), order, packet.counters);
    }
}

impl<Q: Query, C: Counters> Packet<'_, Q, C> {
    /// Tests a leaf by the rays that entered it, of some bundles.
    #[inline(always)]
    pub fn leaf(
        &mut self,
        leaf: LeafId,
        cone: Option<&Cone>,
        bundles: Bundles,
        entered: &mut [u8; BUNDLES],
    ) {
        self.counters.count(Event::Leaf);
        if leaf.is_empty() || bundles == 0 {
            return;
        }
        let mut list = [0; BUNDLES];
        let mut count = 0;
        for bundle in of_set(bundles) {
            list[count] = bundle as u8;
            count += 1;
        }
        let (base, test) = (self.base, self.test);
        let mut order = Order { bundles: &list[..count], entered };
        test.test(self, base.leaves.triangles(leaf), cone, &mut order);
    }
}
