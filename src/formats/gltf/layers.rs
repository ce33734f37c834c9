//! What lies on materials: KHR_materials_clearcoat, sheen, anisotropy and iridescence.

use super::json::{Fault, Object};
use super::material::Reader;
use crate::math::{Vec2, Vec3};
use crate::scene::MaterialLayers;
use crate::texture::ColorSpace;

impl Reader<'_, '_> {
    /// The layers of a material that transmits that much.
    pub(super) fn layers(
        &mut self,
        transmission: f32,
    ) -> Result<Option<Box<MaterialLayers>>, Fault> {
        let object = self.object;
        let mut layers = MaterialLayers::default();
        if let Some(coat) = object.extension("KHR_materials_clearcoat")? {
            self.clearcoat(&coat, &mut layers)?;
        }
        if let Some(sheen) = object.extension("KHR_materials_sheen")? {
            self.sheen(&sheen, &mut layers)?;
        }
        if let Some(anisotropy) = object.extension("KHR_materials_anisotropy")? {
            self.anisotropy(&anisotropy, &mut layers)?;
            if transmission > 0.0 && layers.anisotropy > 0.0 {
                let message = "what transmits light is not stretched: left out there";
                self.notices.add(anisotropy.place(), message);
            }
        }
        if let Some(film) = object.extension("KHR_materials_iridescence")? {
            self.iridescence(&film, &mut layers)?;
        }
        Ok(layers.any().then(|| Box::new(layers)))
    }

    fn clearcoat(&mut self, coat: &Object, layers: &mut MaterialLayers) -> Result<(), Fault> {
        layers.clearcoat = self.share(coat, "clearcoatFactor", 0.0)?;
        layers.clearcoat_texture = self.member(coat, "clearcoatTexture", ColorSpace::Linear)?;
        layers.clearcoat_roughness = self.share(coat, "clearcoatRoughnessFactor", 0.0)?;
        layers.clearcoat_roughness_texture =
            self.member(coat, "clearcoatRoughnessTexture", ColorSpace::Linear)?;
        if let Some(texture) = coat.object("clearcoatNormalTexture")? {
            layers.clearcoat_normal_texture = Some(self.texture(&texture, ColorSpace::Linear)?);
            layers.clearcoat_normal_scale = texture.number("scale")?.unwrap_or(1.0);
        }
        Ok(())
    }

    fn sheen(&mut self, sheen: &Object, layers: &mut MaterialLayers) -> Result<(), Fault> {
        if let Some(color) = sheen.numbers::<3>("sheenColorFactor")? {
            let color = self.color(sheen, "sheenColorFactor", color);
            layers.sheen_color = color.min(Vec3::ONE);
        }
        layers.sheen_color_texture = self.member(sheen, "sheenColorTexture", ColorSpace::Srgb)?;
        layers.sheen_roughness = self.share(sheen, "sheenRoughnessFactor", 0.0)?;
        layers.sheen_roughness_texture =
            self.member(sheen, "sheenRoughnessTexture", ColorSpace::Linear)?;
        Ok(())
    }

    fn iridescence(&mut self, film: &Object, layers: &mut MaterialLayers) -> Result<(), Fault> {
        layers.iridescence = self.share(film, "iridescenceFactor", 0.0)?;
        layers.iridescence_texture = self.member(film, "iridescenceTexture", ColorSpace::Linear)?;
        layers.iridescence_ior = film.number("iridescenceIor")?.unwrap_or(1.3);
        if layers.iridescence_ior < 1.0 {
            self.notices.add(film.at("iridescenceIor"), "is below 1; 1 is used");
            layers.iridescence_ior = 1.0;
        }
        let keys = ["iridescenceThicknessMinimum", "iridescenceThicknessMaximum"];
        for (key, thickness) in keys.into_iter().zip(&mut layers.iridescence_thickness) {
            *thickness = film.number(key)?.unwrap_or(*thickness);
            if *thickness < 0.0 {
                self.notices.add(film.at(key), "is negative; 0 is used");
                *thickness = 0.0;
            }
        }
        layers.iridescence_thickness_texture =
            self.member(film, "iridescenceThicknessTexture", ColorSpace::Linear)?;
        Ok(())
    }

