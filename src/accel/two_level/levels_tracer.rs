//! What a thread asks of two levels.

use std::cell::RefCell;

use fearless_simd::Simd;

use super::few_moving::FewTracer;
use super::outline::LANES;
use super::two_level::TwoLevel;
use super::verdict::Above;
use crate::accel::{Accel, AnyHit, Batch, ClosestHit, Counts, HitFilter, Tracer};
use crate::geom::SlabRay;
use crate::math::Ray;
use crate::simd::vectorized;

/// Traces what is flattened first, then what is placed, as far as that can be nearer.
struct LevelsTracer<'a> {
    two_level: &'a TwoLevel,
    make: fn(&'a dyn Accel) -> Box<dyn Tracer + 'a>,
    flat: Option<Box<dyn Tracer + 'a>>,
    above: Option<Box<dyn Tracer + 'a>>,
    few: Option<Box<dyn FewTracer + 'a>>,
    below: RefCell<Vec<Option<Box<dyn Tracer + 'a>>>>,
    /// Those that may meet what is placed.
    rays: Vec<Ray>,
    /// Their numbers in the batch.
    numbers: Vec<u32>,
    /// Their times.
    times: Vec<f32>,
    hits: Vec<ClosestHit>,
}

impl TwoLevel {
    /// A tracer that asks those that `make` makes, and that `counts` or does not.
    pub(super) fn trace<'a>(
        &'a self,
        counts: bool,
        make: fn(&'a dyn Accel) -> Box<dyn Tracer + 'a>,
    ) -> Box<dyn Tracer + 'a> {
        Box::new(LevelsTracer {
            two_level: self,
            make,
            flat: self.flat.as_ref().map(|flat| make(flat)),
            above: self.above.as_deref().map(make),
            few: self.few.as_ref().map(|few| few.tracer(counts)),
            below: RefCell::new((0..self.below.len()).map(|_| None).collect()),
            rays: Vec::new(),
            numbers: Vec::new(),
            times: Vec::new(),
            hits: Vec::new(),
        })
    }
}

impl<'a> LevelsTracer<'a> {
    /// Chooses the rays that may meet what is placed, each up to where that would count.
    fn choose(&mut self, batch: &Batch<'_>, up_to: impl Fn(usize) -> Option<f32>) {
        vectorized!(self.two_level.level, simd => self.choose_by(simd, batch, up_to));
    }

    #[inline(always)]
    fn choose_by<S: Simd>(
        &mut self,
        simd: S,
        batch: &Batch<'_>,
        up_to: impl Fn(usize) -> Option<f32>,
    ) {
        let Self { two_level, rays, numbers, times, .. } = self;
        let (timed_boxes, outline) = (&two_level.levels.timed_boxes, &two_level.outline);
        rays.clear();
        numbers.clear();
        times.clear();
        for (group, some) in batch.rays().chunks(LANES).enumerate() {
            let first = group * LANES;
            // No ray goes backwards.
            let mut t_max = [-1.0; LANES];
            for lane in 0..some.len() {
                t_max[lane] = up_to(first + lane).unwrap_or(-1.0);
            }
            let mut lanes = match outline {
                Some(outline) => outline.may_ever_meet(some, &t_max),
                None => {
                    (0..some.len()).fold(0, |all, lane| all | u32::from(t_max[lane] >= 0.0) << lane)
                }
            };
            while lanes != 0 {
                let lane = lanes.trailing_zeros() as usize % LANES;
                lanes &= lanes - 1;
                let (ray, number) = (some[lane].up_to(t_max[lane]), first + lane);
                let time = batch.times().map_or(0.0, |times| times[number]);
                let meets = outline.as_ref().is_none_or(|outline| {
                    let slab = (&SlabRay::new(&ray), ray.t_min());
                    outline.may_meet(simd, timed_boxes.part(time), slab, ray.t_max())
                });
                if meets {
                    rays.push(ray);
                    numbers.push(number as u32);
                    times.push(time);
                }
            }
        }
    }

    /// Has the upper structure asked about `self.rays`.
    fn ask(&mut self, batch: &Batch<'_>, ask: impl FnOnce(&mut dyn Tracer, &Batch<'_>)) {
        let Self { two_level, make, above, below, rays, numbers, times, .. } = self;
        let Some(tracer) = above else { return };
        let two_level: &'a TwoLevel = two_level;
        // The hints are about all rays.
        let is_whole = rays.len() == batch.rays().len();
        let chosen = if is_whole { batch.with_rays(rays) } else { Batch::new(rays) };
        if two_level.below.is_empty() {
            let filter = batch.filter().map(|filter| ChosenFilter { filter, numbers });
            let filter = filter.as_ref().map(|filter| filter as &dyn HitFilter);
            return ask(&mut **tracer, &chosen.with_filter(filter).with_times(Some(times)));
        }
        let make =
            |mesh: usize| make(two_level.below[mesh].as_deref().expect("its mesh is kept apart"));
        let verdict = Above {
            levels: &two_level.levels,
            tracers: below,
            make: &make,
            rays,
            numbers,
            filter: batch.filter(),
            times: batch.times(),
        };
        ask(&mut **tracer, &chosen.with_filter(None).with_verdict(&verdict));
    }
}

/// The filter of a batch, for some of its rays.
struct ChosenFilter<'a> {
    filter: &'a dyn HitFilter,
    /// Their numbers in the batch.
    numbers: &'a [u32],
}

impl HitFilter for ChosenFilter<'_> {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        self.filter.accepts(self.numbers[ray] as usize, hit)
    }
}

impl Tracer for LevelsTracer<'_> {
    fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
        match &mut self.flat {
            Some(flat) => flat.closest_hits(batch, hits),
            None => hits.fill(ClosestHit::MISS),
        }
        if let Some(few) = &mut self.few {
            return few.improve_closest(batch, hits);
        }
        self.choose(batch, |number| Some(hits[number].t));
        let mut found = std::mem::take(&mut self.hits);
        found.clear();
        found.resize(self.rays.len(), ClosestHit::MISS);
        self.ask(batch, |tracer, batch| tracer.closest_hits(batch, &mut found));
        for (&number, found) in self.numbers.iter().zip(&found) {
            let hit = &mut hits[number as usize];
            if found.is_before(hit) {
                *hit = *found;
            }
        }
        self.hits = found;
    }

    fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
        match &mut self.flat {
            Some(flat) => flat.any_hits(batch, hits),
            None => hits.fill(AnyHit(false)),
        }
        if let Some(few) = &mut self.few {
            return few.improve_any(batch, hits);
        }
        let rays = batch.rays();
        self.choose(batch, |number| (!hits[number].0).then(|| rays[number].t_max()));
        let mut found = vec![AnyHit(false); self.rays.len()];
        self.ask(batch, |tracer, batch| tracer.any_hits(batch, &mut found));
        for (&number, found) in self.numbers.iter().zip(found) {
            hits[number as usize].0 |= found.0;
        }
    }

    fn counts(&self) -> Counts {
        let below = self.below.borrow();
        let below = below.iter().flatten().map(|tracer| tracer.counts());
        let above = self.above.iter().chain(&self.flat).map(|tracer| tracer.counts());
        let few = self.few.iter().map(|few| few.counts());
        above.chain(below).chain(few).fold(Counts::default(), |sum, counts| sum + counts)
    }
}
