//! Materials as files describe them: factors and textures.

use super::{MaterialLayers, Scattering, TextureRef, Volume};
use crate::math::{Vec3, Vec4};
use crate::texture::TextureRange;

/// What happens where a surface is not wholly opaque (glTF 2.0, 3.9.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    Opaque,
    /// There where alpha is at least the cutoff, else a hole.
    Mask(f32),
    /// There with probability alpha.
    Blend,
}

/// glTF's metallic-roughness material with the extensions that are honoured. Fields are named as
/// the specification names them; a factor multiplies its texture.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What the file calls it; for messages.
    pub name: String,
    /// Linear colour and alpha.
    pub base_color: Vec4,
    /// sRGB colour and linear alpha.
    pub base_color_texture: Option<TextureRef>,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// The root of the microfacet distribution's alpha.
    pub roughness: f32,
    /// Roughness in G, metalness in B.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// In its alpha channel; one minus roughness is multiplied with it
    /// (KHR_materials_pbrSpecularGlossiness).
    pub glossiness_texture: Option<TextureRef>,
    /// Tangent-space normals.
    pub normal_texture: Option<TextureRef>,
    /// Multiplies x and y of the normal texture.
    pub normal_scale: f32,
    /// A scalar height map instead (OBJ's bump maps), in units of `normal_scale`.
    pub bump_texture: Option<TextureRef>,
    /// Emitted radiance, the strength of KHR_materials_emissive_strength included.
    pub emissive: Vec3,
    /// sRGB colour.
    pub emissive_texture: Option<TextureRef>,
    /// What alpha does.
    pub alpha_mode: AlphaMode,
    /// A separate texture for alpha (OBJ's `map_d`), in its red channel.
    pub alpha_texture: Option<TextureRef>,
    /// Whether it emits from its back too.
    pub double_sided: bool,
    /// Index of refraction, at least 1; 0 stands for infinity.
    pub ior: f32,
    /// Strength of the dielectric's reflection.
    pub specular: f32,
    /// In its alpha channel.
    pub specular_texture: Option<TextureRef>,
    /// Tint of the dielectric's reflection at normal incidence.
    pub specular_color: Vec3,
    /// sRGB colour.
    pub specular_color_texture: Option<TextureRef>,
    /// Share of the light that is not reflected that goes through instead of scattering below.
    pub transmission: f32,
    /// In its red channel.
    pub transmission_texture: Option<TextureRef>,
    /// Share of the light that the diffuse base does not send back but lets through, scattered
    /// (KHR_materials_diffuse_transmission).
    pub diffuse_transmission: f32,
    /// In its alpha channel.
    pub diffuse_transmission_texture: Option<TextureRef>,
    /// Linear colour of what the diffuse base lets through.
    pub diffuse_transmission_color: Vec3,
    /// sRGB colour.
    pub diffuse_transmission_color_texture: Option<TextureRef>,
    /// Whether it shows its base colour alone, whatever falls on it (KHR_materials_unlit). The rest
    /// is then as in [`Material::default`], but for alpha.
    pub unlit: bool,
    /// What lies on it; `None`: nothing.
    pub layers: Option<Box<MaterialLayers>>,
    /// Present: the surface bounds a solid; absent: it is infinitely thin.
    pub volume: Option<Volume>,
    /// How the inside of a solid scatters light; `None`: it only absorbs. Without a volume there is
    /// no inside.
    pub scattering: Option<Scattering>,
    /// How much more a solid bends blue light than red: 20 over its Abbe number; 0: all alike.
    pub dispersion: f32,
    /// Where solids overlap, the one of the highest priority is there; of equals, the inner one.
    pub priority: i32,
}

impl Default for Material {
    /// glTF's default material: white, rough metal.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            glossiness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            bump_texture: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            alpha_mode: AlphaMode::Opaque,
            alpha_texture: None,
            double_sided: false,
            ior: 1.5,
            specular: 1.0,
            specular_texture: None,
            specular_color: Vec3::ONE,
            specular_color_texture: None,
            transmission: 0.0,
            transmission_texture: None,
            diffuse_transmission: 0.0,
            diffuse_transmission_texture: None,
            diffuse_transmission_color: Vec3::ONE,
            diffuse_transmission_color_texture: None,
            unlit: false,
            layers: None,
            volume: None,
            scattering: None,
            dispersion: 0.0,
            priority: 0,
        }
    }
}

