//! The light of the environment, for many paths at once.

use super::super::path::PathTracer;
use super::vertices::{Vertices, row, vec3};
use crate::simd::lanes::{Float, Lanes, Mask, Rows, Vec3f};

/// Adds the light of the environment to paths in air that leave the scene: those listed in `order`.
/// See `light::add_environment`.
#[inline(always)]
pub fn add_environment_in_lanes<L: Lanes>(
    integrator: &PathTracer<'_>,
    lanes: L,
    order: &[u32],
    vertices: &mut Vertices<'_>,
) {
    let world = integrator.world();
    let Some(environment) = &world.scene.environment else { return };
    let [mut directions, mut throughputs, mut radiances] = [Rows::default(); 3];
    for block in order.chunks(L::WIDTH) {
        for lane in 0..L::WIDTH {
            let i = block[lane.min(block.len() - 1)] as usize;
            directions[lane] = row(vertices.rays[i].direction(), vertices.paths[i].pdf);
            throughputs[lane] = row(vertices.paths[i].throughput, 0.0);
        }
        let [x, y, z, path_pdf] = lanes.columns(&directions);
        let throughput = Vec3f::<L>::of_columns(lanes.columns(&throughputs));
        let direction = Vec3f::new(x, y, z);
        let (radiance, pdf) = world.environment_in_lanes(lanes, environment, direction);
        let one = lanes.float(1.0);
        let ratio = pdf / path_pdf;
        let weight = one / (ratio * ratio + 1.0);
        if *vertices.follows {
            lanes.rows(radiance.columns(one), &mut radiances);
            for (&i, &radiance) in block.iter().zip(&radiances) {
                let path = &vertices.paths[i as usize];
                let first = vertices.samples[path.slot as usize].first.as_mut();
                if let Some(first) = first.filter(|first| first.goes_on) {
                    first.follow_to_environment(path.throughput, vec3(radiance));
                }
            }
        }
        let alone = path_pdf.eq(lanes.float(f32::INFINITY));
        let radiance = (throughput * radiance).scale(alone.select(one, weight));
        lanes.rows(radiance.columns(one), &mut radiances);
        for (&i, &radiance) in block.iter().zip(&radiances) {
            let slot = vertices.paths[i as usize].slot as usize;
            vertices.samples[slot].radiance += vec3(radiance);
        }
    }
}
