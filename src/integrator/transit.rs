//! Light on its way from a source to a vertex through the borders of solids that do not bend it:
//! such as another solid hides, and such as have the same index of refraction on both sides.
//!
//! Shadow rays ask whether anything is in the way; these ask what is, as often as it takes. Each
//! stretch takes its share of the light, by the medium that it lies in. A path that goes the same
//! way by chance passes the same borders, see [`passable_tint`], and the two ways are weighed
//! against each other at the end, where the chance of the path's passing is known.

use super::borders::{interior_beyond, is_hidden_in};
use super::crossing::Crossing;
use super::interior::Interior;
use super::mis::power_heuristic;
use crate::accel::ClosestHit;
use crate::math::{MaterialId, Ray, Vec3};
use crate::world::{LightSample, Surface, World};

/// A light that shines on a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Shine {
    /// What shines.
    pub light: LightSample,
    /// What of it would reach the camera, per radiance.
    pub scattered: Vec3,
    /// The density with which the path itself would have gone there.
    pub pdf: f32,
}

/// Light under way.
#[derive(Clone, Copy, Debug)]
pub struct Transit {
    /// What is left to cross.
    pub ray: Ray,
    /// What is left of the light, before it is weighed.
    radiance: Vec3,
    /// The solids around.
    interior: Interior,
    /// Of each colour, the density with which it would have drawn the path and passed so far.
    densities: Vec3,
    /// Densities over solid angle of the light's and of the path's choice; zero, if no path finds
    /// the light.
    light_pdf: f32,
    path_pdf: f32,
}

/// What becomes of light.
pub enum Passage {
    /// It does not arrive.
    Blocked,
    /// It does.
    Arrives(Vec3),
    /// There is more to cross.
    GoesOn(Transit),
}

impl Transit {
    /// Sets out from a vertex towards a light, in that interior; `densities` are those of the path
    /// that asks. `None` where nothing would arrive.
    pub fn new(shine: &Shine, interior: Interior, densities: Vec3) -> Option<Self> {
        let Shine { light, scattered, pdf: path_pdf } = *shine;
        let radiance = scattered * light.radiance / light.pdf;
        let light_pdf = if light.delta { 0.0 } else { light.pdf };
        let made = Self { ray: light.ray, radiance, interior, densities, light_pdf, path_pdf };
        (radiance != Vec3::ZERO).then_some(made)
    }

    /// Takes the light as far as to what its ray has met, at a `time` of the shutter.
    pub fn cross(mut self, world: &World, hit: &ClosestHit, time: f32) -> Passage {
        let direction = self.ray.direction();
        if !hit.is_hit() {
            let whole = if self.ray.t_max() < f32::INFINITY {
                direction.length() * self.ray.t_max()
            } else {
                f32::INFINITY
            };
            self.dim(world, whole);
            return self.arrive();
        }
        let surface = world.surface(&self.ray, hit, (time, 0.0));
        if !surface.front && world.is_solid(surface.material) && self.interior.is_air() {
            self.interior = self.interior.behind(surface.material, world);
        }
        self.dim(world, direction.length() * hit.t);
        if !surface.front && world.is_solid(surface.material) {
            self.interior = self.interior.behind(surface.material, world);
        }
        let Some(tint) = passable_tint(world, self.interior, &surface) else {
            return Passage::Blocked;
        };
        self.radiance *= tint;
        if self.radiance == Vec3::ZERO {
            return Passage::Blocked;
        }
        self.interior = beyond_passable(world, self.interior, &surface);
        self.ray = if self.ray.t_max() < f32::INFINITY {
            let end = self.ray.origin() + direction * self.ray.t_max();
            let origin = surface.ray_towards(direction.normalize()).origin();
            // What is left may be too short to be a ray: then nothing is in between.
            Ray::new(origin, end - origin, 0.0, 1.0)
        } else {
            surface.ray_towards(direction)
        };
        if self.ray == Ray::MISS || self.ray.direction().dot(direction) <= 0.0 {
            return self.arrive();
        }
        Passage::GoesOn(self)
    }

    /// Takes away what the medium around does over `distance` metres.
    fn dim(&mut self, world: &World, distance: f32) {
        let id = self.interior.solid();
        let left = world.transmittance_in(id, distance);
        self.radiance *= left;
        if world.medium(id).is_some_and(crate::medium::Medium::scatters) {
            self.densities *= left;
        }
    }

    fn arrive(self) -> Passage {
        let passes = (self.densities.x + self.densities.y + self.densities.z) * (1.0 / 3.0);
        let weight = if self.light_pdf > 0.0 {
            power_heuristic(self.light_pdf, self.path_pdf * passes)
        } else {
            1.0
        };
        Passage::Arrives(self.radiance * weight)
    }
}

/// What a surface leaves of light that goes straight through it, between the solids of that
/// interior; `None` where it does anything else to it.
pub fn passable_tint(world: &World, interior: Interior, surface: &Surface) -> Option<Vec3> {
    if !world.is_solid(surface.material) {
        return None;
    }
    if is_hidden_in(world, interior, surface) {
        return Some(Vec3::ONE);
    }
    let outside = interior.without(surface.material).solid();
    let matched = ior(world, surface.material) == ior(world, outside);
    let matched = matched && !world.disperses(outside);
    world.tint_of_clear_border(surface).filter(|_| matched)
}

fn ior(world: &World, id: MaterialId) -> f32 {
    world.ior(id, None)
}

/// The solids beyond a surface that light goes straight through.
pub fn beyond_passable(world: &World, interior: Interior, surface: &Surface) -> Interior {
    let crossing = if surface.front { Crossing::Enters } else { Crossing::Leaves };
    interior_beyond(world, interior, surface, crossing)
}
