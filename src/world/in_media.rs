//! What light meets on its way through media, and at their borders.

use super::World;
use super::lookup::base_color;
use super::surface::Surface;
use crate::math::{MaterialId, Vec3};
use crate::medium::Medium;

impl World {
    /// Whether any medium scatters light, or fills space.
    #[inline]
    pub fn has_media(&self) -> bool {
        self.media.any
    }

    /// Whether light sources may be seen through borders that do not bend light.
    #[inline]
    pub fn has_passable_borders(&self) -> bool {
        self.media.has_passable_borders
    }

    /// Whether paths in air that meet plain surfaces may be shaded many at once: no medium fills
    /// space, and no light is asked for through borders.
    #[inline]
    pub fn shades_in_lanes(&self) -> bool {
        !self.media.has_passable_borders && self.media.space.is_none()
    }

    /// The medium inside of a material's solids, if it scatters; that of space for
    /// [`MaterialId::NONE`], if there is one.
    #[inline]
    pub fn medium(&self, id: MaterialId) -> Option<&Medium> {
        if id == MaterialId::NONE {
            return self.media.space.as_ref();
        }
        self.media.solids[id.index()].as_ref()
    }

    /// What is left of white light after `distance` metres inside of a material, of what it
    /// scatters too; in space for [`MaterialId::NONE`].
    pub fn transmittance_in(&self, id: MaterialId, distance: f32) -> Vec3 {
        match self.medium(id) {
            Some(medium) => medium.transmittance(distance),
            None => self.transmittance(id, distance),
        }
    }

    /// What the border of a solid leaves of light that passes from one side to the other where the
    /// index of refraction is the same on both; `None`: it mirrors or scatters nevertheless.
    pub fn tint_of_clear_border(&self, surface: &Surface) -> Option<Vec3> {
        if !self.media.clear[surface.material.index()] {
            return None;
        }
        let material = self.material(surface.material);
        Some(base_color(&self.scene, material, &surface.attributes).truncate())
    }
}
