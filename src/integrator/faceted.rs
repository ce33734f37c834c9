//! A vertex on the facets that a triangle with a shading normal stands for; see
//! [`crate::material::Facets`].
//!
//! One way over the facets serves both: a light is asked for at each of its scatterings, all of
//! them for the same point of the same light, and the path goes on where the way gets out. The
//! weights of both are those of a path with as many vertices.

use super::borders::interior_beyond;
use super::crossing::Crossing;
use super::dimensions::{choice_dimension, direction_dimension, facet_dimension, light_dimension};
use super::interior::Interior;
use super::light::{looks_for_borders, shadow_ray};
use super::mis::power_heuristic;
use super::russian_roulette::survives_russian_roulette;
use super::state::{Direct, Path, PathSample};
use super::transit::{Shine, Transit};
use crate::material::{Bsdf, FacetNumbers, FacetSample, Facets, OnFacet};
use crate::math::{Ray, Vec3};
use crate::sampling::StreamId;
use crate::world::{LightSample, Surface, World};

/// A surface, how its facets scatter, and the unit direction to the viewer.
#[derive(Clone, Copy)]
pub struct Faceted<'a> {
    pub surface: &'a Surface,
    pub bsdf: &'a Bsdf,
    pub facets: &'a Facets,
    pub viewer: Vec3,
}

/// Samples the light that the end of segment number `depth` is asked for, and takes the path on:
/// what comes directly, and the ray to go on with. `roulette`: perhaps it ends there.
#[inline(never)]
pub fn scatter_on_facets(
    world: &World,
    depth: u32,
    path: &mut Path,
    at: Faceted,
    roulette: bool,
    sample: &mut PathSample,
) -> (Option<Direct>, Option<Ray>) {
    let Faceted { surface, bsdf, facets, viewer } = at;
    let mut sampler = path.stream.at(choice_dimension(depth));
    let [u_lobe, u_roulette, u_light] = [(); 3].map(|()| sampler.next_1d());
    let in_vain = bsdf.is_delta() || world.lights.is_dark();
    let mut asked = if in_vain {
        None
    } else {
        let u = path.stream.at(light_dimension(depth)).next_2d();
        let light = world.sample_light(surface, &path.context, u_light, u);
        light.map(|light| Asked::new(world, path, at, light))
    };

    let u_direction = path.stream.at(direction_dimension(depth)).next_2d();
    let stream = path.stream;
    let [_, u_facet, _] = extra_numbers(stream, depth, 0);
    let numbers = |scattering: u32| {
        let [_, _, escape] = extra_numbers(stream, depth, scattering);
        if scattering == 0 {
            return FacetNumbers { direction: u_direction, lobe: u_lobe, escape };
        }
        let mut sampler = stream.at(facet_dimension(depth, scattering));
        let direction = sampler.next_2d();
        FacetNumbers { direction, lobe: sampler.next_1d(), escape }
    };
    let scattered = facets.walk(bsdf, viewer, u_facet, numbers, |scattering, on: &OnFacet| {
        if let Some(asked) = &mut asked {
            let [u_choice, ..] = extra_numbers(stream, depth, scattering);
            asked.add(on, u_choice);
        }
    });
    let direct = asked.and_then(|asked| asked.direct(world, path));
    let u_roulette = roulette.then_some(u_roulette);
    (direct, scattered.and_then(|it| go_on(world, path, at, &it, u_roulette, sample)))
}

/// The numbers of a scattering on facets beyond its direction and its lobe: the choice of it for a
/// light, the choice of the first facet, and whether it gets out.
fn extra_numbers(stream: StreamId, depth: u32, scattering: u32) -> [f32; 3] {
    let mut sampler = stream.at(facet_dimension(depth, scattering) + 4);
    [(); 3].map(|()| sampler.next_1d())
}

/// Takes a path on where its way over the facets has got out.
fn go_on(
    world: &World,
    path: &mut Path,
    Faceted { surface, .. }: Faceted,
    scattered: &FacetSample,
    u_roulette: Option<f32>,
    sample: &mut PathSample,
) -> Option<Ray> {
    let crossing = Crossing::of(surface, scattered.front == surface.front);
    path.throughput *= scattered.weight;
    path.eta_squared *= scattered.eta * scattered.eta;
    path.pdf = if scattered.delta { f32::INFINITY } else { scattered.pdf };
    path.interior = interior_beyond(world, path.interior, surface, crossing);
    if !path.throughput.is_finite() {
        sample.radiance = Vec3::NAN; // to be counted and left out, not hidden
        return None;
    }
    let goes_on = u_roulette
        .is_none_or(|u| survives_russian_roulette(&mut path.throughput, path.eta_squared, u));
    let goes_on = goes_on && path.throughput != Vec3::ZERO;
    goes_on.then(|| surface.ray_towards(scattered.direction))
}

/// A light that is asked for at all scatterings of a way.
struct Asked {
    light: LightSample,
    /// The solids that it comes through.
    interior: Interior,
    /// Whether it must look for borders on its way. Then its weight is not known yet, and one
    /// scattering is chosen for all.
    through_borders: bool,
    /// What all scatterings return of it to the viewer, weighed.
    sum: Vec3,
    /// The value that was chosen, over the probability of that, and its density.
    chosen: (Vec3, f32),
    /// What the choice was among.
    total: f32,
}

impl Asked {
    fn new(world: &World, path: &Path, at: Faceted, light: LightSample) -> Self {
        let Faceted { surface, facets, .. } = at;
        let stays = facets.is_in_front(light.direction) == surface.front;
        let crossing = Crossing::of(surface, stays);
        let interior = interior_beyond(world, path.interior, surface, crossing);
        Self {
            light,
            interior,
            through_borders: looks_for_borders(world, interior),
            sum: Vec3::ZERO,
            chosen: (Vec3::ZERO, 0.0),
            total: 0.0,
        }
    }

    /// Asks at one of them.
    fn add(&mut self, on: &OnFacet, u_choice: f32) {
        let (value, pdf) = on.eval(self.light.direction);
        if self.through_borders {
            let size = value.x + value.y + value.z;
            self.total += size;
            if u_choice * self.total < size {
                self.chosen = (value / size, pdf);
            }
        } else if value != Vec3::ZERO {
            let light = &self.light;
            let weight = if light.delta { 1.0 } else { power_heuristic(light.pdf, pdf) };
            self.sum += value * weight;
        }
    }

    /// What comes of it.
    fn direct(self, world: &World, path: &Path) -> Option<Direct> {
        let Self { light, interior, .. } = self;
        if self.through_borders {
            let (value, pdf) = self.chosen;
            let shine = Shine { light, scattered: path.throughput * value * self.total, pdf };
            return Transit::new(&shine, interior, path.densities).map(Direct::Transit);
        }
        let radiance = path.throughput * self.sum * light.radiance / light.pdf;
        shadow_ray(world, interior, light.ray, radiance)
    }
}
