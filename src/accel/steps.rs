//! What a build tells of its progress.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::files::Meter;

/// The units that a triangle is to a meter, from its box to its place in a leaf.
const UNITS_PER_TRIANGLE: u64 = 8;
/// Of these, those of a tree that is refined afterwards, and those of the refinement; the rest is
/// boxes, collapsing and laying out.
const UNITS_OF_TREE: u64 = 5;
const UNITS_OF_REFINEMENT: u64 = 2;

/// The steps of a build over some triangles. What a builder does not tell of is done when it ends.
pub struct Steps<'a> {
    /// `None` if nobody is told.
    meter: Option<&'a Meter>,
    /// Units.
    left: AtomicU64,
}

impl<'a> Steps<'a> {
    /// The steps of a build whose triangles the meter expects already.
    pub fn new(meter: &'a Meter, triangles: usize) -> Self {
        let left = AtomicU64::new(UNITS_PER_TRIANGLE * triangles as u64);
        Self { meter: Some(meter), left }
    }

    /// Steps that nobody is told of.
    pub const fn untold() -> Self {
        Self { meter: None, left: AtomicU64::new(0) }
    }

    /// Has a meter expect so many triangles.
    pub fn expect(meter: &Meter, triangles: usize) {
        meter.expect(UNITS_PER_TRIANGLE * triangles as u64);
    }

    /// So many triangles are in their subtree. Those that are in several count in each, as long as
    /// there are any left.
    pub fn place(&self, triangles: usize) {
        self.finish(UNITS_OF_TREE * triangles as u64);
    }

    /// One of so many rounds of the refinement of so many triangles is over.
    pub fn refine(&self, triangles: usize, rounds: usize) {
        self.finish(UNITS_OF_REFINEMENT * triangles as u64 / rounds as u64);
    }

    fn finish(&self, units: u64) {
        let Some(meter) = self.meter else { return };
        let take = |left: u64| Some(left.saturating_sub(units));
        if let Ok(left) = self.left.fetch_update(Relaxed, Relaxed, take) {
            meter.finish(units.min(left));
        }
    }
}

impl Drop for Steps<'_> {
    fn drop(&mut self) {
        if let Some(meter) = self.meter {
            meter.finish(*self.left.get_mut());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_triangle_is_done_once_whatever_is_told() {
        let meter = Meter::default();
        Steps::expect(&meter, 100);
        let steps = Steps::new(&meter, 100);
        steps.place(60);
        assert_eq!(meter.share(), Some(0.375));
        steps.refine(100, 2);
        assert_eq!(meter.share(), Some(0.5));
        steps.place(1000);
        assert_eq!(meter.share(), Some(1.0));
        Steps::expect(&meter, 100);
        drop(steps);
        assert_eq!(meter.share(), Some(0.5));
        drop(Steps::new(&meter, 100));
        assert_eq!(meter.share(), Some(1.0));
    }
}
