//! Few triangles: all of them, one after the other, against sixteen rays side by side.
//!
//! Below some dozens of triangles no tree pays: to go down one costs a ray more than to be held
//! against everything, if the others beside it share the work. A filter in single precision
//! ([`crate::geom::planes`]) says for each ray which triangles it may hit, and from which `t` on.
//! The exact test is then asked about pairs of a ray and a triangle, a pair each lane: first about
//! each ray's likeliest triangle, the nearest that is surely ahead, and then about what else may
//! change the answer, which is little.

use std::ops::ControlFlow;

use fearless_simd::{Select, Simd, SimdBase};

use super::{
    BuildInput, BuildReport, Built, ClosestHit, Counters, Event, HitCriteria, MemoryReport, Phases,
    Query, SliceContext, Structure, Traverse,
};
use crate::geom::{FilterLanes, PairHits, PairTriangle, RayLanes, TrianglePlanes, TriangleSource};
use crate::math::{Ray, TriangleId};

/// Rays side by side.
const LANES: usize = RayLanes::LANES;
/// Triangles after which what was found ends rays, or bounds them; as many as there are bits.
const GROUP: usize = 32;
/// Stands for no triangle of a group.
const NONE: u32 = u32::MAX;

/// All triangles, prepared.
pub struct Flat {
    planes: Vec<TrianglePlanes>,
    pairs: Vec<PairTriangle>,
    /// See [`TrianglePlanes::reach`].
    reach: f32,
    built: Built,
}

/// Scratch of one thread: what is known of sixteen rays and a group of triangles.
pub struct Scratch {
    rays: RayLanes,
    /// For each vector's lanes, triangle and lane, the `t` from which on it may be hit.
    firsts: [f32; LANES * GROUP],
    /// Of each ray, a bit for each triangle that it may hit and was not asked about.
    candidates: [u32; LANES],
    /// Of each ray the likeliest.
    likeliest: [u32; LANES],
    /// What the exact test found.
    found: PairHits,
}

/// Sixteen rays, and what is asked of them.
struct Packet<'a, Q> {
    /// Those that have no final answer, a bit each.
    open: u32,
    rays: &'a [Ray],
    queries: [Q; LANES],
    /// Number of the first in the batch.
    from: usize,
}

impl Flat {
    /// The most triangles that are faster without a tree.
    pub const LIMIT: usize = 64;

    /// Whether these triangles are few, and of a usual size.
    pub fn suits(source: &dyn TriangleSource) -> bool {
        (1..=Self::LIMIT).contains(&source.len()) && TrianglePlanes::suit(find_reach(source))
    }

    /// Prepares all triangles.
    pub fn build(input: &BuildInput<'_>) -> Self {
        let mut phases = Phases::start();
        let count = input.source.len();
        let triangles = || (0..count).map(|i| input.source.triangle(TriangleId::from_index(i)));
        let planes = triangles().map(|triangle| TrianglePlanes::new(&triangle)).collect();
        let pairs = triangles().map(|triangle| PairTriangle::new(&triangle)).collect();
        let reach = find_reach(&*input.source);
        phases.end("triangles");
        let report = BuildReport {
            phases: phases.ended(),
            triangles: count,
            leaves: 1,
            mean_leaf: count as f64,
            sah_cost: count as f64,
            ..BuildReport::default()
        };
        Self { planes, pairs, reach, built: Built { level: input.level, report } }
    }

    /// Finds what the rays may hit of the group of triangles that begins there.
    #[inline(always)]
    fn filter<S: Simd, Q: Query>(
        &self,
        simd: S,
        group: &[TrianglePlanes],
        Scratch { rays, firsts, candidates, likeliest, .. }: &mut Scratch,
    ) {
        let len = S::f32s::LEN;
        for from in (0..LANES).step_by(len) {
            let lanes = FilterLanes::new(simd, rays, from, self.reach);
            let firsts = &mut firsts[from * GROUP..(from + len) * GROUP];
            let [t_min, t_max] = lanes.spans();
            let mut passed = S::u32s::splat(simd, 0);
            let mut best = S::u32s::splat(simd, NONE);
            let mut nearest = t_max;
            let nowhere = S::f32s::splat(simd, f32::NEG_INFINITY);
            for ((number, triangle), row) in
                (0_u32..).zip(group).zip(firsts.chunks_exact_mut(S::f32s::LEN))
            {
                let found = lanes.find_candidates(simd, triangle);
                let [first, last] = found.t;
                found.known.select(first, nowhere).store_slice(row);
                let bit = S::u32s::splat(simd, 1 << number);
                passed = found.passes.select(passed | bit, passed);
                let likely = found.passes & found.known & first.simd_gt(t_min) & if Q::ANY {
                    last.simd_lt(t_max)
                } else {
                    first.simd_lt(nearest)
                };
                best = likely.select(S::u32s::splat(simd, number), best);
                if !Q::ANY {
                    nearest = likely.select(first, nearest);
                }
            }
            passed.store_slice(&mut candidates[from..from + len]);
            best.store_slice(&mut likeliest[from..from + len]);
        }
    }

