//! How the inside of a solid takes away light.

use crate::math::Vec3;

/// The inside of a closed solid (KHR_materials_volume).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume {
    /// What is left of white light after `attenuation_distance`.
    pub attenuation_color: Vec3,
    /// Metres; infinity: nothing is absorbed.
    pub attenuation_distance: f32,
}
