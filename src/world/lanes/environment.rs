//! The environment as a light, in lanes.

use super::super::World;
use super::light::LightSamples;
use super::surface::SurfaceLanes;
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Vec3f};

impl World {
    /// Whether the environment is one that [`World::sample_light_in_lanes`] samples.
    #[inline(always)]
    pub(super) fn has_plain_environment(&self) -> bool {
        self.scene.environment.as_ref().is_some_and(|environment| environment.is_constant())
    }

    /// Directions to the environment, which was chosen with probability `pmf`.
    #[inline(always)]
    pub(super) fn sample_environment_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        surface: &SurfaceLanes<L>,
        pmf: L::Float,
        u: [L::Float; 2],
    ) -> LightSamples<L> {
        let radiance = self.scene.environment.as_ref().map_or(glam::Vec3::ZERO, |e| e.mean());
        let direction = warp::sphere_in_lanes(lanes, u);
        let pdf = pmf * warp::SPHERE_PDF;
        LightSamples {
            direction,
            radiance: Vec3f::of_vector(lanes, radiance),
            pdf,
            origin: surface.offset_origin(lanes, direction),
            segment: direction,
            t_max: lanes.float(f32::INFINITY),
            valid: pdf.gt(lanes.float(0.0)),
        }
    }
}
