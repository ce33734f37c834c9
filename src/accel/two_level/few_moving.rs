//! Few triangles that move, where nothing else is kept apart: no tree, rays side by side.
//!
//! A ray is held against all triangles of its part of the time by a filter, eight at once. To go
//! down a tree of one or two leaves, even in flight, takes longer. What passes is put on a list,
//! and the exact test is asked about sixteen pairs of a ray and a triangle at once. So where
//! triangles are at the times of their rays, which takes longest, is found for many pairs in a row,
//! and no pair waits for the test of another.

use std::sync::Arc;

use fearless_simd::{Level, Simd, f32x8};

use super::body::Body;
use super::levels::Levels;
use super::moved::Moved;
use super::moving_triangles::{FEW_TRIANGLES, MovingTriangles};
use super::outline::{LANES, Outline};
use super::slab::Slab;
use super::trees::W;
use super::verdict::place;
use crate::accel::{AnyHit, Batch, ClosestHit, Counters, Counts, Event, HitCriteria, NotCounted};
use crate::geom::{
    Motions, MovingBlock, MovingTriangle, PairHits, PairTriangle, Placements, RayLanes, Triangle,
};
use crate::math::{MeshId, PrimId, TriangleId, Vec3, larger};
use crate::simd::{baseline, vectorized};

/// So many rays are listed before they are tested.
const RAYS: usize = 256 * LANES;

/// Triangles that move, a few blocks for each part of the time.
pub struct FewMoving {
    levels: Arc<Levels>,
    triangles: Vec<Few>,
    /// By parts of the time.
    blocks: Vec<MovingBlock<W>>,
    /// Blocks of each part of the time.
    per_part: usize,
    level: Level,
    /// What holds all of them.
    outline: Outline,
}

/// A triangle that moves.
struct Few {
    id: TriangleId,
    mesh: MeshId,
    /// In the mesh's space, if that keeps its shape.
    corners: Option<Triangle>,
}

impl Few {
    fn new(placements: &dyn Placements, id: TriangleId) -> Self {
        let mesh = placements.mesh(id.instance);
        let is_deforming = placements.motions().is_some_and(|motions| motions.is_deforming(mesh));
        let corners = (!is_deforming).then(|| placements.mesh_triangle(mesh, id.index));
        Self { id, mesh, corners }
    }
}

impl FewMoving {
    /// The triangles of what moves; `None` if they are too many, or not all that is kept apart.
    pub fn new(
        levels: &Arc<Levels>,
        (triangles, bodies): (&MovingTriangles, &[Body]),
        level: Level,
    ) -> Option<Self> {
        let (count, per_part) = (triangles.len(), triangles.len().div_ceil(W));
        let are_all = levels.still == 0 && triangles.rest().is_empty() && bodies.is_empty();
        if !are_all || !(1..=FEW_TRIANGLES).contains(&count) {
            return None;
        }
        let few = |number: usize| {
            Few::new(levels.placed.get(), triangles.locate(PrimId::from_index(number)))
        };
        let all: Vec<Few> = (0..count).map(few).collect();
        let mut blocks = Vec::with_capacity(levels.timed_boxes.parts() * per_part);
        let (mut points, mut slack) = (Vec::new(), 0.0_f32);
        for part in 0..levels.timed_boxes.parts() {
            let over = all.iter().map(|few| few.id).zip(triangles.over(levels, part));
            let over: Vec<(TriangleId, MovingTriangle)> = over.collect();
            for (_, MovingTriangle { from, to, slack: own }) in &over {
                points.extend(from.corners().into_iter().chain(to.corners()));
                // A bound that is no number bounds nothing.
                slack = larger(slack, if own.is_nan() { f32::INFINITY } else { *own });
            }
            blocks.extend(over.chunks(W).map(MovingBlock::new));
        }
        let slab = Slab::of_points(points.iter().copied(), slack);
        let outline = levels.outline()?.within(slab);
        let (levels, triangles) = (Arc::clone(levels), all);
        Some(Self { levels, triangles, blocks, per_part, level, outline })
    }

