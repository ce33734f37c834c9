//! The rays of a packet, in bundles, and what triangles are hit by them.

use fearless_simd::{Simd, SimdBase};

use super::layout::RAYS;
use crate::accel::query::ask_of;
use crate::accel::{Batch, ClosestHit, Counters, Event, HitCriteria, Query, Verdict};
use crate::geom::{FilterTriangle, Heading, RayBundle, Shaft, Triangle};
use crate::math::{PrimId, Ray, TriangleId, Vec3};

/// Rays of a bundle.
const LANES: usize = RayBundle::LANES;

/// Bundles of a packet at most: of each heading the last need not be full.
pub const BUNDLES: usize = RAYS / LANES + Heading::COUNT;

/// Stands for no ray.
const NONE: u32 = u32::MAX;

/// A packet's rays. Those of a bundle all head the same way.
pub struct PacketRays {
    bundles: Box<[RayBundle]>,
    headings: Box<[Heading; BUNDLES]>,
    /// How many bundles there are.
    count: usize,
    /// Numbers of the rays in the slice, lane by lane; [`NONE`] where there is none.
    members: Vec<u32>,
}

/// A packet on its way through a structure.
pub struct PacketContext<'a, S, Q, C> {
    /// The instruction set to walk with.
    pub simd: S,
    /// The slice.
    pub batch: Batch<'a>,
    /// The packet's rays.
    pub rays: &'a mut PacketRays,
    /// The questions, lane by lane.
    pub queries: &'a mut [Q],
    /// What is counted.
    pub counters: &'a mut C,
}

/// Rays that have entered a leaf, of some bundles.
pub struct EnteredRays<'a> {
    /// Numbers of bundles.
    pub bundles: &'a [u8],
    /// Of each bundle, by its number, a bit for each ray.
    pub lanes: &'a mut [u8; BUNDLES],
}

/// How many rays of a bundle ended or came nearer, and a bit for each that ended.
#[derive(Clone, Copy, Default)]
struct Found {
    count: usize,
    ended: u8,
}

impl Default for PacketRays {
    fn default() -> Self {
        Self {
            bundles: vec![RayBundle::EMPTY; BUNDLES].into_boxed_slice(),
            headings: Box::new([Heading::default(); BUNDLES]),
            count: 0,
            members: Vec::with_capacity(BUNDLES * LANES),
        }
    }
}

impl PacketRays {
    /// Takes rays of a slice, which should all have the same heading: that of the first.
    #[inline(always)]
    pub fn fill(&mut self, batch: &Batch<'_>, members: &[u32]) {
        self.members.clear();
        self.members.extend_from_slice(members);
        self.count = members.len().div_ceil(LANES);
        let Some(&first) = members.first() else { return };
        let heading = Heading::of(batch.rays()[first as usize].direction());
        self.headings[..self.count].fill(heading);
        self.bundles[self.count - 1] = RayBundle::EMPTY;
        let rays = batch.rays();
        for (bundle, members) in self.bundles.iter_mut().zip(members.chunks(LANES)) {
            for (lane, &member) in members.iter().enumerate() {
                bundle.put(lane, &rays[member as usize]);
            }
        }
    }

    /// Takes rays of a slice, whatever their headings: bundles of each heading in turn.
    pub fn fill_mixed(&mut self, batch: &Batch<'_>, members: &[u32]) {
        let heading = |index: u32| Heading::of(batch.rays()[index as usize].direction());
        self.members.clear();
        self.count = 0;
        let mut present = 0_u32;
        for &member in members {
            present |= 1 << heading(member).number();
        }
        while present != 0 {
            let number = present.trailing_zeros() as usize;
            present &= present - 1;
            for &member in members.iter().filter(|&&member| heading(member).number() == number) {
                if self.members.len().is_multiple_of(LANES) {
                    self.bundles[self.count] = RayBundle::EMPTY;
                    self.headings[self.count] = heading(member);
                    self.count += 1;
                }
                let lane = self.members.len() % LANES;
                self.bundles[self.count - 1].put(lane, &batch.rays()[member as usize]);
                self.members.push(member);
            }
            self.members.resize(self.count * LANES, NONE);
        }
    }

    /// Prepares them for boxes and triangles.
    #[inline(always)]
    pub fn prepare<S: Simd>(&mut self, simd: S) {
        for (bundle, heading) in self.bundles[..self.count].iter_mut().zip(&*self.headings) {
            bundle.prepare(simd, *heading);
        }
    }

    /// Fills a list with new queries, one for each lane.
    #[inline(always)]
    pub fn fill_queries<Q: Query>(&self, batch: &Batch<'_>, queries: &mut Vec<Q>) {
        let query =
            |&i: &u32| if i == NONE { Q::new(&Ray::MISS) } else { ask_of(batch, i as usize) };
        queries.clear();
        queries.extend(self.members.iter().map(query));
    }

    /// How many bundles there are.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// How many lanes there are, with and without rays.
    #[inline(always)]
    pub fn lanes(&self) -> usize {
        self.members.len()
    }

    /// A bundle.
    #[inline(always)]
    pub fn bundle(&self, number: usize) -> &RayBundle {
        &self.bundles[number]
    }

    /// Which way a bundle heads.
    #[inline(always)]
    pub fn heading(&self, number: usize) -> Heading {
        self.headings[number]
    }

