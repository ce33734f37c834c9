//! What shines in a scene, and which of it to ask.

use std::sync::Arc;

use super::emitters::{
    Emitter, EvenEmission, area, emitting, mean, mean_area, sides, triangle_weight, weight,
};
use super::lamps::{Lamp, Lamps};
use super::light_sampler::{LightSampler, LightSamplerKind, punctual_bounds, triangle_bounds};
use crate::light::{Environment, LightBounds, LightSampleContext};
use crate::math::{InstanceId, TriangleId, Vec2};
use crate::sampling::mix_uniforms;
use crate::scene::{Scene, Triangles};

/// All lights under one running number: punctual lights, then the environment if there is one,
/// then what emits, by instance: its triangles, or all of it as one lamp; and what chooses one.
#[derive(Debug)]
pub struct Lights {
    sampler: LightSampler,
    punctual: usize,
    environment: Option<usize>,
    first_area: usize,
    /// What emits and has an area.
    areas: Vec<AreaLight>,
    /// For each instance, the number of its first light; `u32::MAX`: it does not emit.
    instances: Vec<u32>,
    lamps: Lamps,
}

/// What emits.
#[derive(Clone, Copy, Debug)]
enum AreaLight {
    Triangle(Emitter),
    /// All triangles of a placement whose mesh many have.
    Lamp(Lamp),
}

/// More emitting triangles than these are lights by placements where meshes are placed repeatedly.
const MOST_ALONE: u64 = 1 << 16;

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
    pub fn new(
        scene: &Scene,
        triangles: &Arc<Triangles>,
        radius: f32,
        kind: LightSamplerKind,
    ) -> Self {
        Self::with_lamps(scene, triangles, (radius, kind), MOST_ALONE)
    }

    /// The same with lamps where more triangles than `most_alone` emit.
    pub(super) fn with_lamps(
        scene: &Scene,
        triangles: &Arc<Triangles>,
        (radius, kind): (f32, LightSamplerKind),
        most_alone: u64,
    ) -> Self {
        let mut weights: Vec<f64> =
            scene.lights.iter().map(|light| punctual_weight(light.power(radius))).collect();
        let environment = scene.environment.as_ref().map(|_| {
            weights.push(0.0); // once the others are known
            weights.len() - 1
        });
        let first_area = weights.len();
        let lamps = Lamps::new(scene, triangles, kind, most_alone);
        let (mut areas, mut instances) = (Vec::new(), Vec::new());
        for instance in (0..scene.instances.len()).map(InstanceId::from_index) {
            let (material, mesh) = emitting(scene, instance);
            let Some(material) = material else {
                instances.push(u32::MAX);
                continue;
            };
            instances.push(weights.len() as u32);
            if let Some(lamp) = lamps.find(scene, instance) {
                weights.push(lamps.weight(scene, lamp));
                areas.push(AreaLight::Lamp(lamp));
                continue;
            }
            let moves = scene.moves(instance);
            for index in 0..scene.meshes[mesh].indices.len() as u32 {
                let id = TriangleId { instance, index };
                let triangle = triangles.of(id);
                let area = if moves { mean_area(triangles, id) } else { area(&triangle) };
                weights.push(triangle_weight(scene, material, id, area));
                let even = EvenEmission::new(material, triangle.corners()).filter(|_| !moves);
                areas.push(AreaLight::Triangle(Emitter { instance, index, even }));
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
            let with_areas = areas.iter().zip(&weights[first_area..]);
            bounds.extend(with_areas.map(|(light, &weight)| match *light {
                AreaLight::Lamp(lamp) => lamps.bounds(scene, lamp),
                AreaLight::Triangle(Emitter { instance, .. }) if scene.moves(instance) => {
                    LightBounds::NOWHERE
                }
                AreaLight::Triangle(Emitter { instance, index, .. }) => {
                    let sides = sides(emitting(scene, instance).0);
                    triangle_bounds(&triangles.of(TriangleId { instance, index }), sides, weight)
                }
            }));
            bounds
        };
        let sampler = LightSampler::new(weights.clone(), kind, bounds);
        Self { sampler, punctual, environment, first_area, areas, instances, lamps }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        self.sampler.is_empty()
    }

    /// The number of lights: each emitting triangle one, but where there are very many, copies of a
    /// mesh one each.
    pub fn len(&self) -> usize {
        self.first_area + self.areas.len()
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
        let (light, pmf, place) = self.sampler.sample_and_reuse(context, u_light, u)?;
        let chosen = if light >= self.first_area {
            match self.areas[light - self.first_area] {
                AreaLight::Triangle(emitter) => ChosenLight::Emitter(emitter),
                AreaLight::Lamp(lamp) => {
                    let u_triangle = mix_uniforms([u_light, u.x, u.y]);
                    let (emitter, share) = self.lamps.sample(lamp, context, u_triangle)?;
                    return Some((ChosenLight::Emitter(emitter), pmf * share, u));
                }
            }
        } else if light < self.punctual {
            ChosenLight::Punctual(light)
        } else {
            ChosenLight::Environment
        };
        Some((chosen, pmf, place))
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
        let first = self.instances[instance.index()] as usize;
        if first == u32::MAX as usize {
            return 0.0;
        }
        match self.areas[first - self.first_area] {
            AreaLight::Triangle(_) => self.sampler.near_probability(context, first + index),
            AreaLight::Lamp(lamp) => {
                let share = self.lamps.pmf(lamp, context, index);
                self.sampler.near_probability(context, first) * share
            }
        }
    }
}

/// As [`weight`], of a power that f32 may not hold.
fn punctual_weight(power: f64) -> f64 {
    if power.is_finite() { power.max(0.0) } else { 0.0 }
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