    /// Bytes of the blocks, and of the lists of placements.
    pub fn bytes(&self) -> usize {
        self.levels.bytes() + size_of_val(&*self.blocks)
    }

    /// What a thread asks, which `counts` or does not.
    pub fn tracer(&self, counts: bool) -> Box<dyn FewTracer + '_> {
        if counts {
            Box::new(Worker::new(self, Counts::default()))
        } else {
            Box::new(Worker::new(self, NotCounted))
        }
    }

    /// The blocks for a time.
    #[inline(always)]
    fn blocks(&self, time: f32) -> &[MovingBlock<W>] {
        let first = self.levels.timed_boxes.part(time) * self.per_part;
        &self.blocks[first..first + self.per_part]
    }

    /// A triangle in the world at a time.
    #[inline(always)]
    fn place(
        &self,
        motions: &dyn Motions,
        moved: &mut Moved,
        (number, time): (u32, f32),
    ) -> Triangle {
        let Few { id, mesh, corners } = &self.triangles[number as usize];
        let to_world = moved.find((id.instance, time), motions);
        match corners {
            Some(corners) => place(&to_world, corners),
            None => place(&to_world, &motions.mesh_at(*mesh, time).triangle(id.index)),
        }
    }
}

/// Makes answers of what stands still those of all.
pub trait FewTracer {
    /// Takes nearer hits.
    fn improve_closest(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]);

    /// Takes any hits of rays that have none.
    fn improve_any(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]);

    /// What was counted.
    fn counts(&self) -> Counts;
}

struct Worker<'a, C> {
    few: &'a FewMoving,
    /// What passed: the ray by its place in the batch, and the triangle by its number.
    pairs: Vec<(u32, u32)>,
    rays: RayLanes,
    found: PairHits,
    counters: C,
}

impl<'a, C: Counters> Worker<'a, C> {
    fn new(few: &'a FewMoving, counters: C) -> Self {
        let (rays, found) = (RayLanes::EMPTY, PairHits::default());
        Self { few, pairs: Vec::new(), rays, found, counters }
    }

