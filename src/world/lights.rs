//! What shines in a scene, and which of it to ask.

use std::f32::consts::PI;

use super::light_choice::{Chooser, of_punctual, of_triangle};
use super::surface::{offset_origin, triangle_point};
use super::world::emission;
use super::{LightChoice, Surface, World};
use crate::geom::TriangleSource;
use crate::light::{
    Environment, LightBounds, Punctual, Sides, Vantage, area_to_solid_angle, sample_triangle,
};
use crate::math::{InstanceId, Ray, TriangleId, Vec2, Vec3};
use crate::scene::defaults::bounds;
use crate::scene::{Scene, Triangles};

/// All lights under one running number: punctual lights, then the environment if there is one,
/// then emitting triangles by instance; and what chooses one.
#[derive(Debug)]
pub struct Lights {
    chooser: Chooser,
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
struct Emitter {
    instance: InstanceId,
    /// Its number in the instance's mesh.
    index: u32,
}

/// A light chosen for a point, and a direction to it.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction towards the light.
    pub direction: Vec3,
    /// Radiance that arrives if nothing is in between; irradiance where `delta`.
    pub radiance: Vec3,
    /// Density over solid angle, or the light's probability where `delta`; times one another.
    pub pdf: f32,
    /// Whether no other strategy could find the light, which has no extent.
    pub delta: bool,
    /// The segment that must be free, and its length in metres.
    pub ray: Ray,
}

impl Lights {
    /// The lights of a scene, to be chosen as told.
    pub fn new(scene: &Scene, triangles: &Triangles, choice: LightChoice) -> Self {
        let radius = 0.5 * bounds(scene).extent().max(Vec3::ZERO).length();
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
            let first = triangles.first(InstanceId::from_index(index));
            let sides = if material.double_sided { 2.0 } else { 1.0 };
            for number in 0..mesh.indices.len() {
                let id = TriangleId(first.0 + number as u32);
                let area = 0.5 * triangles.triangle(id).double_area().length();
                let radiance = mean_emission(scene, triangles, id);
                weights.push(weight(PI * area * sides * radiance));
                let instance = InstanceId::from_index(index);
                emitters.push(Emitter { instance, index: number as u32 });
            }
        }
        if let (Some(light), Some(environment)) = (environment, &scene.environment) {
            let others: f64 = weights.iter().sum();
            let share = environment_share(environment);
            weights[light] = if others > 0.0 { others * share / (1.0 - share) } else { 1.0 };
        }
        let punctual = scene.lights.len();
        let bounds = || {
            let mut bounds = of_punctual(scene, &weights);
            bounds.extend(environment.map(|_| LightBounds::NOWHERE));
            let of_triangles = emitters.iter().zip(&weights[first_triangle..]);
            bounds.extend(of_triangles.map(|(emitter, &weight)| {
                let instance = &scene.instances[emitter.instance.index()];
                let both = scene.materials[instance.material.index()].double_sided;
                let sides = if both { Sides::Both } else { Sides::Front };
                of_triangle(triangles, (emitter.instance, emitter.index), sides, weight)
            }));
            bounds
        };
        let chooser = Chooser::new(weights.clone(), choice, bounds);
        Self { chooser, punctual, environment, first_triangle, triangles: emitters, instances }
    }

    /// Whether nothing shines.
    pub fn is_dark(&self) -> bool {
        self.chooser.is_empty()
    }

    /// The number of lights, each emitting triangle one.
    pub fn len(&self) -> usize {
        self.first_triangle + self.triangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The probability that the environment is chosen.
    fn environment_pmf(&self) -> f32 {
        self.environment.map_or(0.0, |light| self.chooser.far_probability(light))
    }

    /// The probability that a triangle is chosen for a point: the one numbered `index` of an
    /// instance.
    fn triangle_pmf(&self, vantage: &Vantage, instance: InstanceId, index: usize) -> f32 {
        match self.instances[instance.index()] {
            u32::MAX => 0.0,
            first => self.chooser.near_probability(vantage, first as usize + index),
        }
    }
}

impl World {
    /// Chooses a light and a direction to it, from a `surface` that is asked about as `vantage`
    /// tells: by `u_light` which light, by `u` where on it. `None` where nothing arrives from there.
    #[inline(always)]
    pub fn sample_light(
        &self,
        surface: &Surface,
        vantage: &Vantage,
        u_light: f32,
        u: Vec2,
    ) -> Option<LightSample> {
        let lights = &self.lights;
        let (light, pmf) = lights.chooser.sample(vantage, u_light)?;
        if light >= lights.first_triangle {
            let emitter = lights.triangles[light - lights.first_triangle];
            self.sample_emitter(surface, emitter, pmf, u)
        } else if light < lights.punctual {
            Self::sample_punctual(surface, &self.scene.lights[light], pmf)
        } else {
            let environment = self.scene.environment.as_ref()?;
            let sample = environment.sample(u)?;
            Some(LightSample {
                direction: sample.direction,
                radiance: sample.radiance,
                pdf: pmf * sample.pdf,
                delta: false,
                ray: surface.ray_towards(sample.direction),
            })
        }
    }

