//! A structure's answers held against answers to trust.

use std::ops::Range;
use std::time::{Duration, Instant};

use super::ray_sets::{RaySet, Target};
use crate::accel::{Accel, AnyHit, Batch, ClosestHit, Tracer};
use crate::math::Ray;

/// Slices that structures are asked in, in turn.
const SLICES: [usize; 6] = [LONGEST_SLICE, 1, 33, 8, 257, 1024];

/// The most rays that a structure is asked at once.
pub const LONGEST_SLICE: usize = 4096;

/// An answer that is not the expected one.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The first ray that is answered otherwise.
    pub ray: usize,
    /// The slice that it was asked in.
    pub slice: Range<usize>,
    /// Whether it is answered otherwise also when it is asked alone.
    pub alone: bool,
    /// Whether only the question for any hit is answered otherwise.
    pub any_only: bool,
    /// What the structure says.
    pub closest: ClosestHit,
    /// What it says to the other question.
    pub any: AnyHit,
}

/// The first ray whose answer differs, to either question, in slices of all lengths; `expected`
/// are the answers to the first rays.
pub fn first_difference(
    accel: &dyn Accel,
    rays: &[Ray],
    expected: &[ClosestHit],
) -> Option<Difference> {
    let mut tracer = accel.tracer();
    let (mut first, mut lengths) = (0, SLICES.into_iter().cycle());
    while first < expected.len() {
        let slice = first..expected.len().min(first + lengths.next().unwrap_or(1));
        let answers = ask(&mut *tracer, &rays[slice.clone()]);
        let found = answers.into_iter().zip(&expected[slice.clone()]).enumerate();
        for (at, ((closest, any), expected)) in found {
            if is_right(&closest, any, expected) {
                continue;
            }
            let ray = slice.start + at;
            let again = ask(&mut *accel.tracer(), &rays[ray..=ray]);
            let alone = again.iter().any(|(closest, any)| !is_right(closest, *any, expected));
            let any_only = closest.same_bits(expected);
            return Some(Difference { ray, slice, alone, any_only, closest, any });
        }
        first = slice.end;
    }
    None
}

fn is_right(closest: &ClosestHit, any: AnyHit, expected: &ClosestHit) -> bool {
    closest.same_bits(expected) && any.0 == expected.is_hit()
}

fn ask(tracer: &mut dyn Tracer, rays: &[Ray]) -> Vec<(ClosestHit, AnyHit)> {
    let mut closest = vec![ClosestHit::MISS; rays.len()];
    let mut any = vec![AnyHit(false); rays.len()];
    tracer.closest_hits(&Batch::new(rays), &mut closest);
    tracer.any_hits(&Batch::new(rays), &mut any);
    closest.into_iter().zip(any).collect()
}

/// `count` rays of all sets, taking turns, so that any prefix has of each; where a set has fewer
/// (a bounce needs a hit), random rays make up for it.
pub fn mixed_rays(target: &Target<'_>, count: usize, seed: u64) -> Vec<Ray> {
    let each = count.div_ceil(RaySet::ALL.len());
    let sets = RaySet::ALL.map(|set| target.rays(set, each, seed));
    let turns = (0..each).flat_map(|i| sets.iter().filter_map(move |set| set.get(i)).copied());
    let mut rays: Vec<Ray> = turns.take(count).collect();
    let more = target.rays(RaySet::Random, count - rays.len(), !seed);
    rays.extend(more);
    rays
}

/// Answers to the first rays: to `count` of them, or as many as are done in `time`.
pub fn answers_in_time(
    accel: &dyn Accel,
    rays: &[Ray],
    count: Option<usize>,
    time: Duration,
) -> Vec<ClosestHit> {
    let rays = &rays[..count.unwrap_or(rays.len()).min(rays.len())];
    let start = Instant::now();
    let mut answers = Vec::new();
    let mut tracer = accel.tracer();
    for slice in rays.chunks(2048) {
        if count.is_none() && start.elapsed() > time {
            break;
        }
        let first = answers.len();
        answers.resize(first + slice.len(), ClosestHit::MISS);
        tracer.closest_hits(&Batch::new(slice), &mut answers[first..]);
    }
    answers
}

