//! Whether light crosses a surface: decided by its geometry, with which shading normals may
//! disagree.

use crate::math::Vec3;
use crate::world::Surface;

/// On which side of its surface scattered light goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// It stays on the viewer's side.
    Reflected,
    /// It goes from the front to the back.
    Enters,
    /// It goes from the back to the front.
    Leaves,
}

impl Crossing {
    /// That of light which stays on the viewer's side of a surface or does not.
    #[inline(always)]
    pub fn of(surface: &Surface, stays: bool) -> Self {
        match (stays, surface.front) {
            (true, _) => Self::Reflected,
            (false, true) => Self::Enters,
            (false, false) => Self::Leaves,
        }
    }
}

/// Tells on which side of a surface the world-space `direction` goes on; `wo` and `wi` are the
/// local directions of the viewer and of the scattered light.
///
/// Plainly taken, it is `None` where shading normal and geometric normal disagree about whether the
/// light stays on the viewer's side. They may disagree about which side the viewer is on: where a
/// smooth normal turns away from the viewer at a silhouette, the surface scatters from its other
/// side.
///
/// With `robust` shading normals the latter decide, see [`super::leaving`] for how the light goes
/// on.
#[inline(always)]
pub fn classify_crossing(
    surface: &Surface,
    direction: Vec3,
    wo: Vec3,
    wi: Vec3,
    robust: bool,
) -> Option<Crossing> {
    let seems_to_stay = (wi.z > 0.0) == (wo.z > 0.0);
    if robust {
        return Some(Crossing::of(surface, seems_to_stay));
    }
    let above = surface.normal.dot(direction);
    let stays = (above > 0.0) == surface.front;
    if above == 0.0 || stays != seems_to_stay {
        return None;
    }
    Some(match (surface.front, above > 0.0) {
        (true, true) | (false, false) => Crossing::Reflected,
        (true, false) => Crossing::Enters,
        (false, true) => Crossing::Leaves,
    })
}
