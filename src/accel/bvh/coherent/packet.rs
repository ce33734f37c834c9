//! A packet: rays side by side, and the walk of all of them through the hierarchy.

use fearless_simd::{Simd, SimdBase};

use super::super::binary::WIDTH;
use super::super::leaves::Fetched;
use super::super::link::Link;
use super::super::sah;
use super::compress::{Branches, Step};
use super::cut::RAYS;
use super::place::Places;
use crate::accel::{Batch, ClosestHit, Counters, Event, Query, Terms};
use crate::geom::{FilterTriangle, Heading, RayBundle, Shaft, Triangle, TriangleBlock};
use crate::math::{Aabb, TriangleId, Vec3};

/// Rays of a bundle.
const LANES: usize = RayBundle::LANES;
/// Bundles of a packet.
pub const BUNDLES: usize = RAYS / LANES;
/// What is put aside: two children at most for each node on the way, of which one is taken up.
const STACK: usize = sah::MAX_DEPTH + 2;

/// Which of a packet's bundles are under way: from one place of its order up to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Active {
    first: u8,
    end: u8,
}

/// A packet under way; all of its rays go the same way along each axis.
pub struct Packet {
    bundles: Box<[RayBundle]>,
    /// How many bundles there are.
    count: usize,
    /// Numbers of the rays in the slice.
    members: Vec<u32>,
    heading: Heading,
    /// Bundles in the order in which they are asked; only partitions change it.
    order: [u8; BUNDLES],
    /// Of each bundle the rays that enter the leaf at hand.
    entered: [u8; BUNDLES],
    stack: Box<[(Step, Active); STACK]>,
}

/// What a walk is in.
pub struct Walk<'a, S, Q> {
    pub simd: S,
    pub places: Places<'a>,
    pub branches: Branches<'a>,
    pub batch: &'a Batch<'a>,
    /// Of the packet's rays, in its order.
    pub queries: &'a mut Vec<Q>,
    pub fetched: &'a mut Fetched<WIDTH>,
    /// Whether the rays are partitioned at each node.
    pub partitions: bool,
    /// Whether boxes are held against the shaft.
    pub culls: bool,
}

impl Packet {
    pub fn new() -> Self {
        Self {
            bundles: vec![RayBundle::EMPTY; BUNDLES].into_boxed_slice(),
            count: 0,
            members: Vec::with_capacity(RAYS),
            heading: Heading::default(),
            order: [0; BUNDLES],
            entered: [0; BUNDLES],
            stack: Box::new([(Step::ROOT, Active { first: 0, end: 0 }); STACK]),
        }
    }

    /// Takes up rays of a slice.
    #[inline(always)]
    pub fn fill(&mut self, batch: &Batch<'_>, members: &[u32]) {
        self.members.clear();
        self.members.extend_from_slice(members);
        self.count = members.len().div_ceil(LANES);
        let Some(&first) = members.first() else { return };
        self.heading = Heading::of(batch.rays()[first as usize].direction());
        self.bundles[self.count - 1] = RayBundle::EMPTY;
        for (i, &member) in members.iter().enumerate() {
            self.bundles[i / LANES].put(i % LANES, &batch.rays()[member as usize]);
        }
        self.order = std::array::from_fn(|i| i as u8);
    }

    /// Prepares its rays, which must all head the same way.
    #[inline(always)]
    fn prepare<S: Simd>(&mut self, simd: S) {
        for bundle in &mut self.bundles[..self.count] {
            bundle.prepare(simd, self.heading);
        }
    }

    /// The region of its rays; see [`Shaft::of_rays`].
    #[inline(always)]
    pub fn shaft<S: Simd>(&self, simd: S, corners: [Vec3; 4]) -> Option<Shaft> {
        Shaft::of_bundles(simd, &self.bundles[..self.count], corners)
    }