#[cfg(test)]
pub(crate) mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::accel::{BuildReport, Counts, MemoryReport, build};
    use crate::geom::{Triangle, TriangleList, TriangleSource};
    use crate::math::Vec3;
    use crate::simd::Isa;

    /// A structure that lies about one ray.
    pub struct Liar {
        pub honest: Box<dyn Accel>,
        /// What it lies about.
        pub ray: Ray,
        /// Whether it does so to the question for any hit only.
        pub any_only: bool,
        /// Whether it does so only when it is asked about several rays at once.
        pub in_company: bool,
    }

    struct LyingTracer<'a>(&'a Liar, Box<dyn Tracer + 'a>);

    impl Liar {
        fn lies(&self, rays: &[Ray]) -> Option<usize> {
            let at = rays.iter().position(|ray| *ray == self.ray);
            at.filter(|_| !self.in_company || rays.len() > 1)
        }
    }

    impl Accel for Liar {
        fn level(&self) -> fearless_simd::Level {
            fearless_simd::Level::new()
        }

        fn tracer(&self) -> Box<dyn Tracer + '_> {
            Box::new(LyingTracer(self, self.honest.tracer()))
        }

        fn counting_tracer(&self) -> Box<dyn Tracer + '_> {
            self.tracer()
        }

        fn memory(&self) -> MemoryReport {
            self.honest.memory()
        }

        fn report(&self) -> &BuildReport {
            self.honest.report()
        }
    }

    impl Tracer for LyingTracer<'_> {
        fn closest_hits(&mut self, batch: &Batch<'_>, hits: &mut [ClosestHit]) {
            self.1.closest_hits(batch, hits);
            if let Some(at) = self.0.lies(batch.rays()).filter(|_| !self.0.any_only) {
                hits[at].u += 1.0;
            }
        }

        fn any_hits(&mut self, batch: &Batch<'_>, hits: &mut [AnyHit]) {
            self.1.any_hits(batch, hits);
            if let Some(at) = self.0.lies(batch.rays()) {
                hits[at].0 ^= true;
            }
        }

        fn counts(&self) -> Counts {
            Counts::default()
        }
    }

    /// A hundred triangles.
    pub fn source() -> Arc<dyn TriangleSource> {
        let list = (0..100_usize).map(|i| {
            let a = Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, i as f32);
            Triangle { a, b: a + Vec3::X, c: a + Vec3::ONE }
        });
        Arc::new(TriangleList(list.collect()))
    }

    pub fn honest(source: &Arc<dyn TriangleSource>, id: &str) -> Box<dyn Accel> {
        build(&id.parse().expect("a row"), Arc::clone(source), Isa::Portable).expect("it is small")
    }

    #[test]
    fn there_are_as_many_rays_as_asked_for() {
        let source = source();
        let brute = honest(&source, "brute");
        let target = Target::new(&*source, &*brute);
        for count in [0, 1, 4, 1000, 1003] {
            assert_eq!(mixed_rays(&target, count, 7).len(), count);
        }
    }

    #[test]
    fn the_one_ray_that_is_lied_about_is_found() {
        let source = source();
        let brute = honest(&source, "brute");
        let rays = mixed_rays(&Target::new(&*source, &*brute), 6000, 7);
        let sure = answers_in_time(&*brute, &rays, None, Duration::MAX);
        let bvh = honest(&source, "bvh2");
        assert_eq!(first_difference(&*bvh, &rays, &sure), None);
        // In the last slice but one and in one of length one.
        for (ray, slice) in [(5000, 4395..5419), (4096, 4096..4097)] {
            for any_only in [false, true] {
                let honest = honest(&source, "bvh2");
                let liar = Liar { honest, ray: rays[ray], any_only, in_company: false };
                let found = first_difference(&liar, &rays, &sure).expect("it lies");
                assert_eq!((found.ray, found.slice, found.alone), (ray, slice.clone(), true));
                assert_eq!(found.any_only, any_only);
                assert_eq!(found.any.0, !sure[ray].is_hit());
            }
        }
        let honest = honest(&source, "bvh2");
        let liar = Liar { honest, ray: rays[5000], any_only: false, in_company: true };
        let found = first_difference(&liar, &rays, &sure).expect("it lies");
        assert_eq!((found.ray, found.alone), (5000, false));
        assert_eq!(first_difference(&liar, &rays, &sure[..5000]), None, "not asked about it");
    }
}
