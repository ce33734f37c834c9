//! How much of a task is done: told by those who do it, and read by those who show it.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// How much is done of what may take long: reading a scene, or building a structure over it.
///
/// That is counted in units that take about as long each, such as bytes of files or triangles.
/// Nobody waits for it or decides by it, so counts are loose: more may be found to be done on the
/// way.
#[derive(Debug, Default)]
pub struct Meter {
    done: AtomicU64,
    total: AtomicU64,
}

impl Meter {
    /// So many units more are to be done.
    pub fn expect(&self, units: u64) {
        self.total.fetch_add(units, Relaxed);
    }

    /// So many units more are done.
    pub fn finish(&self, units: u64) {
        self.done.fetch_add(units, Relaxed);
    }

    /// Another task begins, of which nothing is known yet.
    pub fn restart(&self) {
        self.done.store(0, Relaxed);
        self.total.store(0, Relaxed);
    }

    /// How much of what is known to be done is done, from 0 to 1; `None` while nothing is known.
    pub fn share(&self) -> Option<f64> {
        let (done, total) = (self.done.load(Relaxed), self.total.load(Relaxed));
        (total > 0).then(|| done.min(total) as f64 / total as f64)
    }
}

/// A file that is read from its front to its end, which a meter counts in bytes.
pub struct Front<'a> {
    meter: &'a Meter,
    /// Bytes that the meter was not told of yet.
    left: u64,
}

/// A meter is told of so many bytes at once.
const STRIDE: u64 = 1 << 18;

impl<'a> Front<'a> {
    /// The front of a file of so many bytes, which are to be read.
    pub fn new(meter: &'a Meter, bytes: u64) -> Self {
        meter.expect(bytes);
        Self { meter, left: bytes }
    }

    /// So many bytes are left to read.
    #[inline]
    pub fn move_to(&mut self, left: u64) {
        if left + STRIDE <= self.left {
            self.meter.finish(self.left - left);
            self.left = left;
        }
    }
}

/// The rest is done too: it was read, or will not be.
impl Drop for Front<'_> {
    fn drop(&mut self) {
        self.meter.finish(self.left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_of_what_is_known_and_at_most_all() {
        let meter = Meter::default();
        assert_eq!(meter.share(), None);
        meter.expect(8);
        meter.finish(2);
        assert_eq!(meter.share(), Some(0.25));
        meter.expect(2);
        assert_eq!(meter.share(), Some(0.2));
        meter.finish(20);
        assert_eq!(meter.share(), Some(1.0));
        meter.restart();
        assert_eq!(meter.share(), None);
    }

    #[test]
    fn a_file_is_done_when_its_front_is_dropped() {
        let meter = Meter::default();
        let mut front = Front::new(&meter, 4 * STRIDE);
        front.move_to(4 * STRIDE - 1);
        assert_eq!(meter.share(), Some(0.0));
        front.move_to(3 * STRIDE);
        assert_eq!(meter.share(), Some(0.25));
        drop(front);
        assert_eq!(meter.share(), Some(1.0));
    }
}