    /// Walks from a place down. The answers are left in the queries.
    #[inline(always)]
    pub fn walk<S: Simd, Q: Query, C: Counters>(
        &mut self,
        walk: &mut Walk<'_, S, Q>,
        start: Option<Step>,
        shaft: &mut Shaft,
        counters: &mut C,
    ) {
        self.prepare(walk.simd);
        walk.queries.clear();
        let rays = walk.batch.rays();
        walk.queries.extend(self.members.iter().map(|&i| Q::new(&rays[i as usize])));
        // Nothing to meet: nothing is hit.
        let Some(start) = start else { return };
        let mut waiting = self.members.len();
        let mut nearer = false;
        self.stack[0] = (start, Active { first: 0, end: self.count as u8 });
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (step, active) = self.stack[top];
            let bounds = walk.places.bounds(step.place);
            if nearer && active.end > active.first + 1 {
                self.end_shaft(walk.simd, shaft);
                nearer = false;
            }
            let Some(active) = self.enter(walk, &bounds, active, shaft, counters) else {
                continue;
            };
            let Some([first, second]) = walk.branches.below(walk.places, step) else {
                self.mark(walk.simd, &bounds, active, counters);
                let found = self.test_leaf(walk, walk.places.link(step.place), active, counters);
                nearer |= found > 0;
                if Q::ANY {
                    waiting -= found;
                    if waiting == 0 {
                        return;
                    }
                }
                continue;
            };
            counters.count(Event::InnerNode);
            counters.count(Event::Push);
            // The nearer one on top: that whose middle comes first along the rays.
            let apart = walk.places.middle(second.place) - walk.places.middle(first.place);
            let second_is_nearer = usize::from(apart.dot(shaft.axis()) < 0.0);
            self.stack[top + 1 - second_is_nearer] = (first, active);
            self.stack[top + second_is_nearer] = (second, active);
            top += 2;
        }
    }

    /// Those bundles of which a ray enters a box.
    ///
    /// I. Wald, S. Boulos and P. Shirley, "Ray tracing deformable scenes using dynamic bounding
    /// volume hierarchies", 2007: the first that was active in the parent is asked first, and if it
    /// enters, all go down with it; then the shaft is; and only then the others, until one enters.
    /// R. Overbeck, R. Ramamoorthy and W. R. Mark, "Large ray packets for real-time Whitted ray
    /// tracing", 2008: those that enter are moved to the front, and the others stay behind.
    #[inline(always)]
    fn enter<S: Simd, Q: Query, C: Counters>(
        &mut self,
        walk: &Walk<'_, S, Q>,
        bounds: &Aabb,
        active: Active,
        shaft: &Shaft,
        counters: &mut C,
    ) -> Option<Active> {
        let Active { first, end } = active;
        let mut kept = first;
        for at in first..end {
            let bundle = self.order[usize::from(at)];
            counters.count(Event::BoxTest);
            let enters =
                self.bundles[usize::from(bundle)].enter(walk.simd, bounds, self.heading.negative)
                    != 0;
            if enters {
                if !walk.partitions {
                    return Some(Active { first: at, end });
                }
                self.order.swap(usize::from(at), usize::from(kept));
                kept += 1;
            } else if at == first && walk.culls && shaft.misses(walk.simd, bounds) {
                return None;
            }
        }
        (kept > first).then_some(Active { first, end: kept })
    }

    /// Finds the rays that enter a leaf's box.
    #[inline(always)]
    fn mark<S: Simd, C: Counters>(
        &mut self,
        simd: S,
        bounds: &Aabb,
        Active { first, end }: Active,
        counters: &mut C,
    ) {
        counters.add(Event::BoxTest, u64::from(end - first));
        for &bundle in &self.order[usize::from(first)..usize::from(end)] {
            let bundle = usize::from(bundle);
            self.entered[bundle] =
                self.bundles[bundle].enter(simd, bounds, self.heading.negative) as u8;
        }
    }

    /// Tests a leaf's triangles; how many rays ended, or came nearer.
    #[inline(always)]
    fn test_leaf<S: Simd, Q: Query, C: Counters>(
        &mut self,
        walk: &mut Walk<'_, S, Q>,
        link: Link,
        Active { first, end }: Active,
        counters: &mut C,
    ) -> usize {
        let mut found = 0;
        let block = walk.places.bvh.block(link.place(), walk.fetched, counters);
        let (block, order) =
            (TriangleBlock { vertices: *block.vertices, ids: *block.ids }, self.order);
        let block = block.parts();
        for (lane, &id) in block.ids.iter().enumerate() {
            if id == TriangleId::NONE {
                break;
            }
            let triangle = block.triangle(lane);
            let filter = FilterTriangle::new(walk.simd, &triangle);
            for &bundle in &order[usize::from(first)..usize::from(end)] {
                let bundle = usize::from(bundle);
                let entered = u32::from(self.entered[bundle]);
                if entered == 0 {
                    continue;
                }
                counters.count(Event::TriangleTest);
                if C::COUNTS {
                    counters.add(Event::TriangleLane, u64::from(entered.count_ones()));
                }
                let lanes = self.bundles[bundle].candidates(walk.simd, &filter) & entered;
                if lanes != 0 {
                    counters.add(Event::Verdict, u64::from(lanes.count_ones()));
                    found += self.judge(walk, bundle, lanes, id, &triangle);
                }
            }
        }
        found
    }

    /// Lets the verdict speak over a triangle and those rays of a bundle that may hit it, and offers
    /// what it finds; how many rays ended, or came nearer.
    #[inline(always)]
    fn judge<S: Simd, Q: Query>(
        &mut self,
        walk: &mut Walk<'_, S, Q>,
        number: usize,
        lanes: u32,
        triangle: TriangleId,
        corners: &Triangle,
    ) -> usize {
        let mut found = 0;
        let bundle = &mut self.bundles[number];
        let verdicts = bundle.verdicts(walk.simd, self.heading, corners, lanes);
        let mut hits = verdicts.hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let at = number * LANES + lane;
            let index = self.members[at] as usize;
            let t_min = walk.batch.rays()[index].t_min();
            let terms = Terms { t_min, index, filter: walk.batch.filter() };
            let (t, u, v) = (verdicts.t[lane], verdicts.u[lane], verdicts.v[lane]);
            let query = &mut walk.queries[at];
            let before = query.t_max();
            if query.offer(&terms, ClosestHit { t, u, v, triangle }).is_break() {
                bundle.end_at(lane, f32::NEG_INFINITY);
                self.entered[number] &= !(1 << lane);
                found += 1;
            } else if query.t_max() < before {
                bundle.end_at(lane, query.t_max());
                found += 1;
            }
        }
        found
    }

    /// Ends the shaft where the last of the rays does.
    #[inline(always)]
    fn end_shaft<S: Simd>(&self, simd: S, shaft: &mut Shaft) {
        let mut end = self.bundles[0].end_along(simd, shaft.axis());
        for bundle in &self.bundles[1..self.count] {
            end = end.max(bundle.end_along(simd, shaft.axis()));
        }
        let end = end.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
        shaft.end_at(end);
    }

    /// The answers of its rays, by their numbers in the slice.
    #[inline(always)]
    pub fn answer<Q: Query>(&self, queries: &[Q], answers: &mut [Q::Answer]) {
        for (&member, query) in self.members.iter().zip(queries) {
            answers[member as usize] = query.answer();
        }
    }
}
