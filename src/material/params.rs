//! The parameters of a material at a point of a surface.

use crate::math::Vec3;

/// The parameters of glTF's metallic-roughness material and its extensions at a point, named as in
/// the specification. All texture look-ups are done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceParams {
    /// Linear colour, of what is below a dielectric or of a metal's reflection.
    pub base_color: Vec3,
    /// 0 (dielectric) to 1 (metal); clamped to that range.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1; clamped to that range.
    pub roughness: f32,
    /// Index of refraction of the inside over that of the outside; 0 stands for infinity
    /// (KHR_materials_ior).
    pub ior: f32,
    /// Strength of the dielectric's reflection, 0 to 1; clamped to that range.
    pub specular: f32,
    /// Tint of the dielectric's reflection at normal incidence.
    pub specular_color: Vec3,
    /// Share of the dielectric that is clear instead of opaque, 0 to 1; clamped to that range.
    pub transmission: f32,
    /// Share of the light below the dielectric's surface that goes through, scattered, instead of
    /// back, 0 to 1; clamped to that range.
    pub diffuse_transmission: f32,
    /// Linear colour of that light.
    pub diffuse_transmission_color: Vec3,
    /// Whether the surface is an infinitely thin sheet and not the boundary of a solid.
    pub thin: bool,
}

impl Default for SurfaceParams {
    /// A white, opaque, fully rough dielectric of index 1.5.
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            diffuse_transmission: 0.0,
            diffuse_transmission_color: Vec3::ONE,
            thin: false,
        }
    }
}

/// `x` clamped to `[0, 1]`; NaN becomes 0.
pub fn saturate(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}
