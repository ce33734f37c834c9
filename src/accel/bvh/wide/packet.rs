//! Sixteen rays in a leaf: each triangle that is asked for against all rays, a lane each, and then
//! the exact test of pairs of a ray and a triangle.

use fearless_simd::Simd;

use crate::accel::side_by_side::{LANES, Pairs, Questions};
use crate::accel::{Counters, Query, SliceContext};
use crate::geom::{BlockRef, PairHits, PairTriangle, RayLanes, Triangle};
use crate::math::{PrimId, Vec3};

/// Scratch of one thread.
pub struct PacketScratch<const W: usize> {
    /// The rays.
    pub rays: RayLanes,
    /// Triangles of the leaf at hand.
    triangles: [PairTriangle; W],
    found: PairHits,
    /// Numbers of the rays in the slice.
    pub members: Vec<u32>,
}

impl<const W: usize> Default for PacketScratch<W> {
    fn default() -> Self {
        let zeros = Triangle { a: Vec3::ZERO, b: Vec3::ZERO, c: Vec3::ZERO };
        Self {
            rays: RayLanes::EMPTY,
            triangles: [PairTriangle::new(PrimId::NONE, &zeros); W],
            found: PairHits::default(),
            members: Vec::with_capacity(LANES),
        }
    }
}

impl<const W: usize> PacketScratch<W> {
    /// Tests those triangles of a leaf that are asked for; whether a ray hit any.
    #[inline(always)]
    pub fn test_block<S: Simd, Q: Query, C: Counters>(
        &mut self,
        slice: &mut SliceContext<'_, S, Q, C>,
        questions: &mut Questions<Q>,
        (block, asked): (BlockRef<'_, W>, u32),
    ) -> bool {
        let simd = slice.simd;
        let mut candidates = self.rays.find_candidates(simd, &block, asked);
        let mut any = 0;
        for (number, lanes) in candidates.iter_mut().enumerate() {
            let id = block.ids[number];
            *lanes = if id == PrimId::NONE { 0 } else { *lanes & questions.open };
            if *lanes != 0 {
                self.triangles[number] = PairTriangle::new(id, &block.triangle(number));
            }
            any |= *lanes;
        }
        let mut changed = 0;
        while any & questions.open != 0 {
            // Each ray takes one of its candidates.
            let mut numbers = [0; LANES];
            let mut lanes = 0;
            any = 0;
            for (number, waiting) in candidates.iter_mut().enumerate() {
                let mut taken = *waiting & !lanes & questions.open;
                *waiting &= !taken;
                any |= *waiting;
                lanes |= taken;
                while taken != 0 {
                    numbers[taken.trailing_zeros() as usize % LANES] = number as u32;
                    taken &= taken - 1;
                }
            }
            let Self { rays, triangles, found, .. } = &mut *self;
            let pairs = Pairs { rays, triangles: &triangles[..], numbers: &numbers, found };
            changed |= questions.offer_hits(slice, lanes, pairs);
        }
        let mut rest = changed;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % LANES;
            rest &= rest - 1;
            let open = questions.open >> lane & 1 == 1;
            let t_max = if open { questions.queries[lane].t_max() } else { f32::NEG_INFINITY };
            self.rays.end_at(lane, t_max);
        }
        changed != 0
    }
}
