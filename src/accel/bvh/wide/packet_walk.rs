//! Rays from one point that run side by side, such as those of a pinhole: sixteen at a time.
//!
//! All of them go down together: a node's children are held against the beam that holds the rays,
//! in one step for eight children ([`super::beam`]). In a leaf only those triangles are looked at
//! whose own box the beam enters ([`super::packet`]).

use fearless_simd::Simd;

use super::beam::Beam;
use super::packet::PacketScratch;
use super::stack::{Sorting, Stack};
use super::wide_bvh::{Scratch, WideBvh};
use crate::accel::bvh::leaves::Fetched;
use crate::accel::packet::PacketLayout;
use crate::accel::side_by_side::{LANES, Questions};
use crate::accel::{Counters, Query, SliceContext};
use crate::math::Ray;
use crate::simd::order::key_limit;
use crate::simd::{Vectors, Width};

impl<const W: usize> WideBvh<W>
where
    Width: Vectors<W>,
{
    /// Traces a slice of rays that run side by side, or ray by ray where they do not.
    #[inline(always)]
    pub fn trace_packets<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Scratch<W>,
    ) {
        let Some(mut packet) = scratch.packet.take() else { return };
        let layout = PacketLayout::new(&slice.batch, LANES);
        let rays = slice.batch.rays();
        for number in 0..layout.count() {
            layout.list(number, &mut packet.members);
            let mut members = std::mem::take(&mut packet.members);
            for members in members.chunks(LANES) {
                let own = members.iter().map(|&i| &rays[i as usize]);
                let covered = |ray| self.parts.is_none_or(|parts| parts.covers(ray));
                let beam = own.clone().all(covered).then(|| Beam::new(own)).flatten();
                match beam {
                    Some(beam) => self.trace_beam(slice, &beam, members, (&mut packet, scratch)),
                    None => {
                        for &index in members {
                            slice.answer(
                                index as usize,
                                #[inline(always)]
                                |context| self.walk(context, scratch),
                            );
                        }
                    }
                }
            }
            members.clear();
            packet.members = members;
        }
        scratch.packet = Some(packet);
    }

    /// Answers the rays of a packet.
    #[inline(always)]
    fn trace_beam<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        beam: &Beam,
        members: &[u32],
        (packet, scratch): (&mut PacketScratch<W>, &mut Scratch<W>),
    ) {
        let rays = slice.batch.rays();
        let ray = |lane: usize| members.get(lane).map_or(&Ray::MISS, |&i| &rays[i as usize]);
        for lane in 0..LANES {
            packet.rays.put(lane, ray(lane));
        }
        packet.rays.prepare(slice.simd);
        let mut questions = Questions {
            open: (1 << members.len()) - 1,
            queries: std::array::from_fn(|lane| Q::new(ray(lane))),
            members: std::array::from_fn(|lane| members.get(lane).map_or(0, |&i| i)),
        };
        let Scratch { stacks, fetched, .. } = scratch;
        self.walk_beam(slice, beam, &mut questions, (packet, &mut stacks[0], fetched));
        for (&member, query) in members.iter().zip(&questions.queries) {
            slice.answers[member as usize] = query.answer();
        }
    }

    /// Walks a packet's rays.
    #[inline(always)]
    fn walk_beam<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        beam: &Beam,
        questions: &mut Questions<Q>,
        (packet, stack, fetched): (&mut PacketScratch<W>, &mut Stack<W>, &mut Fetched<W>),
    ) {
        let Some(mut link) = self.root else { return };
        let (simd, stripes, mut top) = (slice.simd, self.arena.stripes(), 1);
        let mut t_max = farthest(questions);
        loop {
            if link.is_leaf() {
                let block = self.visit_leaf(stripes, link, fetched, slice.counters);
                let asked = beam.enter_triangles(simd, &block, t_max);
                if asked != 0 && packet.test_block(slice, questions, (block, asked)) {
                    if questions.open == 0 {
                        return;
                    }
                    t_max = farthest(questions);
                }
            } else {
                let (planes, links) = stripes.node(link);
                let (keys, hits) = beam.intersect_children(simd, planes, t_max);
                let below = stack.descend(simd, Sorting::ByDistance, &keys, hits, links, &mut top);
                if let Some(nearest) = below {
                    if hits & (hits - 1) != 0 {
                        stripes.prefetch(stack.peek(top));
                    }
                    link = nearest;
                    continue;
                }
            }
            match stack.next(&mut top, key_limit(t_max)) {
                Some(next) => link = next,
                None => return,
            }
        }
    }
}

/// Where the last of the rays ends that have no final answer.
#[inline(always)]
fn farthest<Q: Query>(questions: &Questions<Q>) -> f32 {
    let mut farthest = f32::NEG_INFINITY;
    for (lane, query) in questions.queries.iter().enumerate() {
        let t_max = if questions.open >> lane & 1 == 1 { query.t_max() } else { farthest };
        farthest = if t_max > farthest { t_max } else { farthest };
    }
    // Below zero there are no hits, and no keys.
    if farthest > 0.0 { farthest } else { 0.0 }
}
