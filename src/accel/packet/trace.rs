//! From a slice to packets, and what is done with rays that do not run side by side.

use std::ops::Range;

use fearless_simd::Simd;

use super::layout::{PacketLayout, RAYS};
use super::rays::{PacketContext, PacketRays};
use crate::accel::{Counters, Query, SliceContext, WalkRay};
use crate::geom::{Heading, Shaft};
use crate::math::{Ray, Vec3};

/// Packets whose slopes differ by more are walked ray by ray.
const MOST_SPREAD: f32 = 0.5;
/// And groups of fewer rays.
pub const FEW: usize = 4;

/// What packets are walked through.
pub trait WalkPacket<S: Simd, Q: Query, C: Counters> {
    /// Whether a ray may be walked with others.
    fn accepts(&self, ray: &Ray) -> bool;

    /// Begins with the rays of a shaft, or wants them in four parts; they are still to be prepared.
    fn begin(&mut self, simd: S, rays: &PacketRays, shaft: &Shaft, counters: &mut C) -> Plan;

    /// Walks rays of that shaft that all head the same way, still to be prepared. The
    /// answers are left in the queries, which are new.
    fn walk(&mut self, context: PacketContext<'_, S, Q, C>, shaft: &Shaft);
}

/// What to do with a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plan {
    /// Walk it.
    Walk,
    /// Divide it.
    Split,
}

/// Lists of rays that a thread makes.
pub struct RayLists {
    rays: PacketRays,
    /// Rays of the packet at hand, those that head the same way, and those to be walked one by one.
    members: Vec<u32>,
    group: Vec<u32>,
    singles: Vec<u32>,
    /// Parts of the packet that are still to be looked at.
    parts: Vec<Range<usize>>,
}

impl Default for RayLists {
    fn default() -> Self {
        Self {
            rays: PacketRays::default(),
            members: Vec::with_capacity(RAYS),
            group: Vec::with_capacity(RAYS),
            singles: Vec::new(),
            parts: Vec::new(),
        }
    }
}

/// Traces the packets of a slice, each of at most so many rays; leaves a list of the rays that none
/// took up.
#[inline(always)]
pub fn trace_packets<S: Simd, Q: Query, C: Counters, P: WalkPacket<S, Q, C>>(
    slice: &mut SliceContext<'_, S, Q, C>,
    most: usize,
    lists: &mut RayLists,
    packets: &mut P,
) {
    let layout = PacketLayout::new(&slice.batch, most);
    let mut queries: Vec<Q> = Vec::with_capacity(RAYS);
    for number in 0..layout.count() {
        let corners = layout.list(number, &mut lists.members);
        if lists.members.len() < FEW || !run_alike(corners) {
            lists.singles.extend_from_slice(&lists.members);
            continue;
        }
        lists.keep_accepted(
            slice.batch.rays(),
            #[inline(always)]
            |ray| ray.t_max() > ray.t_min() && packets.accepts(ray),
        );
        lists.parts.push(0..lists.members.len());
        while let Some(part) = lists.parts.pop() {
            trace_part(slice, (part, corners), lists, packets, &mut queries);
        }
    }
}

/// Traces a part of the packet at hand, all of whose corners have the directions `corners`: by
/// packets of one heading each, or leaves it in smaller parts, or its rays to be walked one by one.
#[inline(always)]
fn trace_part<S: Simd, Q: Query, C: Counters, P: WalkPacket<S, Q, C>>(
    slice: &mut SliceContext<'_, S, Q, C>,
    (part, corners): (Range<usize>, [Vec3; 4]),
    RayLists { rays, members, group, singles, parts }: &mut RayLists,
    packets: &mut P,
    queries: &mut Vec<Q>,
) {
    let SliceContext { simd, batch, answers, counters } = slice;
    let (simd, all, length) = (*simd, batch.rays(), part.len());
    let whole = length == members.len();
    let corners = if whole { corners } else { find_corners(all, &members[part.clone()]) };
    rays.fill(batch, &members[part.clone()]);
    let shaft = if length < FEW { None } else { rays.make_shaft(simd, corners) };
    let Some(shaft) = shaft.filter(|shaft| shaft.spread() <= MOST_SPREAD) else {
        singles.extend_from_slice(&members[part]);
        return;
    };
    if packets.begin(simd, rays, &shaft, counters) == Plan::Split {
        let quarter = length.div_ceil(4).max(1);
        parts.extend(part.clone().step_by(quarter).map(|at| at..part.end.min(at + quarter)));
        return;
    }
    let mut headings = Headings::count(all, &members[part.clone()], &shaft);
    while let Some((heading, count)) = headings.pop() {
        if count < length {
            Headings::list(all, &members[part.clone()], heading, group);
            if count < FEW {
                singles.extend_from_slice(group);
                continue;
            }
            rays.fill(batch, group);
        }
        rays.fill_queries(batch, queries);
        let counters = &mut **counters;
        let context = PacketContext { simd, batch: *batch, rays, queries, counters };
        packets.walk(context, &shaft);
        rays.write_answers(queries, answers);
    }
}

