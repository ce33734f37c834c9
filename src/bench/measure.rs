//! Rays asked of structures: answers compared, passes timed, work counted.

use std::time::Instant;

use crate::accel::{Accel, AnyHit, Batch, BuildError, ClosestHit, Counts, Event, Tracer};
use crate::math::Ray;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A structure could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A structure answers otherwise than the first.
    #[error("{spec} disagrees with {first} on {rays} of {count} {set} rays; nothing was timed")]
    Disagrees {
        spec: String,
        /// With which.
        first: String,
        /// How often.
        rays: usize,
        /// Of how many.
        count: usize,
        /// In which set.
        set: &'static str,
    },
    /// A structure makes another picture than the first.
    #[error("{scene}: {spec} and {first} render {pixels} pixels differently")]
    Differs {
        spec: String,
        /// From which.
        first: String,
        /// How many pixels.
        pixels: usize,
        /// Of which scene.
        scene: String,
    },
}

/// What is asked of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ask {
    /// The nearest hit.
    Closest,
    /// Whether there is any.
    Any,
}

/// The answers to a set of rays.
pub enum Answers {
    /// To [`Ask::Closest`].
    Closest(Vec<ClosestHit>),
    /// To [`Ask::Any`].
    Any(Vec<AnyHit>),
}

impl Answers {
    /// On how many rays two structures differ.
    pub fn count_differences(&self, other: &Self) -> usize {
        match (self, other) {
            (Self::Closest(a), Self::Closest(b)) => {
                a.iter().zip(b).filter(|(a, b)| !a.same_bits(b)).count()
            }
            (Self::Any(a), Self::Any(b)) => a.iter().zip(b).filter(|(a, b)| a != b).count(),
            (Self::Closest(all), _) => all.len(),
            (Self::Any(all), _) => all.len(),
        }
    }

    /// An error unless they are those of the first structure.
    ///
    /// # Errors
    /// [`BenchError::Disagrees`].
    pub fn check(
        &self,
        expected: &Self,
        spec: &str,
        first: &str,
        set: &'static str,
    ) -> Result<(), BenchError> {
        let count = match self {
            Self::Closest(hits) => hits.len(),
            Self::Any(hits) => hits.len(),
        };
        match self.count_differences(expected) {
            0 => Ok(()),
            rays => {
                let (spec, first) = (spec.to_owned(), first.to_owned());
                Err(BenchError::Disagrees { spec, first, rays, count, set })
            }
        }
    }
}

/// How rays are handed to a structure.
#[derive(Clone, Copy, Debug)]
pub struct Shots<'a> {
    /// The rays.
    pub rays: &'a [Ray],
    /// What is asked of them.
    pub ask: Ask,
    /// How many are asked about at once.
    pub slice: usize,
    /// Width and height of a slice whose rays form a raster.
    pub grid: Option<(u32, u32)>,
}

impl<'a> Shots<'a> {
    /// Rays in slices of some length.
    pub fn new(rays: &'a [Ray], ask: Ask, slice: usize) -> Self {
        Self { rays, ask, slice, grid: None }
    }

    /// Room for the answers, written to, so that no pass has to fetch the pages.
    fn allocate_answers(&self) -> Answers {
        match self.ask {
            Ask::Closest => Answers::Closest(vec![ClosestHit::MISS; self.rays.len()]),
            Ask::Any => Answers::Any(vec![AnyHit(true); self.rays.len()]),
        }
    }

    fn shoot(&self, tracer: &mut dyn Tracer, answers: &mut Answers) {
        let slice = self.slice.max(1);
        let batch = |rays| match self.grid {
            Some((width, height)) => Batch::new(rays).with_grid(width, height),
            None => Batch::new(rays),
        };
        match answers {
            Answers::Closest(hits) => {
                for (rays, hits) in self.rays.chunks(slice).zip(hits.chunks_mut(slice)) {
                    tracer.closest_hits(&batch(rays), hits);
                }
            }
            Answers::Any(hits) => {
                for (rays, hits) in self.rays.chunks(slice).zip(hits.chunks_mut(slice)) {
                    tracer.any_hits(&batch(rays), hits);
                }
            }
        }
    }

    /// The answers of a structure.
    pub fn trace(&self, accel: &dyn Accel) -> Answers {
        let mut answers = self.allocate_answers();
        self.shoot(&mut *accel.tracer(), &mut answers);
        answers
    }

