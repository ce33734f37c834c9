//! Light that goes through scattered: KHR_materials_diffuse_transmission and
//! KHR_materials_volume_scatter.

use super::json::{Fault, Object};
use super::material::Reader;
use crate::math::Vec3;
use crate::scene::{Material, ScatterColor, Scattering};
use crate::texture::ColorSpace;

/// What drafts of KHR_materials_volume_scatter have called the albedo of all scatterings, the
/// newest first.
const SCATTER_COLORS: [&str; 3] = ["multiscatterColorFactor", "multiscatterColor", "scatterAlbedo"];

impl Reader<'_, '_> {
    /// Both of them, of a material whose other extensions have been read.
    pub(super) fn translucency(&mut self, material: &mut Material) -> Result<(), Fault> {
        let object = self.object;
        if let Some(extension) = object.extension("KHR_materials_diffuse_transmission")? {
            self.diffuse_transmission(&extension, material)?;
        }
        if let Some(extension) = object.extension("KHR_materials_volume_scatter")? {
            material.scattering = self.scattering(&extension)?;
            if material.scattering.is_some() && !material.is_solid() {
                let message = "nothing scatters in what has no volume, or lets no light in";
                self.notices.add(extension.place(), message);
            }
        }
        Ok(())
    }

    fn diffuse_transmission(
        &mut self,
        extension: &Object,
        material: &mut Material,
    ) -> Result<(), Fault> {
        material.diffuse_transmission = self.share(extension, "diffuseTransmissionFactor", 0.0)?;
        material.diffuse_transmission_texture =
            self.member(extension, "diffuseTransmissionTexture", ColorSpace::Linear)?;
        let key = "diffuseTransmissionColorFactor";
        if let Some(color) = extension.numbers::<3>(key)? {
            let color = self.color(extension, key, color);
            material.diffuse_transmission_color = color.min(Vec3::ONE);
        }
        material.diffuse_transmission_color_texture =
            self.member(extension, "diffuseTransmissionColorTexture", ColorSpace::Srgb)?;
        let stretched = |layers: &crate::scene::MaterialLayers| {
            layers.anisotropy > 0.0 || layers.iridescence > 0.0
        };
        if material.diffuse_transmission > 0.0 && material.layers.as_deref().is_some_and(stretched)
        {
            let message = "a brushed surface or a film lets nothing through scattered: left out";
            self.notices.add(extension.place(), message);
        }
        Ok(())
    }

    /// `None` where nothing scatters.
    fn scattering(&mut self, extension: &Object) -> Result<Option<Scattering>, Fault> {
        let mut color = Vec3::ZERO;
        for key in SCATTER_COLORS {
            if let Some(given) = extension.numbers::<3>(key)? {
                color = self.color(extension, key, given).min(Vec3::ONE);
                break;
            }
        }
        let key = "multiscatterColorTexture";
        let color_texture = self.member(extension, key, ColorSpace::Srgb)?;
        if color_texture.is_some() {
            let message = "a medium is even: the mean of the texture is used";
            self.notices.add(extension.at(key), message);
        }
        let mut anisotropy = extension.number("scatterAnisotropy")?.unwrap_or(0.0);
        if !(-1.0..=1.0).contains(&anisotropy) {
            let message = "is not within -1 to 1; the nearer of them is used";
            self.notices.add(extension.at("scatterAnisotropy"), message);
            anisotropy = anisotropy.clamp(-1.0, 1.0);
        }
        let color = ScatterColor::All(color);
        let scattering = Scattering { color, color_texture, anisotropy };
        Ok((color != Scattering::NONE.color).then_some(scattering))
    }
}

#[cfg(test)]
mod tests {
    use super::super::material_of::material;
    use super::*;

    const VOLUME: &str = r#""KHR_materials_volume": {"thicknessFactor": 1}"#;

    #[test]
    fn all_members_are_read() {
        let (mut made, notices) = material(&format!(
            r#"{{{VOLUME}, "KHR_materials_diffuse_transmission": {{
                "diffuseTransmissionFactor": 0.25, "diffuseTransmissionTexture": {{"index": 1}},
                "diffuseTransmissionColorFactor": [1, 0.5, 0],
                "diffuseTransmissionColorTexture": {{"index": 1}}}},
                "KHR_materials_volume_scatter": {{"multiscatterColor": [0.5, 0.25, 0.125],
                "scatterAnisotropy": -0.5}}}}"#
        ))
        .expect("valid");
        assert!(notices.is_empty(), "{notices:?}");
        assert_eq!(made.diffuse_transmission, 0.25);
        assert_eq!(made.diffuse_transmission_color, Vec3::new(1.0, 0.5, 0.0));
        // The texture is read in both colour spaces.
        let slots: Vec<u32> = made.textures_mut().map(|texture| texture.texture.0).collect();
        assert_eq!(slots, [0, 1]);
        let scattering = made.scattering.expect("it scatters");
        assert_eq!(scattering.color, ScatterColor::All(Vec3::new(0.5, 0.25, 0.125)));
        assert_eq!(scattering.anisotropy, -0.5);
    }

    #[test]
    fn what_does_nothing_is_told() {
        let scatter = r#""KHR_materials_volume_scatter": {"multiscatterColorFactor": [1, 1, 1]}"#;
        let (_, notices) = material(&format!("{{{scatter}}}")).expect("valid");
        assert_eq!(notices, ["nothing scatters in what has no volume, or lets no light in"]);
        let (made, notices) = material(&format!(
            r#"{{{VOLUME}, "KHR_materials_transmission": {{"transmissionFactor": 1}}, {scatter}}}"#
        ))
        .expect("valid");
        assert!(made.scattering.is_some() && notices.is_empty(), "{notices:?}");
        let (made, _) = material(r#"{"KHR_materials_volume_scatter": {}}"#).expect("valid");
        assert_eq!(made, Material::default());
    }

    #[test]
    fn values_out_of_range_are_told_and_what_cannot_be_is_refused() {
        let (made, notices) = material(&format!(
            r#"{{{VOLUME}, "KHR_materials_diffuse_transmission": {{"diffuseTransmissionFactor": 2,
                "diffuseTransmissionColorFactor": [2, -1, 0]}}, "KHR_materials_volume_scatter":
                {{"multiscatterColor": [3, 0, 0], "scatterAnisotropy": 7,
                "multiscatterColorTexture": {{"index": 0}}}}}}"#
        ))
        .expect("valid");
        assert_eq!(made.diffuse_transmission, 1.0);
        assert_eq!(made.diffuse_transmission_color, Vec3::X);
        let scattering = made.scattering.expect("it scatters");
        assert_eq!((scattering.color, scattering.anisotropy), (ScatterColor::All(Vec3::X), 1.0));
        assert_eq!(notices.len(), 5, "{notices:?}");
        for wrong in [
            r#"{"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": "much"}}"#,
            r#"{"KHR_materials_diffuse_transmission":
                {"diffuseTransmissionTexture": {"index": 9}}}"#,
            r#"{"KHR_materials_volume_scatter": {"multiscatterColor": [1, 1]}}"#,
            r#"{"KHR_materials_volume_scatter": {"scatterAnisotropy": 1e99}}"#,
        ] {
            assert!(material(wrong).is_err(), "{wrong}");
        }
    }
}
