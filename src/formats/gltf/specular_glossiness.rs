//! KHR_materials_pbrSpecularGlossiness: colours of scattering and reflection instead of metalness.
//!
//! Archived, but in many files. It is the dielectric of an infinite index whose reflection has the
//! colour that is told, as KHR_materials_ior and KHR_materials_specular have it for that purpose;
//! the share of light that is not reflected scatters below.

use super::json::{Fault, Object};
use super::material::Reader;
use crate::math::{Vec3, Vec4};
use crate::scene::Material;
use crate::texture::ColorSpace;

impl Reader<'_, '_> {
    /// Puts what the extension says in the place of the metallic-roughness values, and of what
    /// other extensions say of its reflection.
    pub(super) fn specular_glossiness(
        &mut self,
        extension: &Object,
        material: &mut Material,
    ) -> Result<(), Fault> {
        let diffuse = extension.numbers::<4>("diffuseFactor")?.unwrap_or([1.0; 4]);
        let diffuse = Vec4::from_array(diffuse.map(|x| x as f32));
        self.check_unit(extension, "diffuseFactor", &diffuse.to_array());
        material.base_color = diffuse.clamp(Vec4::ZERO, Vec4::ONE);
        material.base_color_texture = self.member(extension, "diffuseTexture", ColorSpace::Srgb)?;
        let specular = extension.numbers::<3>("specularFactor")?.unwrap_or([1.0; 3]);
        let specular = Vec3::from_array(specular.map(|x| x as f32));
        self.check_unit(extension, "specularFactor", &specular.to_array());
        material.specular_color = specular.clamp(Vec3::ZERO, Vec3::ONE);
        // Colour and, in its alpha, glossiness; alpha is linear in both colour spaces.
        let texture = self.member(extension, "specularGlossinessTexture", ColorSpace::Srgb)?;
        material.specular_color_texture = texture;
        material.glossiness_texture = texture;
        material.roughness = 1.0 - self.share(extension, "glossinessFactor", 1.0)?;
        for other in ["KHR_materials_ior", "KHR_materials_specular"] {
            if let Some(other) = self.object.extension(other)? {
                let message = "is left out beside KHR_materials_pbrSpecularGlossiness";
                self.notices.add(other.place(), message);
            }
        }
        (material.specular, material.specular_texture) = (1.0, None);
        material.metallic = 0.0;
        material.metallic_roughness_texture = None;
        material.ior = 0.0;
        Ok(())
    }
}
