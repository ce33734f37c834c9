//! Through a surface or back from it: by its geometry, to which shading normals may not agree.

use crate::math::Vec3;
use crate::world::Surface;

/// On which side of its surface scattered light goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passes {
    /// On the side that the viewer is on.
    Reflected,
    /// From the front to the back.
    Into,
    /// From the back to the front.
    OutOf,
}

/// On which side a direction goes on; `None` where shading and geometric normal do not agree about
/// whether it stays on the viewer's side. About the viewer's own side they need not: where a
/// smooth normal turns away from him at a silhouette, the surface scatters from its other side.
#[inline(always)]
pub fn passes(surface: &Surface, direction: Vec3, wo: Vec3, wi: Vec3) -> Option<Passes> {
    let above = surface.normal.dot(direction);
    let stays = (above > 0.0) == surface.front;
    let seems_to_stay = (wi.z > 0.0) == (wo.z > 0.0);
    if above == 0.0 || stays != seems_to_stay {
        return None;
    }
    Some(match (surface.front, above > 0.0) {
        (true, true) | (false, false) => Passes::Reflected,
        (true, false) => Passes::Into,
        (false, true) => Passes::OutOf,
    })
}
