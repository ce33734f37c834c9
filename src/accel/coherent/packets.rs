//! From a slice to packets, and what is done with rays that do not run side by side.

use std::ops::Range;

use fearless_simd::Simd;

use super::cut::{Cut, RAYS};
use super::rays::Rays;
use crate::accel::{Batch, Counters, PreparedRay, Query, Traverse};
use crate::geom::{Heading, Shaft};
use crate::math::{Ray, Vec3};

/// Packets whose slopes differ by more are walked ray by ray.
const MOST_SPREAD: f32 = 0.5;
/// And groups of fewer rays.
pub const FEW: usize = 4;

/// What packets are walked through.
pub trait Packets<Q: Query, C: Counters> {
    /// Whether a ray may be walked with others.
    fn knows(&self, ray: &Ray) -> bool;

    /// Begins with the rays of a shaft, or wants them in four parts; they are still to be prepared.
    fn begin(&mut self, rays: &Rays, shaft: &Shaft, counters: &mut C) -> Plan;

    /// Walks rays of that shaft that all head the same way, still to be prepared. The
    /// answers are left in the queries, which are new.
    fn walk(
        &mut self,
        rays: &mut Rays,
        shaft: &Shaft,
        batch: &Batch<'_>,
        queries: &mut [Q],
        counters: &mut C,
    );
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
pub struct Pool {
    rays: Rays,
    /// Rays of the packet at hand, those that head the same way, and those to be walked one by one.
    members: Vec<u32>,
    group: Vec<u32>,
    singles: Vec<u32>,
    /// Parts of the packet that are still to be looked at.
    parts: Vec<Range<usize>>,
}

impl Default for Pool {
    fn default() -> Self {
        Self {
            rays: Rays::default(),
            members: Vec::with_capacity(RAYS),
            group: Vec::with_capacity(RAYS),
            singles: Vec::new(),
            parts: Vec::new(),
        }
    }
}

/// Walks the packets of a slice, each of at most so many rays; leaves a list of the rays that none
/// took up.
#[inline(always)]
pub fn shoot_packets<S: Simd, Q: Query, C: Counters, P: Packets<Q, C>>(
    simd: S,
    (batch, most): (&Batch<'_>, usize),
    answers: &mut [Q::Answer],
    pool: &mut Pool,
    packets: &mut P,
    counters: &mut C,
) {
    let (slice, cut) = (batch.rays(), Cut::new(batch, most));
    let Pool { rays, members, group, singles, parts } = pool;
    let mut queries: Vec<Q> = Vec::with_capacity(RAYS);
    for number in 0..cut.packets() {
        let corners = cut.list(number, members);
        if members.len() < FEW || !run_alike(corners) {
            singles.extend_from_slice(members);
            continue;
        }
        // A plain loop: the closure of `retain` would be called for each ray.
        let mut kept = 0;
        for at in 0..members.len() {
            let index = members[at];
            let ray = &slice[index as usize];
            if ray.t_max() > ray.t_min() && packets.knows(ray) {
                members[kept] = index;
                kept += 1;
            } else {
                singles.push(index);
            }
        }
        members.truncate(kept);
        parts.push(0..members.len());
        while let Some(part) = parts.pop() {
            let length = part.len();
            let whole = length == members.len();
            let corners = if whole { corners } else { corners_of(slice, &members[part.clone()]) };
            rays.fill(batch, &members[part.clone()]);
            let shaft = if length < FEW { None } else { rays.shaft(simd, corners) };
            let Some(shaft) = shaft.filter(|shaft| shaft.spread() <= MOST_SPREAD) else {
                singles.extend_from_slice(&members[part]);
                continue;
            };
            if packets.begin(rays, &shaft, counters) == Plan::Split {
                let quarter = length.div_ceil(4).max(1);
                parts
                    .extend(part.clone().step_by(quarter).map(|at| at..part.end.min(at + quarter)));
                continue;
            }
            let mut headings = Headings::of(slice, &members[part.clone()], &shaft);
            while let Some((heading, count)) = headings.pop() {
                if count < length {
                    Headings::list(slice, &members[part.clone()], heading, group);
                    if count < FEW {
                        singles.extend_from_slice(group);
                        continue;
                    }
                    rays.fill(batch, group);
                }
                rays.ask(batch, &mut queries);
                packets.walk(rays, &shaft, batch, &mut queries, counters);
                rays.answer(&queries, answers);
            }
        }
    }
}

/// How many rays head each way.
struct Headings([usize; Heading::COUNT]);

impl Headings {
    /// Those of rays that a shaft was made of, which mostly tells.
    #[inline(always)]
    fn of(slice: &[Ray], members: &[u32], shaft: &Shaft) -> Self {
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

/// Walks all rays of a slice by packets, whichever way they go; those that are not known, and those
/// of a packet of few, are left in the list of rays that none took up.
#[inline(always)]
pub fn shoot_mixed<Q: Query, C: Counters>(
    (batch, most): (&Batch<'_>, usize),
    answers: &mut [Q::Answer],
    Pool { rays, members, singles, .. }: &mut Pool,
    knows: impl Fn(&Ray) -> bool,
    mut walk: impl FnMut(&mut Rays, &mut [Q], &mut C),
    counters: &mut C,
) {
    let cut = Cut::new(batch, most);
    let mut queries: Vec<Q> = Vec::with_capacity(RAYS);
    for number in 0..cut.packets() {
        cut.list(number, members);
        members.retain(|&index| {
            let kept = knows(&batch.rays()[index as usize]);
            if !kept {
                singles.push(index);
            }
            kept
        });
        if members.len() < FEW {
            singles.extend_from_slice(members);
            continue;
        }
        rays.fill_mixed(batch, members);
        rays.ask(batch, &mut queries);
        walk(rays, &mut queries, counters);
        rays.answer(&queries, answers);
    }
}

impl Pool {
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
}

/// Walks the rays that are left over one after the other.
#[inline(always)]
pub fn shoot_singles<S: Simd, T: Traverse, Q: Query, C: Counters>(
    simd: S,
    (structure, scratch): (&T, &mut T::Scratch),
    batch: &Batch<'_>,
    answers: &mut [Q::Answer],
    pool: &Pool,
    counters: &mut C,
) {
    for &index in &pool.singles {
        let index = index as usize;
        let ray = &batch.rays()[index];
        let mut query = Q::new(ray);
        let prepared = PreparedRay::new(ray, index, batch.filter());
        structure.walk(simd, &prepared, &mut query, scratch, counters);
        answers[index] = query.answer();
    }
}

/// Directions at the corners of rays that are listed in Morton order.
fn corners_of(slice: &[Ray], members: &[u32]) -> [Vec3; 4] {
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
