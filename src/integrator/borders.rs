//! What the borders of solids do to the list of solids around: which of them count, and what lies
//! beyond.

use super::crossing::Crossing;
use super::interior::Interior;
use crate::world::{Surface, World};

/// Whether a surface does nothing within the solids of an interior: the border of a solid within
/// another one of higher priority.
#[inline]
pub fn is_hidden_in(world: &World, interior: Interior, surface: &Surface) -> bool {
    !interior.is_air()
        && world.is_solid(surface.material)
        && interior.hides(surface.material, surface.front, world)
}

/// The solids that lie beyond a surface which light crosses or not.
#[inline]
pub fn interior_beyond(
    world: &World,
    interior: Interior,
    surface: &Surface,
    crossing: Crossing,
) -> Interior {
    let id = surface.material;
    if !world.is_solid(id) {
        return interior;
    }
    match crossing {
        Crossing::Reflected => interior,
        Crossing::Enters => interior.without(id).with(id, |id| world.priority(id)),
        Crossing::Leaves => interior.without(id),
    }
}