/// Reflectance of what has no material: that of a new material in Blender.
pub const DEFAULT_GREY: f32 = 0.8;

impl Material {
    /// What a thing has that has no material: a Lambertian grey.
    pub fn grey() -> Self {
        Self {
            name: "(none)".to_owned(),
            base_color: Vec4::new(DEFAULT_GREY, DEFAULT_GREY, DEFAULT_GREY, 1.0),
            metallic: 0.0,
            specular: 0.0,
            ..Self::default()
        }
    }

    /// What is left of it when it is not lit: colour, alpha and sides.
    pub fn into_unlit(self) -> Self {
        let Self { name, base_color, base_color_texture, .. } = self;
        let Self { alpha_mode, alpha_texture, double_sided, .. } = self;
        let rest = Self::default();
        Self {
            name,
            base_color,
            base_color_texture,
            alpha_mode,
            alpha_texture,
            double_sided,
            unlit: true,
            ..rest
        }
    }

    /// All textures that it uses.
    pub fn textures_mut(&mut self) -> impl Iterator<Item = &mut TextureRef> {
        self.texture_slots_mut().flatten()
    }

    /// All places for textures, used or not.
    pub fn texture_slots_mut(&mut self) -> impl Iterator<Item = &mut Option<TextureRef>> {
        self.ranged_slots_mut().map(|(slot, _)| slot)
    }

    /// The same with what a texture's values may be there.
    pub fn ranged_slots_mut(
        &mut self,
    ) -> impl Iterator<Item = (&mut Option<TextureRef>, TextureRange)> {
        let base = if self.unlit { TextureRange::Light } else { TextureRange::Unit };
        [
            (&mut self.base_color_texture, base),
            (&mut self.metallic_roughness_texture, TextureRange::Unit),
            (&mut self.glossiness_texture, TextureRange::Unit),
            (&mut self.normal_texture, TextureRange::Any),
            (&mut self.bump_texture, TextureRange::Any),
            (&mut self.emissive_texture, TextureRange::Light),
            (&mut self.alpha_texture, TextureRange::Unit),
            (&mut self.specular_texture, TextureRange::Unit),
            (&mut self.specular_color_texture, TextureRange::Unit),
            (&mut self.transmission_texture, TextureRange::Unit),
            (&mut self.diffuse_transmission_texture, TextureRange::Unit),
            (&mut self.diffuse_transmission_color_texture, TextureRange::Unit),
        ]
        .into_iter()
        .chain(self.scattering.iter_mut().map(Scattering::ranged_slot_mut))
        .chain(self.layers.iter_mut().flat_map(|layers| layers.ranged_slots_mut()))
    }

    /// The texture whose coordinates tell the tangents of a mesh that brings none.
    pub fn tangent_texture(&self) -> Option<TextureRef> {
        let of_layers = || self.layers.as_ref()?.tangent_texture();
        self.normal_texture.or_else(of_layers)
    }

    /// Whether any light may pass it, straight or scattered.
    pub fn transmits(&self) -> bool {
        self.transmission > 0.0 || self.diffuse_transmission > 0.0
    }

    /// Whether it bounds solids that light goes through.
    pub fn is_solid(&self) -> bool {
        self.volume.is_some() && self.transmits()
    }

    /// Whether any point of it may emit.
    pub fn is_emissive(&self) -> bool {
        self.emissive.max_element() > 0.0
    }

    /// Whether every hit counts, so that the alpha filter need not look.
    pub fn is_opaque(&self) -> bool {
        match self.alpha_mode {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => {
                self.base_color_texture.is_none()
                    && self.alpha_texture.is_none()
                    && self.base_color.w >= cutoff
            }
            AlphaMode::Blend => {
                self.base_color_texture.is_none()
                    && self.alpha_texture.is_none()
                    && self.base_color.w >= 1.0
            }
        }
    }
}
