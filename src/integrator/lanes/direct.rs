//! Direct light, for many paths at once.

use super::super::state::ShadowRay;
use super::shade::VertexLanes;
use super::vertices::{Block, Scratch, for_each_lane, vec3};
use crate::geom::are_usable;
use crate::material::lanes::BsdfLanes;
use crate::math::{Ray, Vec3};
use crate::simd::lanes::{Lanes, Mask, Vec3f};

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
        let Block { integrator, lanes, scratch, .. } = block;
        let (lanes, rows) = (*lanes, &mut scratch.light);
        let (light, others) =
            integrator.world().sample_light_in_lanes(lanes, surface, u_light, u, rows);
        let lost = (self.live & !surface.valid).to_bits() | (others & self.live.to_bits());

        let wi = surface.frame.to_local(light.direction);
        let (scattered, pdf) = bsdf.eval(lanes, self.wo, wi);
        let ratio = pdf / light.pdf;
        let one = lanes.float(1.0);
        let weight = light.delta.select(one, one / (ratio * ratio + 1.0));
        let radiance = (self.throughput * scattered * light.radiance).scale(weight / light.pdf);
        let crossing = self.cross(lanes, light.direction, wi);
        let asks = light.valid & crossing.agree & !scattered.is_zero() & !radiance.is_zero();
        let asks = self.live & asks & !lanes.mask(lost);
        if asks.to_bits() != 0 {
            let (zero, infinity) = (lanes.float(0.0), lanes.float(f32::INFINITY));
            let (origin, blocked) = self.origins(block, light.direction, &crossing, asks);
            let segment = Vec3f::select(light.far, light.end, light.end - origin);
            let t_max = light.far.select(infinity, one);
            let asks = (asks & !blocked).to_bits();
            let usable = are_usable(lanes, origin, segment).to_bits();
            let Block { paths, scratch: Scratch { out, .. }, vertices, .. } = block;
            let [origins, segments, radiances, ..] = out;
            lanes.rows(origin.columns(zero), origins);
            lanes.rows(segment.columns(t_max), segments);
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
