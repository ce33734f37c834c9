//! Slices of rays, and their hits.

use super::query::ask;
use super::{Query, Verdict};
use crate::geom::Shaft;
use crate::math::{Ray, TriangleId};

/// Rays to shoot together, with hints, which never change a hit, and a filter of hits.
#[derive(Clone, Copy)]
pub struct Batch<'a> {
    rays: &'a [Ray],
    grid: Option<(u32, u32)>,
    shaft: Option<&'a Shaft>,
    filter: Option<&'a dyn HitFilter>,
    verdict: Option<&'a dyn Verdict>,
}

impl<'a> Batch<'a> {
    /// A slice of rays without hints or filter.
    pub fn new(rays: &'a [Ray]) -> Self {
        Self { rays, grid: None, shaft: None, filter: None, verdict: None }
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

    /// What is asked of a ray.
    #[inline(always)]
    pub(super) fn ask<Q: Query>(&self, index: usize) -> Q {
        ask(&self.rays[index], self.verdict)
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

/// Takes back hits, for instance in the holes of a leaf's texture.
pub trait HitFilter: Sync {
    /// Whether a hit of the batch's ray number `ray` counts.
    ///
    /// Must be a pure function of its arguments: structures differ in which hits they ask about,
    /// how often and in which order.
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool;
}

/// The nearest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct ClosestHit {
    /// Distance in multiples of the ray's direction; infinite on a miss.
    pub t: f32,
    /// Weight of the triangle's second vertex.
    pub u: f32,
    /// Weight of its third vertex.
    pub v: f32,
    /// The triangle; [`TriangleId::NONE`] on a miss.
    pub triangle: TriangleId,
}

impl ClosestHit {
    /// No hit.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, triangle: TriangleId::NONE };

    /// Whether anything was hit.
    #[inline(always)]
    pub fn is_hit(&self) -> bool {
        self.triangle != TriangleId::NONE
    }

    /// Whether it is nearer, or as near and of a triangle before the other's.
    #[inline(always)]
    pub fn is_before(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }

    /// The same hit to the bit; what tests compare by.
    pub fn same_bits(&self, other: &Self) -> bool {
        bytemuck::bytes_of(self) == bytemuck::bytes_of(other)
    }
}

/// Whether a ray hits anything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct AnyHit(pub bool);
