//! Few triangles: all of them, one after the other, against sixteen rays side by side.
//!
//! Below some dozens of triangles no tree pays: to go down one costs a ray more than to be held
//! against everything, if the others beside it share the work. A filter in single precision
//! ([`crate::geom::planes`]) says for each ray which triangles it may hit, and from which `t` on.
//! The exact test is then asked about pairs of a ray and a triangle, a pair each lane: first about
//! each ray's likeliest triangle, the nearest that is surely ahead, and then about what else may
//! change the answer, which is little.

#[cfg(test)]
mod tests;

use std::ops::Range;

use fearless_simd::{Select, Simd, SimdBase, SimdMask};

use crate::accel::side_by_side::{LANES, Pairs, Questions};
use crate::accel::{
    BuildInput, BuildReport, Built, Counters, Event, MemoryReport, Phases, Query, RayContext,
    SliceContext, Structure, Traverse,
};
use crate::geom::{
    FilterLanes, FilterPlane, FilterSides, PairHits, PairTriangle, RayLanes, Reach, Triangle,
    TriangleBlock,
};
use crate::math::{PrimId, Ray};
use crate::simd::vectorized;

/// So few rays are faster one by one.
const FEW: usize = 4;
/// Triangles of a group at most: as many as there are bits.
const GROUP: usize = 32;

/// All triangles, prepared, those of a plane one after the other.
pub struct Flat {
    planes: Vec<Plane>,
    sides: Vec<FilterSides>,
    pairs: Vec<PairTriangle>,
    groups: Vec<Group>,
    /// The same triangles, for rays one by one.
    blocks: Vec<TriangleBlock<8>>,
    reach: Reach,
    built: Built,
}

/// A plane, and how many triangles of its group are in it.
struct Plane {
    plane: FilterPlane,
    triangles: u32,
}

/// Triangles that rays meet before what was found ends rays, or bounds them.
#[derive(Clone, Default)]
struct Group {
    planes: Range<usize>,
    triangles: Range<usize>,
}

/// Scratch of one thread: what is known of sixteen rays and a group of triangles.
pub struct Scratch {
    rays: RayLanes,
    /// For each vector's lanes, triangle and lane, the `t` from which on it may be hit.
    firsts: [f32; LANES * GROUP],
    /// Of each ray, a bit for each triangle that it may hit and was not asked about.
    candidates: [u32; LANES],
    /// Of each ray the number of the likeliest.
    likeliest: [u32; LANES],
    /// What the exact test found.
    found: PairHits,
}

impl Flat {
    /// Triangles, and planes that they lie in, that are faster without a tree: as many as this for
    /// each of a vector's lanes. There slices of bounce rays are 1.2 times as fast, in halls of
    /// boxes as among triangles at random; only primary rays gain less, or lose.
    const LIMIT: usize = 12;

    /// Prepares all triangles; `None` if they are too many, or not of a usual size.
    pub fn build(input: &BuildInput<'_>) -> Option<Self> {
        let count = input.source.len();
        let limit = Self::LIMIT * vectorized!(input.level, simd => count_lanes(simd));
        let exact = input.source.boxes() == 0 && input.source.slack() == 0.0;
        if !exact || !(1..limit).contains(&count) {
            return None;
        }
        let mut phases = Phases::start();
        let triangle = |i: usize| input.source.triangle(PrimId::from_index(i));
        let triangles: Vec<Triangle> = (0..count).map(triangle).collect();
        let reach = Reach::new(triangles.iter().copied())?;
        let mut flat = Self {
            planes: Vec::new(),
            sides: Vec::new(),
            pairs: Vec::new(),
            groups: Vec::new(),
            blocks: Vec::new(),
            reach,
            built: Built { level: input.level, report: BuildReport::default() },
        };
        flat.add(&triangles);
        if flat.planes.len() + count > limit {
            return None;
        }
        let numbered: Vec<_> = (0..count).map(|i| (PrimId::from_index(i), triangles[i])).collect();
        flat.blocks = numbered.chunks(8).map(TriangleBlock::new).collect();
        phases.end("triangles");
        flat.built.report = BuildReport {
            phases: phases.ended(),
            triangles: count,
            leaves: 1,
            mean_leaf: count as f64,
            sah_cost: count as f64,
            ..BuildReport::default()
        };
        Some(flat)
    }

