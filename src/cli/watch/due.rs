//! When something that is done every so often is to be done again.

use std::time::Duration;

use crate::cli::settings::parse_long::Every;

/// What is done every so often, and when next.
#[derive(Clone, Copy, Debug)]
pub struct Due {
    every: Every,
    /// For what is done by time, since the start.
    next_time: Duration,
    /// For what is done by samples of each pixel.
    next_samples: u64,
}

impl Due {
    /// Due for the first time after `every`.
    pub fn new(every: Every) -> Self {
        let (next_time, next_samples) = match every {
            Every::Time(time) => (time, 0),
            Every::Samples(samples) => (Duration::ZERO, samples),
        };
        Self { every, next_time, next_samples }
    }

    /// The same, but if it is due by time, for the first time after `first` at the latest.
    pub fn and_first_after(mut self, first: Duration) -> Self {
        self.next_time = self.next_time.min(first);
        self
    }

    /// Whether it is due, after such a time and so many samples of each pixel.
    pub fn is_due(&self, elapsed: Duration, samples: f64) -> bool {
        match self.every {
            Every::Time(_) => elapsed >= self.next_time,
            Every::Samples(_) => samples >= self.next_samples as f64,
        }
    }

    /// Takes note that it is done now: it is due again a whole interval later.
    pub fn done(&mut self, elapsed: Duration, samples: f64) {
        match self.every {
            Every::Time(every) => self.next_time = elapsed.saturating_add(every),
            Every::Samples(every) => {
                self.next_samples = (samples as u64 / every + 1).saturating_mul(every);
            }
        }
    }

    /// Whether it is due; if so, it is taken as done.
    pub fn take(&mut self, elapsed: Duration, samples: f64) -> bool {
        let due = self.is_due(elapsed, samples);
        if due {
            self.done(elapsed, samples);
        }
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_done_by_time_comes_at_intervals() {
        let mut due = Due::new(Every::Time(Duration::from_secs(10)));
        let taken = |due: &mut Due| -> Vec<u64> {
            (0..35).filter(|&second| due.take(Duration::from_secs(second), 0.0)).collect()
        };
        assert_eq!(taken(&mut due), [10, 20, 30]);
        let mut early = Due::new(Every::Time(Duration::from_secs(10)));
        early = early.and_first_after(Duration::from_secs(1));
        assert_eq!(taken(&mut early), [1, 11, 21, 31]);
    }

    #[test]
    fn what_is_done_by_samples_comes_at_multiples() {
        let mut due = Due::new(Every::Samples(100)).and_first_after(Duration::ZERO);
        let samples = [0.0, 99.0, 100.5, 150.0, 199.0, 430.0, 499.0, 500.0];
        let taken = samples.map(|samples| due.take(Duration::MAX, samples));
        assert_eq!(taken, [false, false, true, false, false, true, false, true]);
    }
}
