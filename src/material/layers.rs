//! The parameters of what may lie on a surface, or stretch its reflection.

use crate::math::{Vec2, Vec3};

/// The parameters of KHR_materials_clearcoat, sheen, iridescence and anisotropy at a point, named
/// as in the specifications. All texture look-ups are done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    /// Strength of a coat of lacquer, 0 to 1; clamped to that range.
    pub clearcoat: f32,
    /// Its perceptual roughness, 0 to 1; clamped to that range.
    pub clearcoat_roughness: f32,
    /// Its unit normal, in the local frame of the surface below.
    pub clearcoat_normal: Vec3,
    /// Colour of the fibres that stand off cloth, 0 to 1; clamped to that range.
    pub sheen_color: Vec3,
    /// How far the fibres lean, 0 to 1; clamped to that range.
    pub sheen_roughness: f32,
    /// How far the reflection is stretched, 0 to 1; clamped to that range.
    pub anisotropy: f32,
    /// The direction of the stretch, a unit vector of the local frame's tangent plane.
    pub anisotropy_direction: Vec2,
    /// Strength of a thin film on the base, 0 to 1; clamped to that range.
    pub iridescence: f32,
    /// Its index of refraction, at least 1.
    pub iridescence_ior: f32,
    /// Thickness of the film, nanometres.
    pub iridescence_thickness: f32,
}

impl Layers {
    /// No layer, and no stretch.
    pub const NONE: Self = Self {
        clearcoat: 0.0,
        clearcoat_roughness: 0.0,
        clearcoat_normal: Vec3::Z,
        sheen_color: Vec3::ZERO,
        sheen_roughness: 0.0,
        anisotropy: 0.0,
        anisotropy_direction: Vec2::X,
        iridescence: 0.0,
        iridescence_ior: 1.3,
        iridescence_thickness: 0.0,
    };
}
