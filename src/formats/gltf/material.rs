//! Materials: metallic-roughness and the extensions that are honoured (glTF 2.0, 3.9).

use super::json::{Fault, Object};
use super::light;
use super::notices::Notices;
use super::texture::Slots;
use crate::math::{Vec2, Vec3, Vec4};
use crate::scene::{AlphaMode, Material, TextureRef, Volume};
use crate::texture::ColorSpace;

/// Reads all materials; their textures are noted in `slots`.
pub fn read(
    root: &Object,
    slots: &mut Slots,
    notices: &mut Notices,
) -> Result<Vec<Material>, Fault> {
    let materials = root.objects("materials")?;
    materials.iter().map(|object| Reader { object, slots, notices }.material()).collect()
}

pub(super) struct Reader<'a, 'b> {
    pub object: &'a Object<'a>,
    slots: &'b mut Slots,
    pub notices: &'b mut Notices,
}

impl Reader<'_, '_> {
    fn material(&mut self) -> Result<Material, Fault> {
        let object = self.object;
        let mut material = Material { name: object.name()?, ..Material::default() };
        self.alpha(&mut material)?;
        material.double_sided = object.flag("doubleSided")?;
        if let Some(pbr) = object.object("pbrMetallicRoughness")? {
            self.metallic_roughness(&pbr, &mut material)?;
        }
        if let Some(texture) = object.object("normalTexture")? {
            material.normal_texture = Some(self.texture(&texture, ColorSpace::Linear)?);
            material.normal_scale = texture.number("scale")?.unwrap_or(1.0);
        }
        if let Some(texture) = object.object("occlusionTexture")? {
            // Light that is traced finds its own way into corners; only the reference is checked.
            self.slots.check(&texture)?;
        }
        if let Some(factor) = object.numbers::<3>("emissiveFactor")? {
            material.emissive = self.color(object, "emissiveFactor", factor);
        }
        material.emissive_texture = self.member(object, "emissiveTexture", ColorSpace::Srgb)?;
        self.extensions(&mut material)?;
        if let Some(extension) = object.extension("KHR_materials_pbrSpecularGlossiness")? {
            self.specular_glossiness(&extension, &mut material)?;
        }
        if let Some(mark) = object.extension("KHR_materials_unlit")? {
            let others = object.object("extensions")?;
            if others.is_some_and(|all| all.members().any(|(name, _)| is_of_light(name))) {
                let message =
                    "an unlit material has a colour alone: its other extensions do nothing";
                self.notices.add(mark.place(), message);
            }
            return Ok(material.into_unlit());
        }
        Ok(material)
    }

    fn alpha(&mut self, material: &mut Material) -> Result<(), Fault> {
        let object = self.object;
        let cutoff = object.number("alphaCutoff")?.unwrap_or(0.5);
        material.alpha_mode = match object.text("alphaMode")? {
            None | Some("OPAQUE") => AlphaMode::Opaque,
            Some("MASK") => AlphaMode::Mask(cutoff),
            Some("BLEND") => AlphaMode::Blend,
            Some(other) => {
                let message = format!("{other:?} is none of OPAQUE, MASK and BLEND");
                return Err(object.fault_at("alphaMode", message));
            }
        };
        Ok(())
    }

    fn metallic_roughness(&mut self, pbr: &Object, material: &mut Material) -> Result<(), Fault> {
        if let Some(factor) = pbr.numbers::<4>("baseColorFactor")? {
            let factor = factor.map(|x| x as f32);
            self.check_unit(pbr, "baseColorFactor", &factor);
            material.base_color = Vec4::from_array(factor).clamp(Vec4::ZERO, Vec4::ONE);
        }
        material.base_color_texture = self.member(pbr, "baseColorTexture", ColorSpace::Srgb)?;
        material.metallic = self.share(pbr, "metallicFactor", 1.0)?;
        material.roughness = self.share(pbr, "roughnessFactor", 1.0)?;
        material.metallic_roughness_texture =
            self.member(pbr, "metallicRoughnessTexture", ColorSpace::Linear)?;
        Ok(())
    }