    /// Adds triangles in order, but for those in the plane of one before, which follow that one.
    fn add(&mut self, triangles: &[Triangle]) {
        let mut left: Vec<usize> = (0..triangles.len()).collect();
        let mut group = Group::default();
        while let Some(&first) = left.first() {
            let (plane, _) = FilterPlane::new(&triangles[first]);
            let in_it = |&i: &usize| i == first || plane.holds(&triangles[i], self.reach);
            let (mut members, others) = left.iter().copied().partition::<Vec<_>, _>(in_it);
            left = others;
            // More than a group has room for go into several, each with the plane.
            while !members.is_empty() {
                if group.triangles.len() == GROUP {
                    self.groups.push(group.clone());
                    group = Group {
                        planes: group.planes.end..group.planes.end,
                        triangles: group.triangles.end..group.triangles.end,
                    };
                }
                let room = members.len().min(GROUP - group.triangles.len());
                for i in members.drain(..room) {
                    self.sides.push(FilterPlane::new(&triangles[i]).1);
                    self.pairs.push(PairTriangle::new(PrimId::from_index(i), &triangles[i]));
                }
                self.planes.push(Plane { plane, triangles: room as u32 });
                group.planes.end += 1;
                group.triangles.end += room;
            }
        }
        self.groups.push(group);
    }

    /// Finds what the rays of `open` lanes may hit of a group of triangles: a bit for each that has
    /// a likeliest one, and for each that has others.
    #[inline(always)]
    fn filter<S: Simd, Q: Query>(
        &self,
        simd: S,
        group: &Group,
        open: u32,
        scratch: &mut Scratch,
    ) -> [u32; 2] {
        let len = S::f32s::LEN;
        let (mut likely, mut more) = (0, 0);
        for from in (0..LANES).step_by(len) {
            if open >> from & ((1_u64 << len) - 1) as u32 != 0 {
                let [some, others] = self.filter_from::<S, Q>(simd, group, from, scratch);
                likely |= some << from;
                more |= others << from;
            }
        }
        [likely & open, more & open]
    }

    /// The same for the rays of one vector.
    #[inline(always)]
    fn filter_from<S: Simd, Q: Query>(
        &self,
        simd: S,
        group: &Group,
        from: usize,
        Scratch { rays, firsts, candidates, likeliest, .. }: &mut Scratch,
    ) -> [u32; 2] {
        let len = S::f32s::LEN;
        let lanes = FilterLanes::new(simd, rays, from, self.reach);
        let mut rows = firsts[from * GROUP..(from + len) * GROUP].chunks_exact_mut(S::f32s::LEN);
        let mut sides = (group.triangles.start as u32..).zip(&self.sides[group.triangles.clone()]);
        let [t_min, t_max] = lanes.spans();
        let nowhere = S::f32s::splat(simd, f32::NEG_INFINITY);
        let mut bit = 1;
        let mut passed = S::u32s::splat(simd, 0);
        let (mut best, mut best_bit, mut nearest) = (passed, passed, t_max);
        for Plane { plane, triangles } in &self.planes[group.planes.clone()] {
            let met = lanes.meet(simd, plane);
            let first = met.known.select(met.first, nowhere);
            let ahead = met.known & first.simd_gt(t_min);
            let ahead =
                ahead & if Q::ANY { met.last.simd_lt(t_max) } else { first.simd_lt(nearest) };
            for ((number, sides), row) in sides.by_ref().zip(&mut rows).take(*triangles as usize) {
                first.store_slice(row);
                let passes = met.find_candidates(simd, sides);
                let wins = passes & ahead;
                let bits = S::u32s::splat(simd, bit);
                bit <<= 1;
                passed = passes.select(passed | bits, passed);
                best = wins.select(S::u32s::splat(simd, number), best);
                best_bit = wins.select(bits, best_bit);
                if !Q::ANY {
                    nearest = wins.select(first, nearest);
                }
            }
        }
        let others = passed ^ best_bit;
        others.store_slice(&mut candidates[from..from + len]);
        best.store_slice(&mut likeliest[from..from + len]);
        let lanes = |bits: S::u32s| bits.simd_gt(0).to_bitmask() as u32;
        [lanes(best_bit), lanes(others)]
    }

