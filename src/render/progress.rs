//! How far a render is.

use std::time::Duration;

/// The progress of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Samples that were there when it began, over all pixels: those of a checkpoint.
    pub before: u64,
    /// Samples that are there now.
    pub done: u64,
    /// Samples wanted; with a target for the noise, as many as it seems to take.
    pub total: u64,
    /// Time since it began.
    pub elapsed: Duration,
}

impl Progress {
    /// The time that it will still take at the pace so far; `None` at the start.
    pub fn left(&self) -> Option<Duration> {
        let taken = self.done.saturating_sub(self.before);
        let left = self.total.saturating_sub(self.done);
        (taken > 0).then(|| self.elapsed.mul_f64(left as f64 / taken as f64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_follows_from_the_pace_of_this_run() {
        let elapsed = Duration::from_secs(10);
        let progress = Progress { before: 100, done: 150, total: 250, elapsed };
        assert_eq!(progress.left(), Some(Duration::from_secs(20)));
        assert_eq!(Progress { before: 150, ..progress }.left(), None);
        assert_eq!(Progress { total: 140, ..progress }.left(), Some(Duration::ZERO));
    }
}
