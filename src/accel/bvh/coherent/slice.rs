//! A slice of rays: narrowed to its shaft, cut into packets, and what is not coherent left over.

use fearless_simd::Simd;

use super::compress::{Branches, Step};
use super::cut::{Cut, RAYS};
use super::packet::Walk;
use super::place::Places;
use super::{Coherent, Scratch, Start, With, adaptive};
use crate::accel::{Batch, Counters, Query, Shot, Traverse};
use crate::geom::{Heading, Shaft};
use crate::math::{Ray, Vec3};

/// Packets whose slopes differ by more are walked ray by ray.
const MOST_SPREAD: f32 = 0.5;
/// And groups of fewer rays.
const FEW: usize = 4;

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
        let rays = batch.rays();
        scratch.singles.clear();
        let before = scratch.branches.len();
        match self.places().filter(|_| rays.len() >= FEW) {
            None => scratch.singles.extend(0..rays.len() as u32),
            Some(places) => {
                let shaft = self.shaft_of(simd, batch);
                let holds = |region: &Shaft| self.is_within(batch, shaft.as_ref(), region);
                let (branches, mut from) = self.around(&scratch.regions, holds);
                if let (Some(step), Some(shaft)) = (from, &shaft) {
                    let pool = (branches, &mut scratch.branches);
                    from = self.narrow((places, step), pool, shaft, counters);
                }
                if let Some(from) = from {
                    let start = (places, branches, from);
                    if self.with == With::Single {
                        self.shoot_each::<S, Q, C>(simd, start, batch, answers, scratch, counters);
                    } else {
                        self.shoot_packets::<S, Q, C>(
                            simd, start, batch, answers, scratch, counters,
                        );
                    }
                } else {
                    // The slice's region has no leaf.
                    for (answer, ray) in answers.iter_mut().zip(rays) {
                        *answer = Q::new(ray).answer();
                    }
                }
            }
        }
        scratch.peak = scratch.peak.max(scratch.branches.len());
        scratch.branches.truncate(before);
        for &index in &scratch.singles {
            let index = index as usize;
            let mut query = Q::new(&rays[index]);
            let shot = Shot::new(&rays[index], index, batch.filter());
            self.bvh.walk(simd, &shot, &mut query, &mut scratch.single, counters);
            answers[index] = query.answer();
        }
    }

    /// A region that holds the whole slice, if it is to be narrowed to one.
    #[inline(always)]
    fn shaft_of<S: Simd>(&self, simd: S, batch: &Batch<'_>) -> Option<Shaft> {
        let rays = batch.rays();
        if self.start == Start::Root || !rays.iter().all(|ray| self.knows(ray)) {
            return None;
        }
        let row = batch.grid().map_or(rays.len(), |(width, _, each)| width * each);
        let given = || {
            let given = batch.shaft().filter(|shaft| rays.iter().all(|ray| shaft.holds(ray)));
            given.cloned()
        };
        Shaft::of_rays(simd, rays, row).or_else(given)
    }

    /// Whether a region holds the whole slice, of which a shaft may be known.
    fn is_within(&self, batch: &Batch<'_>, shaft: Option<&Shaft>, region: &Shaft) -> bool {
        let contained = shaft.is_some_and(|shaft| region.contains(shaft));
        contained || batch.rays().iter().all(|ray| self.knows(ray) && region.holds(ray))
    }

    /// Whether the boxes are good for a ray.
    #[inline(always)]
    pub(super) fn knows(&self, ray: &Ray) -> bool {
        self.bvh.parts.is_none_or(|parts| parts.covers(ray))
    }

    /// Walks the packets of a slice; leaves a list of the rays that none took up.
    #[inline(always)]
    fn shoot_packets<S: Simd, Q: Query, C: Counters>(
        &self,
        simd: S,
        (places, view, from): (Places<'_>, &[super::Branch], Step),
        batch: &Batch<'_>,
        answers: &mut [Q::Answer],
        Scratch {
            single, packet, members, group, singles, branches, peak, starts, ..
        }: &mut Scratch,
        counters: &mut C,
    ) {
        let (rays, cut) = (batch.rays(), Cut::new(batch, self.size));
        starts.clear();
        starts.resize(cut.packets(), Some(from));
        if self.start == Start::EntryPoints {
            adaptive::entry_points(simd, places, from, &cut, starts, counters);
        }
        let mut queries: Vec<Q> = Vec::with_capacity(RAYS);
        for number in 0..cut.packets() {
            let corners = cut.list(number, members);
            if members.len() < FEW || !run_alike(corners) {
                singles.extend_from_slice(members);
                continue;
            }
            members.retain(|&index| {
                let ray = &rays[index as usize];
                let kept = ray.t_max() > ray.t_min() && self.knows(ray);
                if !kept {
                    singles.push(index);
                }
                kept
            });
            packet.fill(batch, members);
            let shaft = packet.shaft(simd, corners);
            let Some(shaft) = shaft.filter(|shaft| shaft.spread() <= MOST_SPREAD) else {
                singles.extend_from_slice(members);
                continue;
            };
            // One more tree, upon that of the slice.
            let of_slice = branches.len();
            let (mut start, mut culls) = (starts[number], true);
            if matches!(self.start, Start::Compressed { per_packet: true, .. }) {
                start = self.narrow((places, from), (view, branches), &shaft, counters);
                *peak = branches.len().max(*peak);
                culls = false;
            }
            let heading = |index: u32| Heading::of(rays[index as usize].direction()).number();
            let mut counts = [0_usize; Heading::COUNT];
            for &index in &*members {
                counts[heading(index)] += 1;
            }
            for (number, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
                if count < members.len() {
                    group.clear();
                    group.extend(members.iter().filter(|&&index| heading(index) == number));
                    if count < FEW {
                        singles.extend_from_slice(group);
                        continue;
                    }
                    packet.fill(batch, group);
                }
                let mut walk = Walk {
                    simd,
                    places,
                    branches: Branches { view, own: branches },
                    batch,
                    queries: &mut queries,
                    fetched: &mut single.fetched,
                    partitions: self.with == With::Partition,
                    culls,
                };
                packet.walk(&mut walk, start, &mut shaft.clone(), counters);
                packet.answer(&queries, answers);
            }
            branches.truncate(of_slice);
        }
    }
}

/// Whether the rays at a packet's corners run within some 25 degrees of one another.
#[inline(always)]
fn run_alike([a, b, c, d]: [Vec3; 4]) -> bool {
    [b, c, d].iter().all(|other| {
        let dot = a.dot(*other);
        dot > 0.0 && dot * dot > 0.8 * a.length_squared() * other.length_squared()
    })
}