    fn extensions(&mut self, material: &mut Material) -> Result<(), Fault> {
        let object = self.object;
        if let Some(shining) = object.extension("KHR_materials_emissive_strength")? {
            let strength = shining.number("emissiveStrength")?.unwrap_or(1.0);
            if strength < 0.0 {
                self.notices.add(shining.at("emissiveStrength"), "is negative; 0 is used");
            }
            let emissive = material.emissive.as_dvec3() * f64::from(strength.max(0.0));
            material.emissive = light::strength(emissive, |message| {
                self.notices.add(shining.at("emissiveStrength"), message);
            });
        }
        if let Some(ior) = object.extension("KHR_materials_ior")? {
            material.ior = self.ior(&ior)?;
        }
        if let Some(specular) = object.extension("KHR_materials_specular")? {
            material.specular = self.share(&specular, "specularFactor", 1.0)?;
            material.specular_texture =
                self.member(&specular, "specularTexture", ColorSpace::Linear)?;
            if let Some(factor) = specular.numbers::<3>("specularColorFactor")? {
                let factor = Vec3::from_array(factor.map(|x| x as f32));
                if factor.min_element() < 0.0 {
                    self.notices.add(specular.at("specularColorFactor"), "is negative; 0 is used");
                }
                material.specular_color = factor.max(Vec3::ZERO);
            }
            material.specular_color_texture =
                self.member(&specular, "specularColorTexture", ColorSpace::Srgb)?;
        }
        if let Some(transmission) = object.extension("KHR_materials_transmission")? {
            material.transmission = self.share(&transmission, "transmissionFactor", 0.0)?;
            material.transmission_texture =
                self.member(&transmission, "transmissionTexture", ColorSpace::Linear)?;
        }
        if let Some(volume) = object.extension("KHR_materials_volume")? {
            material.volume = self.volume(&volume)?;
        }
        if let Some(dispersion) = object.extension("KHR_materials_dispersion")? {
            material.dispersion = dispersion.number("dispersion")?.unwrap_or(0.0);
            if material.dispersion < 0.0 {
                self.notices.add(dispersion.at("dispersion"), "is negative; 0 is used");
                material.dispersion = 0.0;
            } else if material.dispersion > 0.0 && material.volume.is_none() {
                let message = "a surface without a volume bends no light: nothing is dispersed";
                self.notices.add(dispersion.place(), message);
            }
        }
        material.priority = self.priority()?;
        material.layers = self.layers(material.transmission)?;
        self.translucency(material)?;
        Ok(())
    }

    /// What the format has no word for, among what it leaves to applications.
    fn priority(&self) -> Result<i32, Fault> {
        match self.object.value("extras") {
            Some(extras) if extras.is_object() => {
                let extras = Object::new(extras, self.object.at("extras"))?;
                Ok(extras.number("dapple_priority")?.map_or(0, |priority| priority as i32))
            }
            _ => Ok(0),
        }
    }

    /// At least 1, as all that is known has, or 0, which stands for infinity.
    fn ior(&mut self, extension: &Object) -> Result<f32, Fault> {
        let ior = extension.number("ior")?.unwrap_or(1.5);
        if ior >= 1.0 || ior == 0.0 {
            return Ok(ior);
        }
        self.notices.add(extension.at("ior"), "is below 1; 1 is used");
        Ok(1.0)
    }

    /// The inside, where the surface is not thin. How thick it is tells the mesh itself.
    fn volume(&mut self, extension: &Object) -> Result<Option<Volume>, Fault> {
        let thickness = extension.number("thicknessFactor")?.unwrap_or(0.0);
        let color = match extension.numbers::<3>("attenuationColor")? {
            Some(color) => self.color(extension, "attenuationColor", color).min(Vec3::ONE),
            None => Vec3::ONE,
        };
        let distance = extension.number("attenuationDistance")?.unwrap_or(f32::INFINITY);
        if distance <= 0.0 {
            return Err(extension.fault_at("attenuationDistance", "must be above 0"));
        }
        if let Some(texture) = extension.object("thicknessTexture")? {
            self.slots.check(&texture)?;
        }
        Ok((thickness > 0.0)
            .then_some(Volume { attenuation_color: color, attenuation_distance: distance }))
    }

    /// A factor from 0 to 1.
    pub(super) fn share(&mut self, object: &Object, key: &str, default: f32) -> Result<f32, Fault> {
        let value = object.number(key)?.unwrap_or(default);
        self.check_unit(object, key, &[value]);
        Ok(value.clamp(0.0, 1.0))
    }

