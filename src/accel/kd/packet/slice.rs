//! A slice of rays in a kd-tree: cut into packets, each walked as its row says.

use fearless_simd::Simd;

use super::cells::{Cell, Cells};
use super::cone::Cone;
use super::front_to_back::{self, At};
use super::leaf::{Packet, PacketTest, Tested};
use super::mixed::{self, ByDirection, ByOrigin};
use super::packet_kd_tree::{Algorithm, PacketKdTree, Scratch, Walks};
use super::{rope_walk, sequence};
use crate::accel::kd::layout::Nodes;
use crate::accel::kd::walk::With;
use crate::accel::narrowing::{
    Branches, EnteredRegions, Narrowing, Start, Started, Step, Within, find_entry_point,
};
use crate::accel::packet::{
    FEW, PacketContext, PacketRays, Plan, WalkPacket, trace_mixed_packets, trace_packets,
    trace_singles,
};
use crate::accel::{Counters, Query, Regions, SliceContext, Traverse};
use crate::geom::Shaft;
use crate::math::Ray;
use crate::simd::baseline;

/// Tiles of fewer rays are not divided: four by four.
const LEAST_TILE: usize = 16;
/// Tiles are divided if this often on the way down from their entry point both sides are met.
const MANY_FORKS: usize = 10;

/// Packets of a slice in the tree.
struct InSlice<'a, Q, C> {
    structure: &'a PacketKdTree,
    narrowing: Narrowing<Cells<'a>>,
    test: &'a dyn PacketTest<Q, C>,
    /// Where the slice starts, for rays within, and where the packet at hand does; `None` if it
    /// meets no leaf.
    from: Option<Step<Cell>>,
    within: Within,
    start: Option<Step<Cell>>,
    branches: Branches<'a, Cell>,
    walks: &'a mut Walks,
}

impl<S: Simd, Q: Query, C: Counters> WalkPacket<S, Q, C> for InSlice<'_, Q, C> {
    #[inline(always)]
    fn accepts(&self, ray: &Ray) -> bool {
        self.structure.accepts(ray)
    }

    fn begin(&mut self, simd: S, rays: &PacketRays, shaft: &Shaft, counters: &mut C) -> Plan {
        let held = self.within.holds(simd, rays, shaft);
        self.start = if held { self.from } else { Some(self.narrowing.at_root()) };
        if let (&Algorithm::EntryPoint { adaptive }, Some(from)) =
            (&self.structure.algorithm, self.start)
        {
            let entry = find_entry_point(self.narrowing.tree, from.place, shaft, counters);
            self.start = entry.map(|(place, _)| Step::to(place));
            let complex = entry.is_some_and(|(_, forks)| forks >= MANY_FORKS);
            if adaptive && complex && rays.lanes() > LEAST_TILE {
                return Plan::Split;
            }
        }
        Plan::Walk
    }

    fn walk(&mut self, context: PacketContext<'_, S, Q, C>, shaft: &Shaft) {
        let Some(start) = self.start else { return };
        let Walks { spans, todo, waiting, tested, .. } = &mut *self.walks;
        let packet = &mut self.structure.begin_packet(context, self.test, tested);
        todo.clear();
        match &self.structure.algorithm {
            Algorithm::Ropes(ropes) => rope_walk::walk(packet, ropes, spans, waiting),
            Algorithm::Sequence { culls } if let Some(cone) = Cone::of(shaft) => {
                sequence::follow(packet, (&cone, *culls), spans, todo);
                front_to_back::walk(packet, self.branches, spans, todo);
            }
            _ => {
                let all = spans.begin(baseline(), packet.rays, &packet.base.bounds);
                let root = packet.nodes.root();
                let is_root = start.is_plain() && start.place.node == root;
                todo.push(if is_root { At::Node(root) } else { At::Cell(start) }, all, 0);
                front_to_back::walk(packet, self.branches, spans, todo);
            }
        }
    }
}

impl PacketKdTree {
    /// Begins with a packet: prepares its rays, and forgets the triangles of the last one.
    fn begin_packet<'a, S, Q, C>(
        &'a self,
        context: PacketContext<'a, S, Q, C>,
        test: &'a dyn PacketTest<Q, C>,
        tested: &'a mut Tested,
    ) -> Packet<'a, Q, C> {
        let PacketContext { batch, rays, queries, counters, .. } = context;
        tested.clear();
        test.prepare(rays);
        let (base, nodes) = (self.single.base(), self.nodes());
        Packet { base, nodes, batch, rays, queries, test, tested, counters }
    }

    /// Answers a slice; leaves a list of the rays that are to be walked one by one.
    #[inline(never)]
    fn trace_slice<Q: Query, C: Counters>(
        &self,
        test: &dyn PacketTest<Q, C>,
        slice: &mut SliceContext<'_, impl Simd, Q, C>,
        Scratch { lists, walks, pool, .. }: &mut Scratch,
    ) {
        lists.clear();
        if slice.batch.rays().len() < FEW {
            lists.leave_all(slice.batch.rays().len());
            return;
        }
        let accepts = |ray: &Ray| self.accepts(ray);
        if let Algorithm::Mixed { by_origin } = self.algorithm {
            trace_mixed_packets(slice, self.size, lists, accepts, |context| {
                let packet = &mut self.begin_packet(context, test, &mut walks.tested);
                if by_origin {
                    mixed::walk::<ByOrigin, Q, C>(packet, &mut walks.spans, &mut walks.mixed);
                } else {
                    mixed::walk::<ByDirection, Q, C>(packet, &mut walks.spans, &mut walks.mixed);
                }
            });
            return;
        }
        let (narrowing, before) = (self.narrowing(), pool.len());
        let Started { from, within } = narrowing.start_slice(slice, accepts, pool);
        if from.is_none() && within.is_all() {
            // The slice's region has no leaf.
            slice.answer_nothing();
        } else {
            let (branches, start, structure) = (pool.branches(), from, self);
            let mut packets =
                InSlice { structure, narrowing, test, from, within, start, branches, walks };
            trace_packets(slice, self.size, lists, &mut packets);
        }
        pool.truncate(before);
    }
}

impl Traverse for PacketKdTree {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch,
    ) {
        let test = &With(slice.simd);
        self.trace_slice(test, &mut slice.reborrow(), scratch);
        trace_singles(slice, &scratch.lists, (&self.single, &mut scratch.single));
    }

    fn regions<'a, C: Counters>(
        &'a self,
        scratch: &'a mut Scratch,
        counters: &'a mut C,
    ) -> Option<Box<dyn Regions + 'a>> {
        let narrowing = self.narrowing();
        if narrowing.start == Start::Root {
            return None;
        }
        Some(Box::new(EnteredRegions { narrowing, pool: &mut scratch.pool, counters }))
    }
}
