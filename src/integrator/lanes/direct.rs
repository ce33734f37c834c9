//! Direct light, for many paths at once.

use super::super::state::ShadowRay;
use super::shade::VertexLanes;
use super::vertices::{Block, Scratch, for_each_lane, vec3};
use crate::geom::are_usable;
use crate::material::lanes::BsdfLanes;
use crate::math::{Ray, Vec3};
use crate::simd::lanes::{Lanes, Mask};

impl<L: Lanes> VertexLanes<L> {
    /// Asks for a light at each vertex, of surfaces that let no light pass. A bit for each lane
    /// that must be left to `light::sample_direct`, of which this is the form in lanes.
    #[inline(always)]
    pub fn sample_direct<B: BsdfLanes<L>>(
        &self,
        block: &mut Block<'_, '_, L>,
        bsdf: &B,
        u_light: L::Float,
        u: [L::Float; 2],
    ) -> u32 {
        let Self { surface, .. } = self;
        let Block { integrator, lanes, paths, scratch, vertices, .. } = block;
        let (lanes, Scratch { light: rows, out }) = (*lanes, &mut **scratch);
        let (light, others) =
            integrator.world().sample_light_in_lanes(lanes, surface, u_light, u, rows);
        let lost = (self.live & !surface.valid).to_bits() | (others & self.live.to_bits());

        let wi = surface.frame.to_local(light.direction);
        let (scattered, pdf) = bsdf.eval(lanes, self.wo, wi);
        let ratio = pdf / light.pdf;
        let one = lanes.float(1.0);
        let weight = light.delta.select(one, one / (ratio * ratio + 1.0));
        let radiance = (self.throughput * scattered * light.radiance).scale(weight / light.pdf);
        let asks = light.valid
            & self.cross(lanes, light.direction, wi).agree
            & !scattered.is_zero()
            & !radiance.is_zero();
        let asks = (self.live & asks).to_bits() & !lost;
        if asks != 0 {
            let zero = lanes.float(0.0);
            let usable = are_usable(lanes, light.origin, light.segment).to_bits();
            let [origins, segments, radiances, ..] = out;
            lanes.rows(light.origin.columns(zero), origins);
            lanes.rows(light.segment.columns(light.t_max), segments);
            lanes.rows(radiance.columns(zero), radiances);
            for_each_lane(asks, |lane| {
                let ([x, y, z, t_max], path) = (segments[lane], paths[lane] as usize);
                let segment = Vec3::new(x, y, z);
                let ray = if usable >> lane & 1 == 1 {
                    Ray::usable(vec3(origins[lane]), segment, t_max)
                } else {
                    Ray::MISS
                };
                let shadow = ShadowRay { ray, radiance: vec3(radiances[lane]) };
                vertices.shadow_rays.push(&vertices.paths[path], shadow);
            });
        }
        lost
    }
}
