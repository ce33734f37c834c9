//! What builders start from.

use rayon::prelude::*;

use super::limits::Limits;
use crate::accel::kd::slack::{Slack, find_bounds};
use crate::accel::{Options, Steps};
use crate::geom::TriangleSource;
use crate::math::{Aabb, PrimId};

/// What a tree is built from.
pub struct TreeInput<'a> {
    /// The triangles.
    pub source: &'a dyn TriangleSource,
    /// Box around all of them, slack included.
    pub bounds: Aabb,
    /// By how much they are grown.
    pub slack: Slack,
    /// When to stop.
    pub limits: Limits,
    /// What is told of the build's progress.
    pub steps: &'a Steps<'a>,
}

impl<'a> TreeInput<'a> {
    /// Reads the options.
    pub fn new(source: &'a dyn TriangleSource, options: &Options, steps: &'a Steps<'a>) -> Self {
        let own = find_bounds(source);
        let mut limits = Limits::new(options, source.len());
        let slack = Slack::new(&own, source.slack()).unwrap_or_else(|| {
            limits.depth = 0;
            Slack::NONE
        });
        Self { source, bounds: slack.grow(&own), slack, limits, steps }
    }

    /// Makes a reference to each triangle, in order.
    pub fn references(&self) -> Vec<Reference> {
        let reference = |i| {
            let id = PrimId::from_index(i);
            let bounds = self.source.triangle(id).bounds();
            Reference { bounds: self.slack.grow(&bounds), id }
        };
        (0..self.source.len()).into_par_iter().map(reference).collect()
    }
}

/// A triangle's box, grown by the slack.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    /// The box.
    pub bounds: Aabb,
    /// The triangle.
    pub id: PrimId,
}
