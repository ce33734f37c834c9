//! Sixteen rays of a slice side by side, and what is asked of them.

use std::ops::ControlFlow;

use fearless_simd::Simd;

use super::{ClosestHit, Counters, Event, HitCriteria, Query, SliceContext};
use crate::geom::{PairHits, PairTriangle, RayLanes};
use crate::math::{PrimId, TriangleId};

/// Rays side by side.
pub const LANES: usize = RayLanes::LANES;

/// The questions of up to sixteen rays, a lane each.
pub struct Questions<Q> {
    /// A bit for each lane whose answer is not final.
    pub open: u32,
    /// With the best answers so far.
    pub queries: [Q; LANES],
    /// Numbers of the rays in the batch.
    pub members: [u32; LANES],
}

/// Pairs of a ray and a triangle, a lane each, and what the exact test says of them.
pub struct Pairs<'a> {
    /// The rays, prepared.
    pub rays: &'a RayLanes,
    /// Triangles.
    pub triangles: &'a [PairTriangle],
    /// Which of them each lane is asked about.
    pub numbers: &'a [u32; LANES],
    /// Room for the answers.
    pub found: &'a mut PairHits,
}

impl<Q: Query> Questions<Q> {
    /// Asks the exact test about the pairs of some lanes, and offers the hits it finds; a bit for
    /// each lane that had one.
    #[inline(always)]
    pub fn offer_hits<S: Simd, C: Counters>(
        &mut self,
        slice: &mut SliceContext<'_, S, Q, C>,
        lanes: u32,
        Pairs { rays, triangles, numbers, found }: Pairs<'_>,
    ) -> u32 {
        slice.counters.add(Event::ExactTest, u64::from(lanes.count_ones()));
        rays.intersect_pairs(slice.simd, lanes, triangles, numbers, found);
        let mut hits = found.lanes;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize % LANES;
            hits &= hits - 1;
            let [t, u, v, prim] = found.hits[lane];
            let triangle = TriangleId::unplaced(PrimId(prim.to_bits()));
            let hit = ClosestHit { t, u, v, triangle };
            let index = self.members[lane] as usize;
            let t_min = slice.batch.rays()[index].t_min();
            let criteria = HitCriteria::new(t_min, index, slice.batch.filter());
            if let ControlFlow::Break(()) = self.queries[lane].offer(&criteria, hit) {
                self.open &= !(1 << lane);
            }
        }
        found.lanes
    }
}
