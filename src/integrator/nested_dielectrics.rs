//! What a path meets at the borders of solids: absorption along the way, borders that another solid
//! hides, and the relative index of refraction.

use super::borders::{interior_beyond, is_hidden_in};
use super::crossing::Crossing;
use super::dimensions::choice_dimension;
use super::state::Path;
use crate::accel::ClosestHit;
use crate::material::{Bsdf, Wavelength};
use crate::world::{Surface, World};

/// Takes away what the inside of a solid absorbs along a segment. A path that meets the back of a
/// solid which it never entered has started inside.
#[inline]
pub fn absorb(world: &World, path: &mut Path, surface: &Surface, distance: f32) {
    let leaves = !surface.front && world.is_solid(surface.material);
    if path.interior.is_air() {
        if !leaves {
            return;
        }
        path.interior = path.interior.behind(surface.material, world);
    }
    path.throughput *= world.transmittance(path.interior.solid(), distance);
    if leaves {
        path.interior = path.interior.behind(surface.material, world);
    }
}

/// Whether a surface does nothing where the path meets it: the border of a solid within another one
/// of higher priority.
#[inline]
pub fn is_hidden(world: &World, path: &Path, surface: &Surface) -> bool {
    is_hidden_in(world, path.interior, surface)
}

/// Takes a path straight through a surface that does nothing.
#[inline(never)]
pub fn pass_hidden(world: &World, path: &mut Path, surface: &Surface) {
    let crossing = if surface.front { Crossing::Enters } else { Crossing::Leaves };
    path.interior = interior_beyond(world, path.interior, surface, crossing);
    // No light was sampled through it.
    path.pdf = f32::INFINITY;
}

/// The BSDF of a surface for the light that the path follows, between the solids that meet there.
#[inline(always)]
pub fn bsdf_for_path(
    world: &World,
    depth: u32,
    path: &mut Path,
    surface: &Surface,
    hit: &ClosestHit,
) -> Bsdf {
    let inside = surface.material;
    if !world.is_solid(inside) || (path.interior.is_air() && !world.disperses(inside)) {
        return world.bsdf(surface, hit);
    }
    bsdf_of_border(world, depth, path, surface, hit)
}

#[inline(never)]
fn bsdf_of_border(
    world: &World,
    depth: u32,
    path: &mut Path,
    surface: &Surface,
    hit: &ClosestHit,
) -> Bsdf {
    let inside = surface.material;
    let outside = path.interior.without(inside).solid();
    let disperses = world.disperses(inside) || world.disperses(outside);
    if path.wavelength.is_none() && disperses {
        let u = path.stream.at(choice_dimension(depth) + 3).next_1d();
        let (wavelength, weights) = Wavelength::sample(u);
        path.wavelength = Some(wavelength);
        path.throughput *= weights;
    }
    let ior = |id| world.ior(id, path.wavelength);
    world.bsdf_of_index(surface, hit, ior(inside) / ior(outside))
}