    fn anisotropy(&mut self, object: &Object, layers: &mut MaterialLayers) -> Result<(), Fault> {
        layers.anisotropy = self.share(object, "anisotropyStrength", 0.0)?;
        let angle = object.number("anisotropyRotation")?.unwrap_or(0.0);
        layers.anisotropy_rotation = Vec2::new(libm::cosf(angle), libm::sinf(angle));
        layers.anisotropy_texture = self.member(object, "anisotropyTexture", ColorSpace::Linear)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::material_of::material;
    use super::*;
    use crate::scene::Material;

    #[test]
    fn all_members_are_read() {
        let (mut material, notices) = material(
            r#"{"KHR_materials_clearcoat": {"clearcoatFactor": 0.5,
                "clearcoatTexture": {"index": 0},
                "clearcoatRoughnessFactor": 0.25, "clearcoatRoughnessTexture": {"index": 0},
                "clearcoatNormalTexture": {"index": 1, "scale": 2}},
                "KHR_materials_sheen": {"sheenColorFactor": [1, 0.5, 0],
                "sheenColorTexture": {"index": 2}, "sheenRoughnessFactor": 0.75,
                "sheenRoughnessTexture": {"index": 2}},
                "KHR_materials_anisotropy": {"anisotropyStrength": 0.6,
                "anisotropyRotation": 3.1415927, "anisotropyTexture": {"index": 3}},
                "KHR_materials_iridescence": {"iridescenceFactor": 0.75, "iridescenceIor": 1.5,
                "iridescenceTexture": {"index": 3}, "iridescenceThicknessMinimum": 200,
                "iridescenceThicknessMaximum": 700, "iridescenceThicknessTexture": {"index": 3}}}"#,
        )
        .expect("valid");
        assert!(notices.is_empty(), "{notices:?}");
        // The sheen's texture is read in both colour spaces.
        let slots: Vec<u32> = material.textures_mut().map(|texture| texture.texture.0).collect();
        assert_eq!(slots, [0, 0, 1, 2, 3, 4, 4, 4]);
        let layers = material.layers.expect("there are some");
        assert_eq!((layers.clearcoat, layers.clearcoat_roughness), (0.5, 0.25));
        assert_eq!(layers.clearcoat_normal_scale, 2.0);
        assert_eq!(layers.sheen_color, Vec3::new(1.0, 0.5, 0.0));
        assert_eq!((layers.sheen_roughness, layers.anisotropy), (0.75, 0.6));
        assert!(layers.anisotropy_rotation.distance(-Vec2::X) < 1e-6);
        assert_eq!((layers.iridescence, layers.iridescence_ior), (0.75, 1.5));
        assert_eq!(layers.iridescence_thickness, [200.0, 700.0]);
    }

    #[test]
    fn what_has_no_strength_is_not_there() {
        let (material, notices) = material(
            r#"{"KHR_materials_clearcoat": {"clearcoatRoughnessFactor": 0.5},
                "KHR_materials_sheen": {"sheenColorTexture": {"index": 1}},
                "KHR_materials_anisotropy": {}}"#,
        )
        .expect("valid");
        assert_eq!((material, notices.len()), (Material::default(), 0));
    }

    #[test]
    fn values_out_of_range_are_told() {
        let (material, notices) = material(
            r#"{"KHR_materials_clearcoat": {"clearcoatFactor": 2, "clearcoatRoughnessFactor": -1},
                "KHR_materials_sheen": {"sheenColorFactor": [3, -1, 0], "sheenRoughnessFactor": 7},
                "KHR_materials_anisotropy": {"anisotropyStrength": -0.1},
                "KHR_materials_iridescence": {"iridescenceFactor": 1.5, "iridescenceIor": 0.5,
                "iridescenceThicknessMaximum": -9}}"#,
        )
        .expect("valid");
        let layers = material.layers.expect("there are some");
        assert_eq!((layers.clearcoat, layers.clearcoat_roughness), (1.0, 0.0));
        assert_eq!((layers.sheen_color, layers.sheen_roughness), (Vec3::X, 1.0));
        // One for what is out of range, at five places, and one each for what is negative or below
        // 1.
        assert_eq!((layers.anisotropy, layers.iridescence_ior), (0.0, 1.0));
        assert_eq!((layers.iridescence, layers.iridescence_thickness), (1.0, [100.0, 0.0]));
        assert_eq!(notices.len(), 3, "{notices:?}");
    }

    #[test]
    fn what_cannot_be_is_refused() {
        for wrong in [
            r#"{"KHR_materials_clearcoat": {"clearcoatFactor": "much"}}"#,
            r#"{"KHR_materials_clearcoat": {"clearcoatTexture": {"index": 9}}}"#,
            r#"{"KHR_materials_sheen": {"sheenColorFactor": [1, 1]}}"#,
            r#"{"KHR_materials_anisotropy": {"anisotropyRotation": 1e99}}"#,
        ] {
            assert!(material(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn glass_is_not_stretched_and_says_so() {
        let (_, notices) = material(
            r#"{"KHR_materials_transmission": {"transmissionFactor": 1},
                "KHR_materials_anisotropy": {"anisotropyStrength": 0.5}}"#,
        )
        .expect("valid");
        assert_eq!(notices, ["what transmits light is not stretched: left out there"]);
    }
}
