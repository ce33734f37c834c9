//! Where many paths go on at once.

use super::shade::VertexLanes;
use super::solids::place;
use super::vertices::{Block, Scratch, for_each_lane, vec3};
use crate::geom::are_usable;
use crate::light::LightSampleContext;
use crate::material::lanes::{BsdfLanes, BsdfSamples};
use crate::math::{Ray, Vec3};
use crate::simd::lanes::{Float, Lanes, Mask, Vec3f};

/// Whether light crosses surfaces; see [`super::super::crossing::classify_crossing`].
pub(super) struct CrossingLanes<L: Lanes> {
    /// Where the light goes to the other side of the surface.
    pub crosses: L::Mask,
    /// Where its shading normal has it go there too, or stay with the viewer; everywhere if those
    /// are robust.
    pub agree: L::Mask,
    /// Where robust shading normals have it go to a side that its direction leads away from.
    pub astray: L::Mask,
}

impl<L: Lanes> VertexLanes<L> {
    /// Tells on which side of the surfaces light goes on, in a direction in world space and
    /// locally.
    #[inline(always)]
    pub fn cross(&self, lanes: L, direction: Vec3f<L>, wi: Vec3f<L>) -> CrossingLanes<L> {
        let zero = lanes.float(0.0);
        let above = self.surface.normal.dot(direction);
        let crosses = above.gt(zero) ^ self.surface.front;
        let seems_to_cross = wi.z.gt(zero) ^ self.wo.z.gt(zero);
        let agree = !above.eq(zero) & !(crosses ^ seems_to_cross);
        if self.surface.robust {
            let agree_all = lanes.first(L::WIDTH);
            CrossingLanes { crosses: seems_to_cross, agree: agree_all, astray: !agree }
        } else {
            CrossingLanes { crosses, agree, astray: lanes.mask(0) }
        }
    }

    /// Takes the paths on in the directions that their BSDFs have scattered them to, or ends them.
    #[inline(always)]
    pub fn scatter<B: BsdfLanes<L>>(
        &self,
        block: &mut Block<'_, '_, L>,
        scattered: &BsdfSamples<L>,
        u_roulette: L::Float,
    ) {
        let (lanes, surface) = (block.lanes, &self.surface);
        let direction = surface.frame.to_world(scattered.wi);
        let mut throughput = self.throughput * scattered.weight;
        let eta_squared = self.eta_squared * (scattered.eta * scattered.eta);
        let crossing = self.cross(lanes, direction, scattered.wi);
        let goes_on = self.live & scattered.valid & crossing.agree;
        let lost = goes_on & !throughput.is_finite(lanes);
        let mut goes_on = goes_on & !lost;
        if block.integrator.plays_roulette(block.depth) {
            let Vec3f { x, y, z } = throughput;
            let brightest = y.most(z).most(x);
            let survival = (brightest * eta_squared).least(lanes.float(0.95));
            goes_on = goes_on & u_roulette.lt(survival);
            throughput = throughput.divide(survival);
        }
        goes_on = goes_on & !throughput.is_zero();

        let (origin, _) = self.origins(block, direction, &crossing, goes_on);
        let usable = are_usable(lanes, origin, direction);
        let lost = lost | (goes_on & !usable);
        let goes_on = (goes_on & usable).to_bits();
        let pdf = if B::IS_DELTA { lanes.float(f32::INFINITY) } else { scattered.pdf };
        let Block { paths, scratch: Scratch { out, .. }, vertices, .. } = block;
        let [origins, directions, throughputs, ..] = out;
        lanes.rows(origin.columns(pdf), origins);
        lanes.rows(direction.columns(eta_squared), directions);
        lanes.rows(throughput.columns(pdf), throughputs);
        // To be counted and left out, not hidden.
        for_each_lane(lost.to_bits(), |lane| {
            let path = &vertices.paths[paths[lane] as usize];
            vertices.samples[path.slot as usize].radiance = Vec3::NAN;
        });
        self.go_on::<B>(block, &crossing, goes_on);
    }

    /// Takes those paths on whose bit is set, from the rows that `scatter` has put out.
    #[inline(always)]
    fn go_on<B: BsdfLanes<L>>(
        &self,
        block: &mut Block<'_, '_, L>,
        &CrossingLanes { crosses, .. }: &CrossingLanes<L>,
        goes_on: u32,
    ) {
        let Block { integrator, lanes, paths, scratch: Scratch { out, .. }, vertices, .. } = block;
        let (surface, zero) = (&self.surface, lanes.float(0.0));
        let [origins, directions, throughputs, positions, normals] = out;
        lanes.rows(surface.position.columns(zero), positions);
        if !B::TRANSMITS {
            let normal = surface.light_side();
            lanes.rows(normal.columns(zero), normals);
        }
        let inside = (crosses & surface.front & self.solid) | (!crosses & self.inside);
        let inside = inside.to_bits();
        for_each_lane(goes_on, |lane| {
            let i = paths[lane] as usize;
            let (origin, direction) = (vec3(origins[lane]), vec3(directions[lane]));
            let path = &mut vertices.paths[i];
            path.throughput = vec3(throughputs[lane]);
            path.pdf = throughputs[lane][3];
            let position = vec3(positions[lane]);
            if B::TRANSMITS {
                path.context = LightSampleContext { position, normal: Vec3::ZERO };
                path.eta_squared = directions[lane][3];
                let instances = &integrator.world().scene.instances;
                let instance = vertices.triangles[i].0;
                place(path, inside >> lane & 1 == 1, || instances[instance.index()].material);
            } else {
                path.context = LightSampleContext { position, normal: vec3(normals[lane]) };
            }
            vertices.rays[i] = Ray::usable(origin, direction, f32::INFINITY);
            vertices.alive[i] = true;
        });
    }
}
