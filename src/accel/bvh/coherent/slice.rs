//! A slice of rays: narrowed to its shaft, cut into packets, and what is not coherent left over.

use fearless_simd::Simd;

use super::packet::{Packet, Walk};
use super::place::{Place, Places};
use super::single::EachFrom;
use super::{Coherent, Scratch, With};
use crate::accel::bvh::binary;
use crate::accel::coherent::{
    Branch, Branches, FEW, Narrowing, Packets, Plan, Rays, Regions, Start, Started, Step, Trees,
    Within, shoot_packets, shoot_singles,
};
use crate::accel::{Batch, Counters, Query};
use crate::geom::Shaft;
use crate::math::Ray;

/// Packets of a slice in the hierarchy.
struct InSlice<'t, 'a, S> {
    simd: S,
    structure: &'t Coherent,
    narrowing: Narrowing<'t, Places<'t>>,
    /// Where the slice starts, for rays within, and where the packet at hand does; `None` if it
    /// meets no leaf.
    from: Option<Step<Place>>,
    within: Within,
    start: Option<Step<Place>>,
    view: &'t [Branch<Place>],
    branches: &'a mut Vec<Branch<Place>>,
    regions: &'a mut Regions<Place>,
    /// Branches of the slice.
    of_slice: usize,
    packet: &'a mut Packet,
    single: &'a mut binary::Scratch,
}

impl<S: Simd, Q: Query, C: Counters> Packets<Q, C> for InSlice<'_, '_, S> {
    #[inline(always)]
    fn knows(&self, ray: &Ray) -> bool {
        self.structure.knows(ray)
    }

    #[inline(always)]
    fn begin(&mut self, rays: &Rays, shaft: &Shaft, counters: &mut C) -> Plan {
        let held = self.within.holds(self.simd, rays, shaft);
        self.start = if held { self.from } else { Some(self.narrowing.at_root()) };
        if let Some(from) = self.start.filter(|_| self.structure.per_packet()) {
            // One more tree, upon that of the slice.
            self.branches.truncate(self.of_slice);
            let pool = Trees { view: self.view, own: self.branches };
            self.start = self.narrowing.narrow(from, pool, shaft, counters);
            self.regions.note(self.branches);
        }
        Plan::Walk
    }

    #[inline(always)]
    fn walk(
        &mut self,
        rays: &mut Rays,
        shaft: &Shaft,
        batch: &Batch<'_>,
        queries: &mut [Q],
        counters: &mut C,
    ) {
        rays.prepare(self.simd);
        let mut walk = Walk {
            simd: self.simd,
            places: self.narrowing.tree,
            branches: Branches { view: self.view, own: self.branches },
            batch,
            rays,
            queries,
            fetched: &mut self.single.fetched,
            partitions: self.structure.with == With::Partition,
            culls: !self.structure.per_packet(),
        };
        self.packet.walk(&mut walk, self.start, &mut shaft.clone(), counters);
    }
}

impl Coherent {
    /// Answers a slice.
    #[inline(always)]
    pub(super) fn shoot_slice<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        scratch: &mut Scratch,
        counters: &mut C,
    ) {
        scratch.pool.clear();
        let before = scratch.branches.len();
        match self.narrowing().filter(|_| batch.rays().len() >= FEW) {
            None => scratch.pool.leave_all(batch.rays().len()),
            Some(narrowing) => {
                self.shoot_narrowed::<S, Q, C>(simd, narrowing, batch, answers, scratch, counters);
            }
        }
        let Scratch { single, pool, branches, .. } = scratch;
        branches.truncate(before);
        shoot_singles::<S, _, Q, C>(simd, (&*self.bvh, single), batch, answers, pool, counters);
    }

    /// Answers a slice from what its region meets; leaves a list of the rays that none took up, and
    /// the branches.
    #[inline(always)]
    fn shoot_narrowed<'t, S: Simd, Q: Query, C: Counters>(
        &'t self,
        simd: S,
        narrowing: Narrowing<'t, Places<'t>>,
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        Scratch { single, packet, pool, branches, regions, steps }: &mut Scratch,
        counters: &mut C,
    ) {
        let knows = |ray: &Ray| self.knows(ray);
        let Started { from, view, within } =
            narrowing.of_slice(simd, (batch, &*regions), knows, branches, counters);
        regions.note(branches);
        if self.with == With::Single {
            let branches = Branches { view, own: branches };
            let each = EachFrom { places: narrowing.tree, branches, from, within };
            let scratch = (single, steps, pool);
            self.shoot_each::<S, Q, C>(simd, &each, batch, answers, scratch, counters);
        } else if from.is_some() || !within.is_all() {
            let of_slice = branches.len();
            let (structure, start) = (self, from);
            let mut packets = InSlice {
                simd,
                structure,
                narrowing,
                from,
                within,
                start,
                view,
                branches,
                regions,
                of_slice,
                packet,
                single,
            };
            let cut = (batch, self.size);
            shoot_packets::<S, Q, C, _>(simd, cut, answers, pool, &mut packets, counters);
        } else {
            // The slice's region has no leaf.
            for (answer, ray) in answers.iter_mut().zip(batch.rays()) {
                *answer = Q::new(ray).answer();
            }
        }
    }

    /// Whether packets have trees of their own.
    fn per_packet(&self) -> bool {
        matches!(self.start, Start::Compressed { per_packet: true, .. })
    }

    /// Whether the boxes are good for a ray.
    #[inline(always)]
    pub(super) fn knows(&self, ray: &Ray) -> bool {
        self.bvh.parts.is_none_or(|parts| parts.covers(ray))
    }
}