    /// Asks the exact test about the candidates of a group, whose first triangle has this number;
    /// about the likeliest of those rays that have one first.
    #[inline(always)]
    fn test_candidates<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        packet: &mut Questions<Q>,
        scratch: &mut Scratch,
        ([mut lanes, mut waiting], first): ([u32; 2], u32),
    ) {
        let mut numbers = scratch.likeliest;
        while lanes | waiting != 0 {
            let Scratch { rays, found, .. } = &mut *scratch;
            let pairs = Pairs { rays, triangles: &self.pairs, numbers: &numbers, found };
            packet.offer_hits(slice, lanes, pairs);
            waiting &= packet.open;
            lanes = 0;
            let mut rest = waiting;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % LANES;
                rest &= rest - 1;
                match scratch.next(lane, S::f32s::LEN, packet.queries[lane].t_max()) {
                    Some(number) => {
                        numbers[lane] = first + number;
                        lanes |= 1 << lane;
                    }
                    None => waiting &= !(1 << lane),
                }
            }
        }
    }

    /// Holds one ray against all triangles, eight at a time.
    #[inline(always)]
    fn walk<S: Simd, Q: Query, C: Counters>(&self, context: &mut RayContext<'_, S, Q, C>) {
        for block in &self.blocks {
            if context.test_block(block.parts()).is_break() {
                return;
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
        let members = std::array::from_fn(|lane| (from + lane) as u32);
        let mut packet = Questions { open: (1 << rays.len()) - 1, queries, members };
        for (number, group) in self.groups.iter().enumerate() {
            if number > 0 {
                for (lane, query) in packet.queries.iter().enumerate() {
                    scratch.rays.end_at(lane, query.t_max());
                }
            }
            let count = group.triangles.len() as u64;
            slice.counters.add(Event::TriangleTest, count);
            slice.counters.add(Event::TriangleLane, count * u64::from(packet.open.count_ones()));
            let found = self.filter::<S, Q>(slice.simd, group, packet.open, scratch);
            let first = group.triangles.start as u32;
            self.test_candidates(slice, &mut packet, scratch, (found, first));
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
    /// Takes the next candidate of a ray that may be hit at or before `t_max`. Vectors have `len`
    /// lanes.
    #[inline(always)]
    fn next(&mut self, lane: usize, len: usize, t_max: f32) -> Option<u32> {
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

/// The lanes of a vector.
#[inline(always)]
fn count_lanes<S: Simd>(_: S) -> usize {
    S::f32s::LEN
}

impl Structure for Flat {
    type Scratch = Box<Scratch>;

    fn scratch(&self) -> Box<Scratch> {
        Box::new(Scratch {
            rays: RayLanes::EMPTY,
            firsts: [0.0; LANES * GROUP],
            candidates: [0; LANES],
            likeliest: [0; LANES],
            found: PairHits::default(),
        })
    }

    fn built(&self) -> &Built {
        &self.built
    }

    fn memory(&self) -> MemoryReport {
        let planes = size_of_val(&*self.planes) + size_of_val(&*self.groups);
        let triangles =
            size_of_val(&*self.sides) + size_of_val(&*self.pairs) + size_of_val(&*self.blocks);
        MemoryReport::new([("planes", planes), ("triangles", triangles)])
    }
}

impl Traverse for Flat {
    #[inline(always)]
    fn trace<S: Simd, Q: Query, C: Counters>(
        &self,
        slice: &mut SliceContext<'_, S, Q, C>,
        scratch: &mut Box<Scratch>,
    ) {
        let count = slice.batch.rays().len();
        let few = if count % LANES <= FEW { count % LANES } else { 0 };
        for from in (0..count - few).step_by(LANES) {
            self.trace_packet(slice, from, scratch);
        }
        for index in count - few..count {
            slice.answer(
                index,
                #[inline(always)]
                |context| self.walk(context),
            );
        }
    }
}
