//! A slice of rays in a kd-tree: cut into packets, each walked as its row says.

use super::super::layout::Nodes;
use super::cells::{Cell, Cells};
use super::cone::Cone;
use super::front::{self, At};
use super::leaf::{Packet, PacketTest};
use super::mixed::{self, ByDirection, ByOrigin};
use super::{Coherent, How, Scratch, Walks, ropes, sequence};
use crate::accel::coherent::{
    Branch, Branches, FEW, Narrowing, Packets, Plan, Rays, Regions, Started, Step, Within,
    entry_point, shoot_mixed, shoot_packets,
};
use crate::accel::{Batch, Counters, Query};
use crate::geom::Shaft;
use crate::math::Ray;
use crate::simd::baseline;

/// Tiles of fewer rays are not divided: four by four.
const LEAST_TILE: usize = 16;
/// Tiles are divided if this often on the way down from their entry point both sides are met.
const MANY_FORKS: usize = 10;

/// Packets of a slice in the tree.
struct InSlice<'a, Q, C> {
    structure: &'a Coherent,
    narrowing: Narrowing<'a, Cells<'a>>,
    test: &'a dyn PacketTest<Q, C>,
    /// Where the slice starts, for rays within, and where the packet at hand does; `None` if it
    /// meets no leaf.
    from: Option<Step<Cell>>,
    within: Within,
    start: Option<Step<Cell>>,
    branches: Branches<'a, Cell>,
    walks: &'a mut Walks,
}

impl<Q: Query, C: Counters> Packets<Q, C> for InSlice<'_, Q, C> {
    #[inline(always)]
    fn knows(&self, ray: &Ray) -> bool {
        self.structure.knows(ray)
    }

    fn begin(&mut self, rays: &Rays, shaft: &Shaft, counters: &mut C) -> Plan {
        let held = self.within.holds(baseline(), rays, shaft);
        self.start = if held { self.from } else { Some(self.narrowing.at_root()) };
        if let (&How::EntryPoint { adaptive }, Some(from)) = (&*self.structure.how, self.start) {
            let entry = entry_point(self.narrowing.tree, from.place, shaft, counters);
            self.start = entry.map(|(place, _)| Step::to(place));
            let complex = entry.is_some_and(|(_, forks)| forks >= MANY_FORKS);
            if adaptive && complex && rays.lanes() > LEAST_TILE {
                return Plan::Split;
            }
        }
        Plan::Walk
    }

    fn walk(
        &mut self,
        rays: &mut Rays,
        shaft: &Shaft,
        batch: &Batch<'_>,
        queries: &mut [Q],
        counters: &mut C,
    ) {
        let Some(start) = self.start else { return };
        let (base, nodes) = (self.structure.single.base(), self.structure.nodes());
        let Walks { spans, todo, waiting, tested, .. } = &mut *self.walks;
        tested.clear();
        todo.clear();
        let test = self.test;
        test.prepare(rays);
        let packet = &mut Packet { base, nodes, batch, rays, queries, test, tested, counters };
        match &*self.structure.how {
            How::Ropes(ropes) => ropes::walk(packet, ropes, spans, waiting),
            How::Sequence { culls } if let Some(cone) = Cone::of(shaft) => {
                sequence::follow(packet, (&cone, *culls), spans, todo);
                front::walk(packet, self.branches, spans, todo);
            }
            _ => {
                let all = spans.begin(baseline(), packet.rays, &base.bounds);
                let is_root = start.is_plain() && start.place.node == nodes.root();
                let at = if is_root { At::Node(nodes.root()) } else { At::Cell(start) };
                todo.push(at, all, 0);
                front::walk(packet, self.branches, spans, todo);
            }
        }
    }
}

impl Coherent {
    /// Answers a slice; leaves a list of the rays that are to be walked one by one.
    #[inline(never)]
    pub(super) fn shoot_slice<Q: Query, C: Counters>(
        &self,
        test: &dyn PacketTest<Q, C>,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        Scratch { pool, walks, branches, .. }: &mut Scratch,
        counters: &mut C,
    ) {
        pool.clear();
        branches.clear();
        if batch.rays().len() < FEW {
            pool.leave_all(batch.rays().len());
            return;
        }
        let (simd, slice, knows) = (baseline(), (batch, self.size), |ray: &Ray| self.knows(ray));
        if let How::Mixed { by_origin } = *self.how {
            let walk = |rays: &mut Rays, queries: &mut [Q], counters: &mut C| {
                let (base, nodes) = (self.single.base(), self.nodes());
                let Walks { spans, mixed, tested, .. } = &mut *walks;
                tested.clear();
                test.prepare(rays);
                let packet =
                    &mut Packet { base, nodes, batch, rays, queries, test, tested, counters };
                if by_origin {
                    mixed::walk::<ByOrigin, Q, C>(packet, spans, mixed);
                } else {
                    mixed::walk::<ByDirection, Q, C>(packet, spans, mixed);
                }
            };
            shoot_mixed(slice, answers, pool, knows, walk, counters);
            return;
        }
        let narrowing = self.narrowing();
        let Started { from, view, within } =
            narrowing.of_slice(simd, (batch, &Regions::new()), knows, branches, counters);
        let own: &[Branch<Cell>] = branches;
        if from.is_none() && within.is_all() {
            // The slice's region has no leaf.
            for (answer, ray) in answers.iter_mut().zip(batch.rays()) {
                *answer = Q::new(ray).answer();
            }
            return;
        }
        let (branches, start, structure) = (Branches { view, own }, from, self);
        let mut packets =
            InSlice { structure, narrowing, test, from, within, start, branches, walks };
        shoot_packets::<_, Q, C, _>(simd, slice, answers, pool, &mut packets, counters);
    }

    /// Whether a ray may be walked with others.
    #[inline(always)]
    fn knows(&self, ray: &Ray) -> bool {
        self.single.base().slack.is_tame(ray)
    }
}