    /// What the environment sends along a ray that left the scene in a unit `direction`, and the
    /// density with which [`World::sample_light`] chooses that direction; zero without one.
    pub fn environment(&self, direction: Vec3) -> (Vec3, f32) {
        let Some(environment) = &self.scene.environment else { return (Vec3::ZERO, 0.0) };
        let (radiance, pdf) = environment.radiance_and_pdf(direction);
        (radiance, pdf * self.lights.environment_pmf())
    }

    /// What a `surface` sends back along a ray that hit it; `None` where it does not emit.
    #[inline]
    pub fn emitted(&self, surface: &Surface) -> Option<Vec3> {
        let material = self.material(surface.material);
        if material.unlit {
            // Found by following paths alone: it is no light, but looks its colour from everywhere.
            return Some(self.emission(surface.material, &surface.attributes));
        }
        if !material.is_emissive() || !(surface.front || material.double_sided) {
            return None;
        }
        Some(self.emission(surface.material, &surface.attributes))
    }

    /// The density over solid angle with which [`World::sample_light`] chooses for `vantage`, where
    /// a ray of unit `direction` began, the point of a `surface` that the ray hit at `distance`.
    pub fn emitter_pdf(
        &self,
        surface: &Surface,
        vantage: &Vantage,
        direction: Vec3,
        distance: f32,
    ) -> f32 {
        if self.material(surface.material).unlit {
            return 0.0;
        }
        let pmf = self.lights.triangle_pmf(vantage, surface.instance, surface.triangle);
        let cosine = surface.normal.dot(direction);
        pmf * area_to_solid_angle(surface.area, distance * distance, cosine)
    }

    #[inline(always)]
    fn sample_emitter(
        &self,
        surface: &Surface,
        Emitter { instance, index }: Emitter,
        pmf: f32,
        u: Vec2,
    ) -> Option<LightSample> {
        let triangle = self.triangles.of(instance, index as usize);
        let sample = sample_triangle(&triangle, u);
        let towards = sample.point - surface.position;
        let distance2 = towards.length_squared();
        let direction = towards.try_normalize()?;
        let cosine = -sample.normal.dot(direction);
        let pdf = pmf * area_to_solid_angle(sample.area, distance2, cosine);
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None; // edge-on, or without area
        }
        let (material, at) = self.texture_point(instance, index as usize, sample.uv);
        if cosine < 0.0 && !self.material(material).double_sided {
            return None;
        }
        let radiance = self.emission(material, &at) * self.coverage(material, &at);
        if radiance == Vec3::ZERO {
            return None;
        }
        // From beyond this surface to short of the light's, both by their errors.
        let (point, error) = triangle_point(&triangle, sample.uv.x, sample.uv.y, self.slack);
        let end = offset_origin(point, error, sample.normal, -direction);
        let ray = segment(surface, direction, end);
        Some(LightSample { direction, radiance, pdf, delta: false, ray })
    }

    fn sample_punctual(surface: &Surface, light: &Punctual, pmf: f32) -> Option<LightSample> {
        let lit = light.illuminate(surface.position)?;
        let ray = match lit.origin {
            Some(end) => segment(surface, lit.direction, end),
            None => surface.ray_towards(lit.direction),
        };
        let (direction, radiance) = (lit.direction, lit.irradiance);
        Some(LightSample { direction, radiance, pdf: pmf, delta: true, ray })
    }
}

/// From just beyond a surface to `end`.
#[inline(always)]
fn segment(surface: &Surface, direction: Vec3, end: Vec3) -> Ray {
    let origin = offset_origin(surface.position, surface.position_error, surface.normal, direction);
    Ray::new(origin, end - origin, 0.0, 1.0)
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
fn mean_emission(scene: &Scene, triangles: &Triangles, id: TriangleId) -> f32 {
    let (instance, index) = triangles.locate(id);
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
            let uv = crate::sampling::warp::triangle(u);
            let point = crate::world::surface::Interpolation::new(
                mesh,
                index,
                instance.transform.mirrored,
                uv.x,
                uv.y,
            );
            mean(emission(scene, material, &point.attributes(mesh, true)))
        })
        .sum();
    (sum / (STEPS * STEPS) as f32).max(1e-3 * mean(material.emissive))
}
