//! Emitting triangles: what they are, and how much light they send, by which they are chosen.

use std::f32::consts::PI;

use super::interpolation::Interpolation;
use super::lookup::emission;
use crate::geom::Triangle;
use crate::light::Sides;
use crate::math::{InstanceId, TriangleId, Vec2, Vec3};
use crate::sampling::warp;
use crate::scene::{AlphaMode, Material, Scene, Triangles};

/// A triangle that emits: where it is, so that it need not be looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitter {
    pub instance: InstanceId,
    /// Its number in the instance's mesh.
    pub index: u32,
    /// If it is as bright all over.
    pub even: Option<EvenEmission>,
}

/// What a triangle emits at all of its points.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvenEmission {
    /// In the world.
    pub corners: [Vec3; 3],
    pub radiance: Vec3,
    pub both_sides: bool,
}

impl EvenEmission {
    /// Of a triangle of a material; `None` if it is not as bright all over.
    pub fn new(material: &Material, corners: [Vec3; 3]) -> Option<Self> {
        let is_even = material.emissive_texture.is_none()
            && !material.unlit
            && material.alpha_mode == AlphaMode::Opaque;
        let (radiance, both_sides) = (material.emissive, material.double_sided);
        is_even.then_some(Self { corners, radiance, both_sides })
    }
}

/// The material of an instance if it emits, and the number of its mesh.
pub(super) fn emitting(scene: &Scene, instance: InstanceId) -> (Option<&Material>, usize) {
    let instance = &scene.instances[instance.index()];
    let material = &scene.materials[instance.material.index()];
    (Some(material).filter(|material| material.is_emissive()), instance.mesh.index())
}

/// The sides that shine of what has an emitting material.
pub(super) fn sides(material: Option<&Material>) -> Sides {
    let both = material.is_some_and(|material| material.double_sided);
    if both { Sides::Both } else { Sides::Front }
}

/// The power of a triangle of so many square metres.
pub(super) fn triangle_weight(
    scene: &Scene,
    material: &Material,
    id: TriangleId,
    area: f32,
) -> f64 {
    let sides = if material.double_sided { 2.0 } else { 1.0 };
    weight(PI * area * sides * mean_emission(scene, id))
}

/// In square metres.
pub(super) fn area(triangle: &Triangle) -> f32 {
    0.5 * triangle.double_area().length()
}

/// The mean area of a triangle that moves; never zero where it has one at some of the times looked
/// at.
pub(super) fn mean_area(triangles: &Triangles, id: TriangleId) -> f32 {
    const TIMES: usize = 16;
    let time = |i: usize| (i as f32 + 0.5) / TIMES as f32;
    let areas = (0..TIMES).map(|i| area(&triangles.of_at(id, time(i))));
    areas.sum::<f32>() / TIMES as f32
}

/// Over the three channels.
pub(super) fn mean(radiance: Vec3) -> f32 {
    (radiance.x + radiance.y + radiance.z) / 3.0
}

/// A weight that the alias table takes: what is not finite or negative is not chosen.
pub(super) fn weight(power: f32) -> f64 {
    if power.is_finite() { f64::from(power.max(0.0)) } else { 0.0 }
}

/// Mean emission of a triangle over a few points of it; the material's factor has no say alone
/// where a texture dims it. Never zero where a point between might shine: then a little of it.
pub(super) fn mean_emission(scene: &Scene, id: TriangleId) -> f32 {
    let (instance, index) = (id.instance, id.index as usize);
    let instance = &scene.instances[instance.index()];
    let material = &scene.materials[instance.material.index()];
    if material.emissive_texture.is_none() {
        return mean(material.emissive);
    }
    const STEPS: usize = 8;
    let mesh = &scene.meshes[instance.mesh.index()];
    let cells = (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j)));
    let sum: f32 = cells
        .map(|(i, j)| {
            let u = Vec2::new(i as f32 + 0.5, j as f32 + 0.5) / STEPS as f32;
            let uv = warp::triangle(u);
            let point = Interpolation::new(mesh, index, instance.transform.mirrored(), uv.x, uv.y);
            mean(emission(scene, material, &point.attributes((instance.mesh, mesh), true)))
        })
        .sum();
    (sum / (STEPS * STEPS) as f32).max(1e-3 * mean(material.emissive))
}