    /// Lists what some rays, from number `from` on, may hit at or before where they are asked
    /// `up_to`, if they are.
    #[inline(always)]
    fn list_pairs<S: Simd>(
        &mut self,
        simd: S,
        (batch, from): (&Batch<'_>, usize),
        up_to: impl Fn(usize) -> Option<f32>,
    ) {
        self.pairs.clear();
        let timed = &self.few.levels.timed_boxes;
        let some = &batch.rays()[from..batch.rays().len().min(from + RAYS)];
        for (group, rays) in some.chunks(LANES).enumerate() {
            let first = from + group * LANES;
            // No ray goes backwards.
            let mut t_max = [-1.0; LANES];
            for lane in 0..rays.len() {
                t_max[lane] = up_to(first + lane).unwrap_or(-1.0);
            }
            let mut asked = self.few.outline.may_ever_meet(rays, &t_max);
            let time = |lane: usize| batch.times().map_or(0.0, |times| times[first + lane]);
            while asked != 0 {
                let lane = asked.trailing_zeros() as usize % LANES;
                asked &= asked - 1;
                let place = timed.place(time(lane));
                for (first_number, block) in (0..).step_by(W).zip(self.few.blocks(time(lane))) {
                    self.counters.count(Event::TriangleTest);
                    let mut passed =
                        block.find_near::<S, f32x8<S>>(simd, &rays[lane], place, t_max[lane]);
                    while passed != 0 {
                        let number = passed.trailing_zeros() as usize % W;
                        passed &= passed - 1;
                        if block.ids[number] != TriangleId::NONE {
                            let number = first_number + number as u32;
                            self.pairs.push(((first + lane) as u32, number));
                        }
                    }
                }
            }
        }
    }

    /// Asks the exact test about all that is on the list, and hands out what it finds.
    #[inline(always)]
    fn test_pairs<S: Simd>(
        &mut self,
        simd: S,
        batch: &Batch<'_>,
        mut offer: impl FnMut(usize, ClosestHit, &HitCriteria<'_>),
    ) {
        let Self { few, pairs, rays, found, counters } = self;
        let Some(motions) = few.levels.placed.get().motions() else { return };
        let mut triangles = [PairTriangle::new(
            PrimId::NONE,
            &Triangle { a: Vec3::ZERO, b: Vec3::ZERO, c: Vec3::ZERO },
        ); LANES];
        let numbers = std::array::from_fn(|lane| lane as u32);
        let mut moved = Moved::default();
        counters.add(Event::ExactTest, pairs.len() as u64);
        for some in pairs.chunks(LANES) {
            for (lane, &(ray, number)) in some.iter().enumerate() {
                rays.put(lane, &batch.rays()[ray as usize]);
                let time = batch.times().map_or(0.0, |times| times[ray as usize]);
                let triangle = few.place(motions, &mut moved, (number, time));
                triangles[lane] = PairTriangle::new(PrimId(lane as u32), &triangle);
            }
            rays.prepare(simd);
            let lanes = ((1_u64 << some.len()) - 1) as u32;
            rays.intersect_pairs(simd, lanes, &triangles, &numbers, found);
            let mut hits = found.lanes;
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % LANES;
                hits &= hits - 1;
                let [t, u, v, _] = found.hits[lane];
                let (ray, number) = some[lane];
                let index = ray as usize;
                let hit = ClosestHit { t, u, v, triangle: few.triangles[number as usize].id };
                let t_min = batch.rays()[index].t_min();
                let criteria = HitCriteria::new(t_min, index, batch.filter());
                offer(index, hit, &criteria);
            }
        }
    }
}

impl<C: Counters> FewTracer for Worker<'_, C> {
    fn improve_closest(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        let t_max = |ray: usize, hit: &ClosestHit| batch.rays()[ray].up_to(hit.t).t_max();
        for from in (0..hits.len()).step_by(RAYS) {
            list(self, (batch, from), |ray| Some(t_max(ray, &hits[ray])));
            test(self, batch, |ray, hit, criteria| {
                let nearest = &mut hits[ray];
                let is_nearer = hit.t <= t_max(ray, nearest) && hit.is_before(nearest);
                if is_nearer && criteria.accepts(&hit) {
                    *nearest = hit;
                }
            });
        }
    }

    fn improve_any(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        let t_max = |ray: usize| batch.rays()[ray].t_max();
        for from in (0..hits.len()).step_by(RAYS) {
            list(self, (batch, from), |ray| (!hits[ray].0).then(|| t_max(ray)));
            test(self, batch, |ray, hit, criteria| {
                hits[ray].0 |= hit.t <= t_max(ray) && criteria.accepts(&hit);
            });
        }
    }

    fn counts(&self) -> Counts {
        self.counters.counts()
    }
}

/// See [`Worker::list_pairs`].
fn list<C: Counters>(
    worker: &mut Worker<'_, C>,
    some: (&Batch<'_>, usize),
    up_to: impl Fn(usize) -> Option<f32>,
) {
    if C::COUNTS {
        return worker.list_pairs(baseline(), some, up_to);
    }
    vectorized!(worker.few.level, simd => worker.list_pairs(simd, some, up_to));
}

/// See [`Worker::test_pairs`].
fn test<C: Counters>(
    worker: &mut Worker<'_, C>,
    batch: &Batch<'_>,
    offer: impl FnMut(usize, ClosestHit, &HitCriteria<'_>),
) {
    if C::COUNTS {
        return worker.test_pairs(baseline(), batch, offer);
    }
    vectorized!(worker.few.level, simd => worker.test_pairs(simd, batch, offer));
}
