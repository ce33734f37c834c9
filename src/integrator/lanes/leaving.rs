//! How light leaves surfaces, for many paths at once.

use super::scatter::CrossingLanes;
use super::shade::VertexLanes;
use super::vertices::{Block, Scratch, for_each_lane};
use crate::math::Vec2;
use crate::simd::lanes::{Float, Lanes, Mask, Vec3f};

impl<L: Lanes> VertexLanes<L> {
    /// Where light leaves from that goes in a `direction`, in the lanes that are `wanted`; and
    /// where a surface itself is in its way. See [`super::super::leaving`], of which this is the
    /// form in lanes.
    #[inline(always)]
    pub fn origins(
        &self,
        block: &mut Block<'_, '_, L>,
        direction: Vec3f<L>,
        &CrossingLanes { crosses, astray, .. }: &CrossingLanes<L>,
        wanted: L::Mask,
    ) -> (Vec3f<L>, L::Mask) {
        let (lanes, surface) = (block.lanes, &self.surface);
        let plain = surface.offset_origin(lanes, direction);
        let astray = astray & wanted;
        if astray.to_bits() == 0 {
            return (plain, lanes.mask(0));
        }
        let Block { integrator, paths, scratch: Scratch { out, .. }, vertices, .. } = block;
        let [bulges, ..] = out;
        let (front, zero) = (surface.front.to_bits(), lanes.float(0.0));
        for_each_lane((astray & !crosses).to_bits(), |lane| {
            let i = paths[lane] as usize;
            let (hit, time) = (&vertices.hits[i], vertices.paths[i].time);
            let (at, front) = (Vec2::new(hit.u, hit.v), front >> lane & 1 == 1);
            bulges[lane][0] = integrator.world().bulge(vertices.triangles[i], at, time, front);
        });
        let [bulge, ..] = lanes.columns(bulges);
        let bulge = (astray & !crosses).select(bulge, zero);
        let facing = surface.facing();
        let side = Vec3f::select(crosses, -facing, facing);
        let beyond = surface.origin_beyond(lanes, side, bulge);
        (Vec3f::select(astray, beyond, plain), astray & bulge.le(zero))
    }
}
