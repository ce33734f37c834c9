//! Slices of rays, and their hits.

use super::{HitFilter, Verdict};
use crate::geom::Shaft;
use crate::math::Ray;

/// Rays to shoot together, with hints, which never change a hit, a filter of hits, and times.
#[derive(Clone, Copy)]
pub struct Batch<'a> {
    rays: &'a [Ray],
    grid: Option<(u32, u32)>,
    shaft: Option<&'a Shaft>,
    filter: Option<&'a dyn HitFilter>,
    verdict: Option<&'a dyn Verdict>,
    times: Option<&'a [f32]>,
}

impl<'a> Batch<'a> {
    /// A slice of rays without hints or filter.
    pub fn new(rays: &'a [Ray]) -> Self {
        Self { rays, grid: None, shaft: None, filter: None, verdict: None, times: None }
    }

    /// Says that the rays are those of a raster of `width` by `height` cells, row by row, with the
    /// same number of rays in each, one after the other. Not heeded if their number says otherwise.
    #[must_use]
    pub fn with_grid(self, width: u32, height: u32) -> Self {
        Self { grid: Some((width, height)), ..self }
    }

    /// Says that a region holds all rays. Structures that use it ask whether it does.
    #[must_use]
    pub fn with_shaft(self, shaft: &'a Shaft) -> Self {
        Self { shaft: Some(shaft), ..self }
    }

    /// Lets only those hits count that a filter accepts.
    #[must_use]
    pub fn with_filter(self, filter: Option<&'a dyn HitFilter>) -> Self {
        Self { filter, ..self }
    }

    /// Says at which time of the shutter each ray is shot, from 0 to 1; without, all are at 0.
    /// Heeded where anything moves.
    #[must_use]
    pub fn with_times(self, times: Option<&'a [f32]>) -> Self {
        Self { times, ..self }
    }

    /// The times of the rays, if they have any.
    #[inline(always)]
    pub(super) fn times(&self) -> Option<&'a [f32]> {
        self.times
    }

    /// Other rays in place of these, one for each, under the same hints and filter: each within the
    /// one that it stands for, or one that hits nothing.
    #[must_use]
    pub(super) fn with_rays(self, rays: &'a [Ray]) -> Self {
        Self { rays, ..self }
    }

    /// Has another say what is hit than the exact test of the rays themselves.
    #[must_use]
    pub(super) fn with_verdict(self, verdict: &'a dyn Verdict) -> Self {
        Self { verdict: Some(verdict), ..self }
    }

    /// Who says what is hit, if not the exact test.
    #[inline(always)]
    pub(super) fn verdict(&self) -> Option<&'a dyn Verdict> {
        self.verdict
    }

    /// The rays.
    #[inline(always)]
    pub fn rays(&self) -> &'a [Ray] {
        self.rays
    }

    /// Width and height of the raster that they form, if known, and the rays in each cell.
    pub fn grid(&self) -> Option<(usize, usize, usize)> {
        let (width, height) = self.grid?;
        let (width, height) = (width as usize, height as usize);
        let cells = width.checked_mul(height).filter(|&cells| cells > 0)?;
        self.rays.len().is_multiple_of(cells).then(|| (width, height, self.rays.len() / cells))
    }

    /// The region that is said to hold all rays.
    pub fn shaft(&self) -> Option<&'a Shaft> {
        self.shaft
    }

    /// The filter, if there is one.
    #[inline(always)]
    pub fn filter(&self) -> Option<&'a dyn HitFilter> {
        self.filter
    }
}
