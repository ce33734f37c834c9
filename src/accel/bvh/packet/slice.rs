//! A slice of rays: narrowed to its shaft, cut into packets, and what does not run side by side
//! left over.

use fearless_simd::Simd;

use super::packet_bvh::{PacketBvh, Scratch, With};
use super::place::{Place, Places};
use super::single::EachFrom;
use super::walk::{self, PacketWalk};
use crate::accel::bvh::binary;
use crate::accel::narrowing::{
    BranchPool, EnteredRegions, Narrowing, Start, Started, Step, Within,
};
use crate::accel::packet::{
    FEW, PacketContext, PacketRays, Plan, WalkPacket, trace_packets, trace_singles,
};
use crate::accel::{Counters, Query, Regions, SliceContext, Traverse};
use crate::geom::Shaft;
use crate::math::Ray;

/// Packets of a slice in the hierarchy.
struct InSlice<'t, 'a> {
    structure: &'t PacketBvh,
    narrowing: Narrowing<Places<'t>>,
    /// Where the slice starts, for rays within, and where the packet at hand does; `None` if it
    /// meets no leaf.
    from: Option<Step<Place>>,
    within: Within,
    start: Option<Step<Place>>,
    pool: &'a mut BranchPool<Place>,
    /// Branches of the slice, and of the regions around it.
    of_slice: usize,
    packet: &'a mut PacketWalk,
    single: &'a mut binary::Scratch,
}

impl<S: Simd, Q: Query, C: Counters> WalkPacket<S, Q, C> for InSlice<'_, '_> {
    #[inline(always)]
    fn accepts(&self, ray: &Ray) -> bool {
        self.structure.accepts(ray)
    }

    #[inline(always)]
    fn begin(&mut self, simd: S, rays: &PacketRays, shaft: &Shaft, counters: &mut C) -> Plan {
        let held = self.within.holds(simd, rays, shaft);
        self.start = if held { self.from } else { Some(self.narrowing.at_root()) };
        if let Some(from) = self.start.filter(|_| self.structure.is_per_packet()) {
            // One more tree, upon that of the slice.
            self.pool.truncate(self.of_slice);
            self.start = self.narrowing.narrow(from, self.pool, shaft, counters);
        }
        Plan::Walk
    }

    #[inline(always)]
    fn walk(&mut self, context: PacketContext<'_, S, Q, C>, shaft: &Shaft) {
        // Nothing to meet: nothing is hit.
        let Some(start) = self.start else { return };
        context.rays.prepare(context.simd);
        let mut within = walk::Within {
            context,
            places: self.narrowing.tree,
            branches: self.pool.branches(),
            fetched: &mut self.single.fetched,
            partitions: self.structure.with == With::Partition,
            culls: !self.structure.is_per_packet(),
        };
        self.packet.walk(&mut within, start, &mut shaft.clone());
    }
}

impl Traverse for PacketBvh {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch,
    ) {
        scratch.lists.clear();
        let (rays, before) = (slice.batch.rays().len(), scratch.pool.len());
        match self.narrowing().filter(|_| rays >= FEW) {
            None => scratch.lists.leave_all(rays),
            Some(narrowing) => self.trace_narrowed(slice, narrowing, scratch),
        }
        scratch.pool.truncate(before);
        trace_singles(slice, &scratch.lists, (&self.bvh, &mut scratch.single));
    }

    fn regions<'a, C: Counters>(
        &'a self,
        scratch: &'a mut Scratch,
        counters: &'a mut C,
    ) -> Option<Box<dyn Regions + 'a>> {
        let narrowing = self.narrowing().filter(|_| self.start != Start::Root)?;
        Some(Box::new(EnteredRegions { narrowing, pool: &mut scratch.pool, counters }))
    }
}

impl PacketBvh {
    /// Answers a slice from what its region meets; leaves a list of the rays that none took up, and
    /// the branches.
    #[inline(always)]
    fn trace_narrowed<'t, S: Simd, Q: Query, C: Counters>(
        &'t self,
        slice: &mut SliceContext<'_, S, Q, C>,
        narrowing: Narrowing<Places<'t>>,
        Scratch { single, packet, lists, pool, steps }: &mut Scratch,
    ) {
        let accepts = |ray: &Ray| self.accepts(ray);
        let Started { from, within } = narrowing.start_slice(slice, accepts, pool);
        if self.with == With::Single {
            let branches = pool.branches();
            let each = EachFrom { places: narrowing.tree, branches, from, within };
            self.trace_each(slice, &each, (single, steps, lists));
        } else if from.is_some() || !within.is_all() {
            let (structure, of_slice, start) = (self, pool.len(), from);
            let mut packets = InSlice {
                structure,
                narrowing,
                from,
                within,
                start,
                pool,
                of_slice,
                packet,
                single,
            };
            trace_packets(slice, self.size, lists, &mut packets);
        } else {
            // The slice's region has no leaf.
            slice.answer_nothing();
        }
    }
}
