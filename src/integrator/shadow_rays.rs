//! The shadow rays of a slice of paths.

use super::state::{Path, ShadowRay};
use super::transit::{Passage, Transit};
use crate::accel::ClosestHit;
use crate::math::{Ray, Vec3};
use crate::world::World;

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

/// Lights on their way through borders, to be traced together, as often as it takes.
#[derive(Debug, Default)]
pub struct Transits {
    /// What is left of each way.
    pub rays: Vec<Ray>,
    /// For each, the key of its path.
    pub keys: Vec<u64>,
    /// For each, the time of its path.
    pub times: Vec<f32>,
    all: Vec<(u32, Transit)>,
}

impl Transits {
    /// None any more.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.keys.clear();
        self.times.clear();
        self.all.clear();
    }

    /// Another one, towards a path; `key` is that of its rays.
    pub fn push(&mut self, path: &Path, key: u64, transit: Transit) {
        self.rays.push(transit.ray);
        self.keys.push(key);
        self.times.push(path.time);
        self.all.push((path.slot, transit));
    }

    /// Takes each as far as to what its ray has met. Those that go on stay, in order; `arrive` is
    /// called with slot and radiance of those that arrive.
    pub fn cross(&mut self, world: &World, hits: &[ClosestHit], mut arrive: impl FnMut(u32, Vec3)) {
        let mut kept = 0;
        for (i, hit) in hits.iter().enumerate() {
            let ((slot, transit), time) = (self.all[i], self.times[i]);
            match transit.cross(world, hit, time) {
                Passage::Blocked => {}
                Passage::Arrives(radiance) => arrive(slot, radiance),
                Passage::GoesOn(transit) => {
                    self.rays[kept] = transit.ray;
                    self.keys[kept] = self.keys[i];
                    self.times[kept] = time;
                    self.all[kept] = (slot, transit);
                    kept += 1;
                }
            }
        }
        self.rays.truncate(kept);
        self.keys.truncate(kept);
        self.times.truncate(kept);
        self.all.truncate(kept);
    }
}
