//! A slice of rays: narrowed to its shaft, cut into packets, and what is not coherent left over.

use fearless_simd::Simd;

use super::packet::{Packet, Walk};
use super::place::Place;
use super::{Coherent, Scratch, With, single};
use crate::accel::bvh::binary;
use crate::accel::coherent::{
    Branch, Branches, FEW, Narrowing, Packets, Plan, Rays, Regions, Start, Started, Step, Trees,
    Within, shoot_packets, shoot_singles,
};
use crate::accel::{Batch, Counters, Query};
use crate::geom::Shaft;
use crate::math::Ray;

/// Packets of a slice in the hierarchy.
struct InSlice<'a, S> {
    simd: S,
    structure: &'a Coherent,
    narrowing: Narrowing<'a, super::Places<'a>>,
    /// Where the slice starts, for rays within, and where the packet at hand does; `None` if it
    /// meets no leaf.
    from: Option<Step<Place>>,
    within: Within,
    start: Option<Step<Place>>,
    view: &'a [Branch<Place>],
    branches: &'a mut Vec<Branch<Place>>,
    regions: &'a mut Regions<Place>,
    /// Branches of the slice.
    of_slice: usize,
    packet: &'a mut Packet,
    single: &'a mut binary::Scratch,
}

impl<S: Simd, Q: Query, C: Counters> Packets<Q, C> for InSlice<'_, S> {
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
        Scratch { single: alone, packet, pool, branches, regions, steps }: &mut Scratch,
        counters: &mut C,
    ) {
        pool.clear();
        let before = branches.len();
        match self.narrowing().filter(|_| batch.rays().len() >= FEW) {
            None => pool.leave_all(batch.rays().len()),
            Some(narrowing) => {
                let knows = |ray: &Ray| self.knows(ray);
                let slice = (batch, &*regions);
                let Started { from, view, within } =
                    narrowing.of_slice(simd, slice, knows, branches, counters);
                regions.note(branches);
                if self.with == With::Single {
                    let branches = Branches { view, own: branches };
                    let start = single::Start { places: narrowing.tree, branches, from, within };
                    let scratch = (&mut *alone, steps, &mut *pool);
                    self.shoot_each::<S, Q, C>(simd, &start, batch, answers, scratch, counters);
                } else if from.is_some() || !within.is_all() {
                    let of_slice = branches.len();
                    let mut packets = InSlice {
                        simd,
                        structure: self,
                        narrowing,
                        from,
                        within,
                        start: from,
                        view,
                        branches: &mut *branches,
                        regions,
                        of_slice,
                        packet,
                        single: alone,
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
        }
        branches.truncate(before);
        shoot_singles::<S, _, Q, C>(simd, (&*self.bvh, alone), batch, answers, pool, counters);
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