    pub(super) fn check_unit(&mut self, object: &Object, key: &str, values: &[f32]) {
        if values.iter().any(|value| !(0.0..=1.0).contains(value)) {
            self.notices.add(object.at(key), "is not within 0 to 1; the nearer of them is used");
        }
    }

    /// A colour that may be brighter than the format allows: files of other programs' making use
    /// this for emission, and what they mean is plain.
    pub(super) fn color(&mut self, object: &Object, key: &str, color: [f64; 3]) -> Vec3 {
        let color = Vec3::from_array(color.map(|x| x as f32));
        if color.min_element() < 0.0 {
            self.notices.add(object.at(key), "is negative; 0 is used");
        } else if color.max_element() > 1.0 {
            self.notices.add(object.at(key), "is above 1, which the format does not allow");
        }
        color.max(Vec3::ZERO)
    }

    pub(super) fn member(
        &mut self,
        object: &Object,
        key: &str,
        color_space: ColorSpace,
    ) -> Result<Option<TextureRef>, Fault> {
        match object.object(key)? {
            Some(texture) => Ok(Some(self.texture(&texture, color_space)?)),
            None => Ok(None),
        }
    }

    pub(super) fn texture(
        &mut self,
        info: &Object,
        color_space: ColorSpace,
    ) -> Result<TextureRef, Fault> {
        let mut reference = TextureRef::new(self.slots.slot(info, color_space)?);
        let mut set = info.whole("texCoord")?.unwrap_or(0);
        if let Some(transform) = info.extension("KHR_texture_transform")? {
            set = transform.whole("texCoord")?.unwrap_or(set);
            let vector = |key| {
                let numbers = transform.numbers::<2>(key)?;
                Ok::<_, Fault>(numbers.map(|v| Vec2::from_array(v.map(|x| x as f32))))
            };
            reference.offset = vector("offset")?.unwrap_or(Vec2::ZERO);
            reference.scale = vector("scale")?.unwrap_or(Vec2::ONE);
            let angle = transform.number("rotation")?.unwrap_or(0.0);
            reference.rotation = Vec2::new(libm::cosf(angle), libm::sinf(angle));
        }
        // Which of the mesh's sets is which of those that a mesh keeps is told by the palette.
        reference.uv_set = u32::try_from(set).map_err(|_| {
            info.fault_at("texCoord", format!("{set} is beyond all sets of coordinates (2^32 - 1)"))
        })?;
        Ok(reference)
    }
}

