//! What shines in a scene, and which of it to ask.

use std::f32::consts::PI;

use super::interpolation::Interpolation;
use super::light_sampler::{LightSampler, LightSamplerKind, punctual_bounds, triangle_bounds};
use super::lookup::emission;
use crate::geom::Triangle;
use crate::light::{Environment, LightBounds, LightSampleContext, Sides};
use crate::math::{InstanceId, TriangleId, Vec2, Vec3};
use crate::sampling::warp;
use crate::scene::{AlphaMode, Scene, Triangles};

/// All lights under one running number: punctual lights, then the environment if there is one,
/// then emitting triangles by instance; and what chooses one.
#[derive(Debug)]
pub struct Lights {
    sampler: LightSampler,
    punctual: usize,
    environment: Option<usize>,
    first_triangle: usize,
    /// Emitting triangles.
    triangles: Vec<Emitter>,
    /// For each instance, the number of its first triangle's light; `u32::MAX`: it does not emit.
    instances: Vec<u32>,
}

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

/// A light that was chosen.
#[derive(Clone, Copy, Debug)]
pub(super) enum ChosenLight {
    /// The one of that number in the scene.
    Punctual(usize),
    /// What shines from infinitely far away.
    Environment,
    /// A triangle.
    Emitter(Emitter),
}

impl Lights {
    /// The lights of a scene within `radius` metres, to be chosen as told.
    pub fn new(scene: &Scene, triangles: &Triangles, radius: f32, kind: LightSamplerKind) -> Self {
        let mut weights: Vec<f64> =
            scene.lights.iter().map(|light| weight(light.power(radius))).collect();
        let environment = scene.environment.as_ref().map(|_| {
            weights.push(0.0); // once the others are known
            weights.len() - 1
        });
        let first_triangle = weights.len();
        let (mut emitters, mut instances) = (Vec::new(), Vec::new());
        for (index, instance) in scene.instances.iter().enumerate() {
            let material = &scene.materials[instance.material.index()];
            if !material.is_emissive() {
                instances.push(u32::MAX);
                continue;
            }
            instances.push(weights.len() as u32);
            let mesh = &scene.meshes[instance.mesh.index()];
            let sides = if material.double_sided { 2.0 } else { 1.0 };
            let is_even = material.emissive_texture.is_none()
                && !material.unlit
                && material.alpha_mode == AlphaMode::Opaque;
            let moves = scene.moves(InstanceId::from_index(index));
            for number in 0..mesh.indices.len() {
                let instance = InstanceId::from_index(index);
                let id = TriangleId { instance, index: number as u32 };
                let triangle = triangles.of(id);
                let area = if moves { mean_area(triangles, id) } else { area(&triangle) };
                let radiance = mean_emission(scene, id);
                weights.push(weight(PI * area * sides * radiance));
                let even = (is_even && !moves).then_some(EvenEmission {
                    corners: [triangle.a, triangle.b, triangle.c],
                    radiance: material.emissive,
                    both_sides: material.double_sided,
                });
                emitters.push(Emitter { instance, index: number as u32, even });
            }
        }
        if let (Some(light), Some(environment)) = (environment, &scene.environment) {
            let others: f64 = weights.iter().sum();
            let share = environment_share(environment);
            weights[light] = if others > 0.0 { others * share / (1.0 - share) } else { 1.0 };
        }
        let punctual = scene.lights.len();
        let bounds = || {
            let mut bounds = punctual_bounds(scene, &weights);
            bounds.extend(environment.map(|_| LightBounds::NOWHERE));
            let of_triangles = emitters.iter().zip(&weights[first_triangle..]);
            bounds.extend(of_triangles.map(|(emitter, &weight)| {
                if scene.moves(emitter.instance) {
                    return LightBounds::NOWHERE;
                }
                let instance = &scene.instances[emitter.instance.index()];
                let both = scene.materials[instance.material.index()].double_sided;
                let sides = if both { Sides::Both } else { Sides::Front };
                triangle_bounds(triangles, (emitter.instance, emitter.index), sides, weight)
            }));
            bounds
        };
        let sampler = LightSampler::new(weights.clone(), kind, bounds);
        Self { sampler, punctual, environment, first_triangle, triangles: emitters, instances }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        self.sampler.is_empty()
    }

    /// The number of lights, each emitting triangle one.
    pub fn len(&self) -> usize {
        self.first_triangle + self.triangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Chooses a light for a point by `u_light`, with its probability and what is to choose the
    /// place on it instead of `u`; `None`: none shines there.
    #[inline(always)]
    pub(super) fn choose(
        &self,
        context: &LightSampleContext,
        u_light: f32,
        u: Vec2,
    ) -> Option<(ChosenLight, f32, Vec2)> {
        let (light, pmf, u) = self.sampler.sample_and_reuse(context, u_light, u)?;
        let chosen = if light >= self.first_triangle {
            ChosenLight::Emitter(self.triangles[light - self.first_triangle])
        } else if light < self.punctual {
            ChosenLight::Punctual(light)
        } else {
            ChosenLight::Environment
        };
        Some((chosen, pmf, u))
    }

    /// Whether the choice of a light, or what one without extent sends, depends on who asks.
    #[inline(always)]
    pub(super) fn need_context(&self) -> bool {
        self.sampler.needs_context() || self.punctual > 0
    }

    /// The probability that the environment is chosen.
    pub(super) fn environment_pmf(&self) -> f32 {
        self.environment.map_or(0.0, |light| self.sampler.far_probability(light))
    }

    /// The probability that a triangle is chosen for a point: the one numbered `index` of an
    /// instance.
    pub(super) fn triangle_pmf(
        &self,
        context: &LightSampleContext,
        instance: InstanceId,
        index: usize,
    ) -> f32 {
        match self.instances[instance.index()] {
            u32::MAX => 0.0,
            first => self.sampler.near_probability(context, first as usize + index),
        }
    }
}

fn area(triangle: &Triangle) -> f32 {
    0.5 * triangle.double_area().length()
}

/// The mean area of a triangle that moves; never zero where it has one at some of the times looked
/// at.
fn mean_area(triangles: &Triangles, id: TriangleId) -> f32 {
    const TIMES: usize = 16;
    let time = |i: usize| (i as f32 + 0.5) / TIMES as f32;
    let areas = (0..TIMES).map(|i| area(&triangles.of_at(id, time(i))));
    areas.sum::<f32>() / TIMES as f32
}

/// How often the environment is chosen where there are other lights. Its power is no measure: what
/// falls on the bounding sphere grows with a ground plane that no one looks at. An even one is
/// found as well by following the surface's own scattering, and so asked less often.
fn environment_share(environment: &Environment) -> f64 {
    if weight(mean(environment.mean())) == 0.0 {
        0.0
    } else if environment.is_constant() {
        0.25
    } else {
        0.5
    }
}

fn mean(radiance: Vec3) -> f32 {
    (radiance.x + radiance.y + radiance.z) / 3.0
}

/// A weight that the alias table takes: what is not finite or negative is not chosen.
fn weight(power: f32) -> f64 {
    if power.is_finite() { f64::from(power.max(0.0)) } else { 0.0 }
}

/// Mean emission of a triangle over a few points of it; the material's factor has no say alone
/// where a texture dims it. Never zero where a point between might shine: then a little of it.
fn mean_emission(scene: &Scene, id: TriangleId) -> f32 {
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
            mean(emission(scene, material, &point.attributes(mesh, true)))
        })
        .sum();
    (sum / (STEPS * STEPS) as f32).max(1e-3 * mean(material.emissive))
}