/// How many rays head each way.
struct Headings([usize; Heading::COUNT]);

impl Headings {
    /// Counts rays that a shaft was made of, which mostly tells.
    #[inline(always)]
    fn count(slice: &[Ray], members: &[u32], shaft: &Shaft) -> Self {
        let mut counts = [0; Heading::COUNT];
        if let Some(heading) = shaft.heading() {
            counts[heading.number()] = members.len();
            return Self(counts);
        }
        for &index in members {
            counts[Self::number(slice, index)] += 1;
        }
        Self(counts)
    }

    #[inline(always)]
    fn number(slice: &[Ray], index: u32) -> usize {
        Heading::of(slice[index as usize].direction()).number()
    }

    /// A way that was not asked for yet, and how many head it.
    #[inline(always)]
    fn pop(&mut self) -> Option<(usize, usize)> {
        let heading = self.0.iter().position(|&count| count > 0)?;
        Some((heading, std::mem::take(&mut self.0[heading])))
    }

    /// Lists those that head a way.
    fn list(slice: &[Ray], members: &[u32], heading: usize, group: &mut Vec<u32>) {
        group.clear();
        group.extend(members.iter().filter(|&&index| Self::number(slice, index) == heading));
    }
}

/// Traces all rays of a slice by packets, whichever way they go; those that are not accepted, and
/// those of a packet of few, are left in the list of rays that none took up.
#[inline(always)]
pub fn trace_mixed_packets<S: Simd, Q: Query, C: Counters>(
    slice: &mut SliceContext<'_, S, Q, C>,
    most: usize,
    lists: &mut RayLists,
    accepts: impl Fn(&Ray) -> bool,
    mut walk: impl FnMut(PacketContext<'_, S, Q, C>),
) {
    let SliceContext { simd, batch, answers, counters } = slice;
    let layout = PacketLayout::new(batch, most);
    let mut queries: Vec<Q> = Vec::with_capacity(RAYS);
    for number in 0..layout.count() {
        layout.list(number, &mut lists.members);
        lists.keep_accepted(batch.rays(), &accepts);
        let RayLists { rays, members, singles, .. } = lists;
        if members.len() < FEW {
            singles.extend_from_slice(members);
            continue;
        }
        rays.fill_mixed(batch, members);
        rays.fill_queries(batch, &mut queries);
        let (queries, counters) = (&mut queries, &mut **counters);
        walk(PacketContext { simd: *simd, batch: *batch, rays, queries, counters });
        rays.write_answers(queries, answers);
    }
}

impl RayLists {
    /// Begins with a slice.
    pub fn clear(&mut self) {
        self.singles.clear();
    }

    /// Leaves a ray to be walked alone.
    pub fn leave(&mut self, ray: usize) {
        self.singles.push(ray as u32);
    }

    /// Leaves all rays of a slice to be walked one by one.
    pub fn leave_all(&mut self, rays: usize) {
        self.singles.extend(0..rays as u32);
    }

    /// Keeps those rays of the packet at hand that are accepted; the others are to be walked alone.
    #[inline(always)]
    fn keep_accepted(&mut self, slice: &[Ray], accepts: impl Fn(&Ray) -> bool) {
        // A plain loop: the closure of `retain` would be called for each ray.
        let mut kept = 0;
        for at in 0..self.members.len() {
            let index = self.members[at];
            if accepts(&slice[index as usize]) {
                self.members[kept] = index;
                kept += 1;
            } else {
                self.singles.push(index);
            }
        }
        self.members.truncate(kept);
    }
}

/// Walks the rays that are left over one after the other.
#[inline(always)]
pub fn trace_singles<S: Simd, T: WalkRay, Q: Query, C: Counters>(
    slice: &mut SliceContext<'_, S, Q, C>,
    lists: &RayLists,
    (structure, scratch): (&T, &mut T::Scratch),
) {
    for &index in &lists.singles {
        slice.answer(
            index as usize,
            #[inline(always)]
            |context| structure.walk(context, scratch),
        );
    }
}

/// Finds the directions at the corners of rays that are listed in Morton order.
fn find_corners(slice: &[Ray], members: &[u32]) -> [Vec3; 4] {
    let last = members.len().saturating_sub(1);
    [0, last / 3, last - last / 3, last]
        .map(|i| members.get(i).map_or(Vec3::ZERO, |&index| slice[index as usize].direction()))
}

/// Whether the rays at a packet's corners run within some 25 degrees of one another.
#[inline(always)]
fn run_alike([a, b, c, d]: [Vec3; 4]) -> bool {
    [b, c, d].iter().all(|other| {
        let dot = a.dot(*other);
        dot > 0.0 && dot * dot > 0.8 * a.length_squared() * other.length_squared()
    })
}
