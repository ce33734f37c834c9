//! What lies on a material, or stretches its reflection, as files describe it.

use super::TextureRef;
use crate::math::{Vec2, Vec3};
use crate::texture::TextureRange;

/// KHR_materials_clearcoat, sheen, anisotropy and iridescence. Fields are named as the
/// specifications name them; a factor multiplies its texture.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialLayers {
    /// Strength of a coat of lacquer.
    pub clearcoat: f32,
    /// In its red channel.
    pub clearcoat_texture: Option<TextureRef>,
    /// The coat's roughness.
    pub clearcoat_roughness: f32,
    /// In its green channel.
    pub clearcoat_roughness_texture: Option<TextureRef>,
    /// Tangent-space normals of the coat, which does not follow those of the base.
    pub clearcoat_normal_texture: Option<TextureRef>,
    /// Multiplies x and y of the coat's normal texture.
    pub clearcoat_normal_scale: f32,
    /// Colour of cloth's fibres.
    pub sheen_color: Vec3,
    /// sRGB colour.
    pub sheen_color_texture: Option<TextureRef>,
    /// Roughness of the fibres.
    pub sheen_roughness: f32,
    /// In its alpha channel.
    pub sheen_roughness_texture: Option<TextureRef>,
    /// How far the reflection is stretched.
    pub anisotropy: f32,
    /// Cosine and sine of the angle from the tangent, counter-clockwise, along which it is.
    pub anisotropy_rotation: Vec2,
    /// The way in red and green, the strength in blue.
    pub anisotropy_texture: Option<TextureRef>,
    /// Strength of a thin film.
    pub iridescence: f32,
    /// In its red channel.
    pub iridescence_texture: Option<TextureRef>,
    /// The film's index of refraction.
    pub iridescence_ior: f32,
    /// The film's least and greatest thickness, nanometres; without a texture it has the greatest.
    pub iridescence_thickness: [f32; 2],
    /// From the least to the greatest thickness, in its green channel.
    pub iridescence_thickness_texture: Option<TextureRef>,
}

impl Default for MaterialLayers {
    /// Nothing.
    fn default() -> Self {
        Self {
            clearcoat: 0.0,
            clearcoat_texture: None,
            clearcoat_roughness: 0.0,
            clearcoat_roughness_texture: None,
            clearcoat_normal_texture: None,
            clearcoat_normal_scale: 1.0,
            sheen_color: Vec3::ZERO,
            sheen_color_texture: None,
            sheen_roughness: 0.0,
            sheen_roughness_texture: None,
            anisotropy: 0.0,
            anisotropy_rotation: Vec2::X,
            anisotropy_texture: None,
            iridescence: 0.0,
            iridescence_texture: None,
            iridescence_ior: 1.3,
            iridescence_thickness: [100.0, 400.0],
            iridescence_thickness_texture: None,
        }
    }
}

impl MaterialLayers {
    /// Whether any of them can be seen.
    pub fn any(&self) -> bool {
        // All fields are named, so that the compiler asks here about a new one.
        let &Self {
            clearcoat,
            clearcoat_texture: _,
            clearcoat_roughness: _,
            clearcoat_roughness_texture: _,
            clearcoat_normal_texture: _,
            clearcoat_normal_scale: _,
            sheen_color,
            sheen_color_texture: _,
            sheen_roughness: _,
            sheen_roughness_texture: _,
            anisotropy,
            anisotropy_rotation: _,
            anisotropy_texture: _,
            iridescence,
            iridescence_texture: _,
            iridescence_ior: _,
            iridescence_thickness: _,
            iridescence_thickness_texture: _,
        } = self;
        let strengths = [clearcoat, anisotropy, iridescence];
        strengths.iter().any(|&strength| strength > 0.0) || sheen_color != Vec3::ZERO
    }

    /// All places for textures, used or not, and what a texture's values may be there.
    pub fn ranged_slots_mut(
        &mut self,
    ) -> impl Iterator<Item = (&mut Option<TextureRef>, TextureRange)> {
        [
            (&mut self.clearcoat_texture, TextureRange::Unit),
            (&mut self.clearcoat_roughness_texture, TextureRange::Unit),
            (&mut self.clearcoat_normal_texture, TextureRange::Any),
            (&mut self.sheen_color_texture, TextureRange::Unit),
            (&mut self.sheen_roughness_texture, TextureRange::Unit),
            (&mut self.anisotropy_texture, TextureRange::Unit),
            (&mut self.iridescence_texture, TextureRange::Unit),
            (&mut self.iridescence_thickness_texture, TextureRange::Unit),
        ]
        .into_iter()
    }

    /// The texture whose coordinates tell the tangent, where the base has no normal map.
    pub fn tangent_texture(&self) -> Option<TextureRef> {
        self.clearcoat_normal_texture.or(self.anisotropy_texture)
    }
}