    /// Seconds for a pass, with a fresh tracer, on this thread.
    pub fn time(&self, accel: &dyn Accel) -> f64 {
        let (mut answers, mut tracer) = (self.allocate_answers(), accel.tracer());
        let start = Instant::now();
        self.shoot(&mut *tracer, &mut answers);
        start.elapsed().as_secs_f64()
    }

    /// The work of a pass, with a fresh tracer.
    pub fn count_work(&self, accel: &dyn Accel) -> Counts {
        let mut tracer = accel.counting_tracer();
        self.shoot(&mut *tracer, &mut self.allocate_answers());
        tracer.counts()
    }
}

/// Work and time of a set of rays.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Counted work of all rays.
    pub counts: Counts,
    /// How many rays.
    pub rays: usize,
    /// Seconds of the pass that counts, one thread.
    pub seconds: f64,
}

impl Measured {
    /// How often an event happened per ray.
    pub fn per_ray(&self, event: Event) -> f64 {
        self.counts[event] as f64 / self.rays.max(1) as f64
    }

    /// Millions of rays a second.
    pub fn rate(&self) -> f64 {
        self.rays as f64 / self.seconds.max(1e-9) * 1e-6
    }
}

/// How many times as fast one is as another.
pub fn speed_up(one: &Measured, other: &Measured) -> f64 {
    one.rate() / other.rate()
}

/// The share of a cache's look-ups that found what they sought; `None` if there were none.
pub fn hit_rate(counts: &Counts) -> Option<f64> {
    let (hits, misses) = (counts[Event::CacheHit], counts[Event::CacheMiss]);
    (hits + misses > 0).then(|| hits as f64 / (hits + misses) as f64)
}

/// Times each of several things by turns, round by round, so that what else the machine does falls
/// on all alike; the median of the rounds of each.
///
/// # Errors
/// The first of a pass.
pub fn time_interleaved<E>(
    things: usize,
    rounds: usize,
    mut seconds: impl FnMut(usize) -> Result<f64, E>,
) -> Result<Vec<f64>, E> {
    let mut times = vec![Vec::with_capacity(rounds); things];
    for _ in 0..rounds.max(1) {
        for (thing, times) in times.iter_mut().enumerate() {
            times.push(seconds(thing)?);
        }
    }
    Ok(times.into_iter().map(median).collect())
}

/// The middle value, or the mean of the two in the middle.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let (below, above) = (values[(values.len() - 1) / 2], values[values.len() / 2]);
    f64::midpoint(below, above)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_are_interleaved_and_the_median_counts() {
        let mut order = Vec::new();
        let of = |thing: usize| {
            order.push(thing);
            Ok::<_, ()>([1.0, 10.0][thing] * [3.0, 1.0, 2.0][(order.len() - 1) / 2])
        };
        assert_eq!(time_interleaved(2, 3, of), Ok(vec![2.0, 20.0]));
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
    }

    #[test]
    fn disagreements_are_counted_to_the_bit() {
        let hit = |t: f32| ClosestHit { t, ..ClosestHit::MISS };
        let (a, b) = (vec![hit(0.0), hit(1.0)], vec![hit(-0.0), hit(1.0)]);
        let (a, b) = (Answers::Closest(a), Answers::Closest(b));
        assert_eq!((a.count_differences(&a), a.count_differences(&b)), (0, 1));
        let error = a.check(&b, "x", "y", "random").expect_err("zeros of different sign");
        assert_eq!(
            error.to_string(),
            "x disagrees with y on 1 of 2 random rays; nothing was timed"
        );
        let (a, b) = (Answers::Any(vec![AnyHit(true)]), Answers::Any(vec![AnyHit(false)]));
        assert_eq!((a.count_differences(&b), b.count_differences(&b)), (1, 0));
    }

    #[test]
    fn without_look_ups_there_is_no_hit_rate() {
        use crate::accel::Counters;
        let mut counts = Counts::default();
        assert_eq!(hit_rate(&counts), None);
        counts.add(Event::CacheMiss, 1);
        assert_eq!(hit_rate(&counts), Some(0.0));
        counts.add(Event::CacheHit, 3);
        assert_eq!(hit_rate(&counts), Some(0.75));
    }
}
