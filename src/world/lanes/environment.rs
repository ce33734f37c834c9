//! The environment in lanes: as a light, and where rays leave the scene.

use super::super::World;
use super::light_samples::LightSamples;
use crate::light::{Environment, EnvironmentSamples};
use crate::simd::lanes::{Float, Lanes, Vec3f};

impl World {
    /// [`World::environment`] in lanes: radiance and density of unit directions.
    #[inline(always)]
    pub fn environment_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        environment: &Environment,
        direction: Vec3f<L>,
    ) -> (Vec3f<L>, L::Float) {
        let (radiance, pdf) = environment.radiance_and_pdf_in_lanes(lanes, direction);
        (radiance, pdf * self.lights.environment_pmf())
    }
}

/// Directions to the environment, which was chosen with probability `pmf`.
#[inline(always)]
pub(super) fn sample_environment<L: Lanes>(
    lanes: L,
    environment: &Environment,
    pmf: L::Float,
    u: [L::Float; 2],
) -> LightSamples<L> {
    let EnvironmentSamples { direction, radiance, pdf } = environment.sample_in_lanes(lanes, u);
    LightSamples {
        direction,
        radiance,
        pdf: pmf * pdf,
        delta: lanes.mask(0),
        end: direction,
        far: lanes.first(L::WIDTH),
        valid: pdf.gt(lanes.float(0.0)),
    }
}