/// Whether an extension tells how a material answers to light.
fn is_of_light(name: &str) -> bool {
    let other = ["KHR_materials_unlit", "KHR_materials_variants"];
    name.starts_with("KHR_materials_") && !other.contains(&name)
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;
    use crate::math::TextureId;

    fn material(text: &str) -> Result<(Material, usize), Fault> {
        let value =
            json::parse(format!("{{\"materials\": [{text}]}}").as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        let (mut slots, mut notices) = (Slots::new(2), Notices::default());
        let material = read(&root, &mut slots, &mut notices)?.remove(0);
        Ok((material, notices.finish(std::path::Path::new("a")).len()))
    }

    #[test]
    fn absent_members_have_the_defaults_of_the_format() {
        let (material, notices) = material("{}").expect("valid");
        assert_eq!((material, notices), (Material::default(), 0));
    }

    #[test]
    fn the_same_texture_in_two_colour_spaces_is_two() {
        let (material, _) = material(
            r#"{"pbrMetallicRoughness": {"baseColorTexture": {"index": 1, "texCoord": 1},
                "metallicRoughnessTexture": {"index": 1}}, "emissiveTexture": {"index": 1}}"#,
        )
        .expect("valid");
        let base = material.base_color_texture.expect("has one");
        assert_eq!((base.texture, base.uv_set), (TextureId(0), 1));
        let id = |reference: Option<TextureRef>| reference.expect("has one").texture;
        assert_eq!(id(material.metallic_roughness_texture), TextureId(1));
        assert_eq!(id(material.emissive_texture), TextureId(0));
    }

    #[test]
    fn a_quarter_turn_looks_where_the_specification_says() {
        // The example of KHR_texture_transform: the lower left quadrant, turned.
        let (material, _) = material(
            r#"{"emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform":
                {"offset": [0, 1], "rotation": 1.57079632679, "scale": [0.5, 0.5]}}}}"#,
        )
        .expect("valid");
        let texture = material.emissive_texture.expect("has one");
        assert!(texture.transform(Vec2::ZERO).distance(Vec2::new(0.0, 1.0)) < 1e-6);
        assert!(texture.transform(Vec2::ONE).distance(Vec2::new(0.5, 0.5)) < 1e-6);
    }

    #[test]
    fn an_index_is_at_least_one_or_stands_for_infinity() {
        let ior = |ior: &str| {
            let extension = format!("\"KHR_materials_ior\": {{\"ior\": {ior}}}");
            material(&format!("{{\"extensions\": {{{extension}}}}}")).expect("valid")
        };
        for (text, expected, notices) in [("1.33", 1.33, 0), ("0", 0.0, 0), ("0.5", 1.0, 1)] {
            let (made, told) = ior(text);
            assert_eq!((made.ior, told), (expected, notices), "{text}");
        }
    }

    #[test]
    fn glossiness_is_what_roughness_lacks() {
        let (made, notices) = material(
            r#"{"pbrMetallicRoughness": {"metallicFactor": 1, "metallicRoughnessTexture":
                {"index": 0}}, "extensions": {"KHR_materials_pbrSpecularGlossiness":
                {"diffuseFactor": [0.5, 0.25, 1, 1], "specularFactor": [0.2, 0.1, 0],
                "glossinessFactor": 0.75, "specularGlossinessTexture": {"index": 1}}}}"#,
        )
        .expect("valid");
        assert_eq!((made.metallic, made.roughness, made.ior, notices), (0.0, 0.25, 0.0, 0));
        assert_eq!(made.specular_color, Vec3::new(0.2, 0.1, 0.0));
        assert_eq!(made.base_color, Vec4::new(0.5, 0.25, 1.0, 1.0));
        assert_eq!(made.glossiness_texture, made.specular_color_texture);
        assert!(made.glossiness_texture.is_some() && made.metallic_roughness_texture.is_none());
    }

    #[test]
    fn a_volume_needs_thickness() {
        let volume = |thickness: &str| {
            material(&format!(
                "{{\"extensions\": {{\"KHR_materials_volume\": {{\"attenuationDistance\": 2, \
                 \"thicknessFactor\": {thickness}}}}}}}"
            ))
            .expect("valid")
            .0
            .volume
        };
        assert_eq!(volume("0"), None);
        let expected = Volume { attenuation_color: Vec3::ONE, attenuation_distance: 2.0 };
        assert_eq!(volume("0.1"), Some(expected));
    }

    #[test]
    fn dispersion_and_priority_are_read() {
        let extension = |dispersion: &str, volume: &str| {
            material(&format!(
                "{{\"extras\": {{\"dapple_priority\": -3}}, \"extensions\": {{{volume}
                 \"KHR_materials_dispersion\": {{\"dispersion\": {dispersion}}}}}}}"
            ))
        };
        let volume = "\"KHR_materials_volume\": {\"thicknessFactor\": 1},";
        let (made, notices) = extension("0.4", volume).expect("valid");
        assert_eq!((made.dispersion, made.priority, notices), (0.4, -3, 0));
        assert_eq!(extension("0.4", "").expect("valid").1, 1);
        let (made, notices) = extension("-1", volume).expect("valid");
        assert_eq!((made.dispersion, notices), (0.0, 1));
        assert!(material(r#"{"extras": {"dapple_priority": "high"}}"#).is_err());
        assert_eq!(material(r#"{"extras": 7}"#).expect("valid").0, Material::default());
    }

    #[test]
    fn an_unlit_surface_has_its_colour_alone() {
        let (made, _) = material(
            r#"{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 0.3},
                "emissiveFactor": [1, 1, 1], "extensions": {"KHR_materials_unlit": {}}}"#,
        )
        .expect("valid");
        let base_color = Vec4::new(1.0, 0.5, 0.0, 1.0);
        assert_eq!(made, Material { base_color, unlit: true, ..Material::default() });
    }

    #[test]
    fn values_out_of_range_are_told() {
        let (made, notices) = material(
            r#"{"pbrMetallicRoughness": {"metallicFactor": 2, "roughnessFactor": -1},
                "emissiveFactor": [5, 0, 0]}"#,
        )
        .expect("valid");
        assert_eq!((made.metallic, made.roughness, made.emissive), (1.0, 0.0, Vec3::X * 5.0));
        assert_eq!(notices, 2);
        assert!(material(r#"{"alphaMode": "mask"}"#).is_err());
    }
}
