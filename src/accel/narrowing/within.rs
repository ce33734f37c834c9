//! The regions that a slice's start was found for.

use fearless_simd::Simd;

use crate::accel::packet::PacketRays;
use crate::geom::{RayBundle, Shaft};

/// Up to two regions, for which rays must lie in all.
#[derive(Default)]
pub struct Within([Option<Shaft>; 2]);

impl Within {
    /// The regions of a tile: that around it, if there is one, and its own.
    pub fn new(around: Option<Shaft>, tile: Shaft) -> Self {
        Self([around, Some(tile)])
    }

    /// Whether no ray is to be asked about.
    pub fn is_all(&self) -> bool {
        self.0.iter().all(Option::is_none)
    }

    /// Whether they are seen to hold the rays of a bundle.
    #[inline(always)]
    pub fn holds_bundle<S: Simd>(&self, simd: S, bundle: &RayBundle) -> bool {
        for shaft in self.0.iter().flatten() {
            if !shaft.holds_bundle(simd, bundle) {
                return false;
            }
        }
        true
    }

    /// Whether they are seen to hold rays, of which `around` was made: by the four corners of that,
    /// or bundle by bundle.
    #[inline(always)]
    pub fn holds<S: Simd>(&self, simd: S, rays: &PacketRays, around: &Shaft) -> bool {
        for shaft in self.0.iter().flatten() {
            if !shaft.contains(around) && !rays.are_held_by(simd, shaft) {
                return false;
            }
        }
        true
    }
}
