//! The shadow rays of a slice of paths.

use super::state::{Path, ShadowRay};
use crate::math::{Ray, Vec3};

/// Shadow rays to be traced together, and what becomes of each.
#[derive(Debug, Default)]
pub struct ShadowRays {
    /// The segments.
    pub rays: Vec<Ray>,
    /// For each, what its path gains.
    pub ends: Vec<ShadowEnd>,
    /// For each, the key of its path.
    pub keys: Vec<u64>,
    /// For each, the time of its path.
    pub times: Vec<f32>,
}

/// What becomes of a shadow ray.
#[derive(Clone, Copy, Debug)]
pub struct ShadowEnd {
    /// Of the path's result.
    pub slot: u32,
    /// Added to the slot's radiance if the ray is free.
    pub radiance: Vec3,
}

impl ShadowRays {
    /// None any more.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.ends.clear();
        self.keys.clear();
        self.times.clear();
    }

    /// Another one, of a path.
    #[inline(always)]
    pub fn push(&mut self, path: &Path, shadow: ShadowRay) {
        self.rays.push(shadow.ray);
        self.ends.push(ShadowEnd { slot: path.slot, radiance: shadow.radiance });
        self.keys.push(path.key);
        self.times.push(path.time);
    }
}