    /// Asks the exact test about the candidates of a group, whose first triangle has this number.
    #[inline(always)]
    fn test_candidates<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        packet: &mut Packet<'_, Q>,
        scratch: &mut Scratch,
        first: usize,
    ) {
        let mut numbers = [0; LANES];
        let mut waiting = packet.open;
        while waiting != 0 {
            let mut lanes = 0_u32;
            let mut rest = waiting;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % LANES;
                rest &= rest - 1;
                match scratch.next(lane, S::f32s::LEN, packet.queries[lane].t_max()) {
                    Some(number) => {
                        numbers[lane] = (first + number as usize) as u8;
                        lanes |= 1 << lane;
                    }
                    None => waiting &= !(1 << lane),
                }
            }
            if lanes == 0 {
                return;
            }
            slice.counters.add(Event::ExactTest, u64::from(lanes.count_ones()));
            self.offer_hits(slice, packet, (&scratch.rays, &mut scratch.found), (lanes, &numbers));
            waiting &= packet.open;
        }
    }

    /// Asks the exact test about a triangle each ray, and offers the hits it finds.
    #[inline(always)]
    fn offer_hits<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        packet: &mut Packet<'_, Q>,
        (rays, found): (&RayLanes, &mut PairHits),
        (lanes, numbers): (u32, &[u8; LANES]),
    ) {
        rays.intersect_pairs(slice.simd, lanes, &self.pairs, numbers, found);
        let mut hits = found.hits;
        while hits != 0 {
            let lane = hits.trailing_zeros() as usize % LANES;
            hits &= hits - 1;
            let triangle = TriangleId::from_index(usize::from(numbers[lane]));
            let hit = ClosestHit { t: found.t[lane], u: found.u[lane], v: found.v[lane], triangle };
            let index = packet.from + lane;
            let t_min = packet.rays[lane].t_min();
            let criteria = HitCriteria { t_min, index, filter: slice.batch.filter() };
            if let ControlFlow::Break(()) = packet.queries[lane].offer(&criteria, hit) {
                packet.open &= !(1 << lane);
            }
        }
    }

    /// Answers up to sixteen rays of a slice.
    #[inline(always)]
    fn trace_packet<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        from: usize,
        scratch: &mut Scratch,
    ) {
        let rays = &slice.batch.rays()[from..];
        let rays = &rays[..rays.len().min(LANES)];
        scratch.rays.fill(rays);
        scratch.rays.prepare(slice.simd);
        let queries = std::array::from_fn(|lane| Q::new(rays.get(lane).unwrap_or(&Ray::MISS)));
        let mut packet = Packet { open: (1 << rays.len()) - 1, rays, queries, from };
        for (number, group) in self.planes.chunks(GROUP).enumerate() {
            if number > 0 {
                for (lane, query) in packet.queries.iter().enumerate() {
                    scratch.rays.end_at(lane, query.t_max());
                }
            }
            slice.counters.add(Event::TriangleTest, group.len() as u64);
            let open = u64::from(packet.open.count_ones());
            slice.counters.add(Event::TriangleLane, group.len() as u64 * open);
            self.filter::<S, Q>(slice.simd, group, scratch);
            self.test_candidates(slice, &mut packet, scratch, number * GROUP);
            if packet.open == 0 {
                break;
            }
        }
        for (answer, query) in slice.answers[from..].iter_mut().zip(&packet.queries) {
            *answer = query.answer();
        }
    }
}

impl Scratch {
    /// Takes the next candidate of a ray: the likeliest, or one that may be hit at or before
    /// `t_max`. Vectors have `len` lanes.
    #[inline(always)]
    fn next(&mut self, lane: usize, len: usize, t_max: f32) -> Option<u32> {
        let likeliest = self.likeliest[lane];
        if likeliest != NONE {
            self.likeliest[lane] = NONE;
            self.candidates[lane] &= !(1 << likeliest);
            return Some(likeliest);
        }
        while self.candidates[lane] != 0 {
            let number = self.candidates[lane].trailing_zeros();
            self.candidates[lane] &= self.candidates[lane] - 1;
            let from = lane / len * len;
            if self.firsts[from * GROUP + number as usize * len + lane - from] <= t_max {
                return Some(number);
            }
        }
        None
    }
}

fn find_reach(source: &dyn TriangleSource) -> f32 {
    let triangles = (0..source.len()).map(|i| source.triangle(TriangleId::from_index(i)));
    TrianglePlanes::reach(triangles)
}

impl Structure for Flat {
    type Scratch = Box<Scratch>;

    fn scratch(&self) -> Box<Scratch> {
        Box::new(Scratch {
            rays: RayLanes::EMPTY,
            firsts: [0.0; LANES * GROUP],
            candidates: [0; LANES],
            likeliest: [NONE; LANES],
            found: PairHits::default(),
        })
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let (planes, pairs) = (size_of_val(&*self.planes), size_of_val(&*self.pairs));
        MemoryReport::new([("planes", planes), ("triangles", pairs)])
    }
}

impl Traverse for Flat {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Box<Scratch>,
    ) {
        for from in (0..slice.batch.rays().len()).step_by(LANES) {
            self.trace_packet(slice, from, scratch);
        }
    }
}