    /// The region of its rays; see [`Shaft::of_rays`].
    #[inline(always)]
    pub fn make_shaft<S: Simd>(&self, simd: S, corners: [Vec3; 4]) -> Option<Shaft> {
        Shaft::of_bundles(simd, &self.bundles[..self.count], corners)
    }

    /// Whether a region is seen to hold them all; see [`Shaft::holds_bundle`].
    #[inline(always)]
    pub fn are_held_by<S: Simd>(&self, simd: S, shaft: &Shaft) -> bool {
        for bundle in &self.bundles[..self.count] {
            if !shaft.holds_bundle(simd, bundle) {
                return false;
            }
        }
        true
    }

    /// Ends the shaft where the last of the rays does.
    #[inline(always)]
    pub fn end_shaft<S: Simd>(&self, simd: S, shaft: &mut Shaft) {
        let mut end = self.bundles[0].end_along(simd, shaft.axis());
        for bundle in &self.bundles[1..self.count] {
            end = end.max(bundle.end_along(simd, shaft.axis()));
        }
        let end = end.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        shaft.end_at(end);
    }

    /// Writes the answers of its rays, by their numbers in the slice.
    #[inline(always)]
    pub fn write_answers<Q: Query>(&self, queries: &[Q], answers: &mut [Q::Answer]) {
        for (&member, query) in self.members.iter().zip(queries) {
            if member != NONE {
                answers[member as usize] = query.answer();
            }
        }
    }
}

impl<S: Simd, Q: Query, C: Counters> PacketContext<'_, S, Q, C> {
    /// Tests a triangle; how many rays ended or came nearer. Those that ended are struck off.
    #[inline(always)]
    pub fn test_triangle(
        &mut self,
        (id, triangle): (PrimId, &Triangle),
        entered: &mut EnteredRays<'_>,
    ) -> usize {
        if let Some(verdict) = self.batch.verdict() {
            return self.judge(verdict, (id, triangle), entered);
        }
        let mut found = 0;
        let filter = FilterTriangle::new(self.simd, triangle);
        for &bundle in entered.bundles {
            let bundle = usize::from(bundle);
            let asked = u32::from(entered.lanes[bundle]);
            if asked == 0 {
                continue;
            }
            self.counters.count(Event::TriangleTest);
            if C::COUNTS {
                self.counters.add(Event::TriangleLane, u64::from(asked.count_ones()));
            }
            let lanes = self.rays.bundles[bundle].find_candidates(self.simd, &filter) & asked;
            if lanes != 0 {
                self.counters.add(Event::ExactTest, u64::from(lanes.count_ones()));
                let Found { count, ended } = self.offer_hits(bundle, lanes, (id, triangle));
                entered.lanes[bundle] &= !ended;
                found += count;
            }
        }
        found
    }

    /// Asks another than the exact test about a primitive, ray by ray.
    #[inline(never)]
    fn judge(
        &mut self,
        verdict: &dyn Verdict,
        prim: (PrimId, &Triangle),
        entered: &mut EnteredRays<'_>,
    ) -> usize {
        let mut found = 0;
        for &number in entered.bundles {
            let number = usize::from(number);
            let mut asked = entered.lanes[number];
            while asked != 0 {
                let lane = asked.trailing_zeros() as usize;
                asked &= asked - 1;
                self.counters.count(Event::ExactTest);
                let at = number * LANES + lane;
                let query = &mut self.queries[at];
                let index = self.rays.members[at] as usize;
                let hit = verdict.judge(index, prim, &query.nearest(), Q::ANY);
                let Some(hit) = hit else { continue };
                let bundle = &mut self.rays.bundles[number];
                found += 1;
                if query.take(hit, verdict.limit(hit.t)).is_break() {
                    bundle.end_at(lane, f32::NEG_INFINITY);
                    entered.lanes[number] &= !(1 << lane);
                } else {
                    bundle.end_at(lane, query.t_max());
                }
            }
        }
        found
    }

    /// Asks the exact test about a triangle and those rays of a bundle that may hit it, and offers
    /// the hits it finds.
    #[inline(always)]
    fn offer_hits(
        &mut self,
        number: usize,
        lanes: u32,
        (id, triangle): (PrimId, &Triangle),
    ) -> Found {
        let mut found = Found::default();
        let PacketRays { bundles, headings, members, .. } = &mut *self.rays;
        let bundle = &mut bundles[number];
        let hits_of = bundle.intersect_triangle(self.simd, headings[number], triangle, lanes);
        let mut hits = hits_of.hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let at = number * LANES + lane;
            let index = members[at] as usize;
            let t_min = self.batch.rays()[index].t_min();
            let criteria = HitCriteria::new(t_min, index, self.batch.filter());
            let (t, u, v) = (hits_of.t[lane], hits_of.u[lane], hits_of.v[lane]);
            let query = &mut self.queries[at];
            let before = query.t_max();
            if query
                .offer(&criteria, ClosestHit { t, u, v, triangle: TriangleId::unplaced(id) })
                .is_break()
            {
                bundle.end_at(lane, f32::NEG_INFINITY);
                found.ended |= 1 << lane;
                found.count += 1;
            } else if query.t_max() < before {
                bundle.end_at(lane, query.t_max());
                found.count += 1;
            }
        }
        found
    }
}
