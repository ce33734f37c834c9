//! How light leaves a surface on the side that its scattering says, whatever its direction: what
//! shading normals that are robust need, see [`crate::world::ShadingNormals`].

use super::crossing::Crossing;
use crate::math::{Ray, Vec3};
use crate::world::{LightSample, Surface, World};

/// The ray on which light goes on in a unit `direction` beyond a surface.
#[inline(always)]
pub fn ray_on(world: &World, surface: &Surface, direction: Vec3, crossing: Crossing) -> Ray {
    let side = side_of(surface, crossing);
    if !world.has_robust_normals() || side.dot(direction) > 0.0 {
        return surface.ray_towards(direction);
    }
    let bulge = bulge_beyond(world, surface, crossing);
    Ray::new(surface.origin_beyond(side, bulge), direction, 0.0, f32::INFINITY)
}

/// The segment to a light that was sampled; `None` where the surface itself is in the way.
#[inline(always)]
pub fn segment_to(
    world: &World,
    surface: &Surface,
    light: &LightSample,
    crossing: Crossing,
) -> Option<Ray> {
    let side = side_of(surface, crossing);
    if !world.has_robust_normals() || side.dot(light.direction) > 0.0 {
        return Some(light.ray);
    }
    let bulge = bulge_beyond(world, surface, crossing);
    if bulge <= 0.0 {
        return None;
    }
    let origin = surface.origin_beyond(side, bulge);
    Some(match light.end {
        Some(end) => Ray::new(origin, end - origin, 0.0, 1.0),
        None => Ray::new(origin, light.direction, 0.0, f32::INFINITY),
    })
}

/// The geometric normal on the side where light goes on.
#[inline(always)]
fn side_of(surface: &Surface, crossing: Crossing) -> Vec3 {
    if crossing == Crossing::Reflected { surface.facing() } else { -surface.facing() }
}

/// How far before the surface light begins that leads into it: where the curved surface is that the
/// normals tell.
fn bulge_beyond(world: &World, surface: &Surface, crossing: Crossing) -> f32 {
    if crossing != Crossing::Reflected {
        return 0.0;
    }
    let at = (surface.instance, surface.triangle);
    world.bulge(at, surface.barycentrics, surface.time, surface.front)
}
