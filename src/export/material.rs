//! Materials.

use serde_json::{Map, Value, json};

use super::baked::{with_alpha, without_glossiness};
use super::image::Images;
use super::object::{named, next_power_of_two};
use crate::math::{Vec2, Vec3};
use crate::scene::{AlphaMode, Material, MaterialLayers, ScatterColor, Scattering, TextureRef};
use crate::texture::ColorSpace;

/// glTF's material. What it has no place for goes to `left_out`.
pub fn write_material(
    material: &Material,
    images: &mut Images<'_>,
    left_out: &mut Vec<String>,
) -> Value {
    let mut material = material.clone();
    let name = material.name.clone();
    let mut leave_out = |what: &str| left_out.push(format!("material {name:?}: {what}"));
    if material.alpha_texture.is_some() && !with_alpha(&mut material, images) {
        leave_out("a texture of alpha that does not fit its colours");
    }
    if material.glossiness_texture.is_some() && !without_glossiness(&mut material, images) {
        leave_out("a texture of glossiness");
    }
    if material.bump_texture.is_some() {
        leave_out("a map of heights");
    }
    if material.scattering.is_some_and(|it| matches!(it.color, ScatterColor::One(_))) {
        leave_out("scattering inside by the albedo of one scattering");
    }
    Writer { images, extensions: Map::new() }.write(&material)
}

struct Writer<'a, 'b> {
    images: &'a mut Images<'b>,
    extensions: Map<String, Value>,
}

impl Writer<'_, '_> {
    fn write(mut self, material: &Material) -> Value {
        let mut pbr = json!({
            "baseColorFactor": material.base_color.to_array(),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        });
        self.texture(&mut pbr, "baseColorTexture", material.base_color_texture, SRGB);
        let rough = material.metallic_roughness_texture;
        self.texture(&mut pbr, "metallicRoughnessTexture", rough, LINEAR);
        let mut object = named(&material.name, json!({ "pbrMetallicRoughness": pbr }));
        write_alpha(&mut object, material);
        if material.double_sided {
            object["doubleSided"] = true.into();
        }
        if material.priority != 0 {
            object["extras"] = json!({ "dapple_priority": material.priority });
        }
        if material.unlit {
            self.extensions.insert("KHR_materials_unlit".to_owned(), json!({}));
        } else {
            self.normals(&mut object, material);
            self.emission(&mut object, material);
            self.dielectric(material);
            self.translucency(material);
            if let Some(layers) = &material.layers {
                self.layers(layers);
            }
        }
        if !self.extensions.is_empty() {
            object["extensions"] = Value::Object(self.extensions);
        }
        object
    }

    fn normals(&mut self, object: &mut Value, material: &Material) {
        self.texture(object, "normalTexture", material.normal_texture, LINEAR);
        if material.normal_texture.is_some() && material.normal_scale != 1.0 {
            object["normalTexture"]["scale"] = json!(material.normal_scale);
        }
    }

    fn emission(&mut self, object: &mut Value, material: &Material) {
        if material.emissive == Vec3::ZERO {
            return;
        }
        let strength = next_power_of_two(material.emissive.max_element());
        object["emissiveFactor"] = json!((material.emissive / strength).to_array());
        self.texture(object, "emissiveTexture", material.emissive_texture, SRGB);
        if strength != 1.0 {
            let strength = json!({ "emissiveStrength": strength });
            self.extension("KHR_materials_emissive_strength", strength);
        }
    }

    /// How a dielectric reflects, and what goes through it.
    fn dielectric(&mut self, material: &Material) {
        let plain = Material::default();
        if material.ior != plain.ior {
            self.extension("KHR_materials_ior", json!({ "ior": material.ior }));
        }
        let textures = (material.specular_texture, material.specular_color_texture);
        if (material.specular, material.specular_color) != (1.0, Vec3::ONE)
            || textures != (None, None)
        {
            let mut specular = json!({
                "specularFactor": material.specular,
                "specularColorFactor": material.specular_color.to_array(),
            });
            self.texture(&mut specular, "specularTexture", textures.0, LINEAR);
            self.texture(&mut specular, "specularColorTexture", textures.1, SRGB);
            self.extension("KHR_materials_specular", specular);
        }
        if material.transmission > 0.0 {
            let mut object = json!({ "transmissionFactor": material.transmission });
            self.texture(&mut object, "transmissionTexture", material.transmission_texture, LINEAR);
            self.extension("KHR_materials_transmission", object);
        }
        if let Some(volume) = material.volume {
            let mut object = json!({
                "thicknessFactor": 1.0, "attenuationColor": volume.attenuation_color.to_array(),
            });
            if volume.attenuation_distance.is_finite() {
                object["attenuationDistance"] = json!(volume.attenuation_distance);
            }
            self.extension("KHR_materials_volume", object);
        }
        if material.dispersion != 0.0 {
            let dispersion = json!({ "dispersion": material.dispersion });
            self.extension("KHR_materials_dispersion", dispersion);
        }
    }

    /// What goes through scattered, and scatters inside.
    fn translucency(&mut self, material: &Material) {
        let tint = material.diffuse_transmission_color;
        if material.diffuse_transmission > 0.0 || tint != Vec3::ONE {
            let mut object = json!({
                "diffuseTransmissionFactor": material.diffuse_transmission,
                "diffuseTransmissionColorFactor": tint.to_array(),
            });
            let share = material.diffuse_transmission_texture;
            self.texture(&mut object, "diffuseTransmissionTexture", share, LINEAR);
            let color = material.diffuse_transmission_color_texture;
            self.texture(&mut object, "diffuseTransmissionColorTexture", color, SRGB);
            self.extension("KHR_materials_diffuse_transmission", object);
        }
        if let Some(Scattering { color: ScatterColor::All(color), color_texture, anisotropy }) =
            material.scattering
        {
            let mut object = json!({
                "multiscatterColorFactor": color.to_array(), "scatterAnisotropy": anisotropy,
            });
            self.texture(&mut object, "multiscatterColorTexture", color_texture, SRGB);
            self.extension("KHR_materials_volume_scatter", object);
        }
    }

    fn layers(&mut self, layers: &MaterialLayers) {
        if layers.clearcoat > 0.0 {
            let mut coat = json!({
                "clearcoatFactor": layers.clearcoat,
                "clearcoatRoughnessFactor": layers.clearcoat_roughness,
            });
            self.texture(&mut coat, "clearcoatTexture", layers.clearcoat_texture, LINEAR);
            let rough = layers.clearcoat_roughness_texture;
            self.texture(&mut coat, "clearcoatRoughnessTexture", rough, LINEAR);
            let normal = layers.clearcoat_normal_texture;
            self.texture(&mut coat, "clearcoatNormalTexture", normal, LINEAR);
            if normal.is_some() && layers.clearcoat_normal_scale != 1.0 {
                coat["clearcoatNormalTexture"]["scale"] = json!(layers.clearcoat_normal_scale);
            }
            self.extension("KHR_materials_clearcoat", coat);
        }
        if layers.sheen_color != Vec3::ZERO {
            let mut sheen = json!({
                "sheenColorFactor": layers.sheen_color.to_array(),
                "sheenRoughnessFactor": layers.sheen_roughness,
            });
            self.texture(&mut sheen, "sheenColorTexture", layers.sheen_color_texture, SRGB);
            let rough = layers.sheen_roughness_texture;
            self.texture(&mut sheen, "sheenRoughnessTexture", rough, LINEAR);
            self.extension("KHR_materials_sheen", sheen);
        }
        if layers.anisotropy > 0.0 {
            let mut object = json!({ "anisotropyStrength": layers.anisotropy });
            if let Some(angle) = angle(layers.anisotropy_rotation) {
                object["anisotropyRotation"] = angle;
            }
            self.texture(&mut object, "anisotropyTexture", layers.anisotropy_texture, LINEAR);
            self.extension("KHR_materials_anisotropy", object);
        }
        if layers.iridescence > 0.0 {
            let [least, most] = layers.iridescence_thickness;
            let mut film = json!({
                "iridescenceFactor": layers.iridescence, "iridescenceIor": layers.iridescence_ior,
                "iridescenceThicknessMinimum": least, "iridescenceThicknessMaximum": most,
            });
            self.texture(&mut film, "iridescenceTexture", layers.iridescence_texture, LINEAR);
            let thickness = layers.iridescence_thickness_texture;
            self.texture(&mut film, "iridescenceThicknessTexture", thickness, LINEAR);
            self.extension("KHR_materials_iridescence", film);
        }
    }

    fn extension(&mut self, name: &str, object: Value) {
        self.extensions.insert(name.to_owned(), object);
    }

    /// Puts a texture under `key`, if there is one: in that place glTF reads it as `space` has it.
    fn texture(
        &mut self,
        object: &mut Value,
        key: &str,
        texture: Option<TextureRef>,
        space: ColorSpace,
    ) {
        let Some(TextureRef { texture, uv_set, scale, rotation, offset }) = texture else { return };
        let mut info = json!({ "index": self.images.texture(texture, space) });
        if uv_set != 0 {
            info["texCoord"] = uv_set.into();
        }
        let mut transform = Map::new();
        if offset != Vec2::ZERO {
            transform.insert("offset".to_owned(), json!(offset.to_array()));
        }
        if scale != Vec2::ONE {
            transform.insert("scale".to_owned(), json!(scale.to_array()));
        }
        if let Some(angle) = angle(rotation) {
            transform.insert("rotation".to_owned(), angle);
        }
        if !transform.is_empty() {
            info["extensions"] = json!({ "KHR_texture_transform": transform });
        }
        object[key] = info;
    }
}

/// What alpha does.
fn write_alpha(object: &mut Value, material: &Material) {
    match material.alpha_mode {
        AlphaMode::Opaque => {}
        AlphaMode::Mask(cutoff) => {
            object["alphaMode"] = "MASK".into();
            object["alphaCutoff"] = json!(cutoff);
        }
        AlphaMode::Blend => object["alphaMode"] = "BLEND".into(),
    }
}

/// Places of colours, and of all else.
const SRGB: ColorSpace = ColorSpace::Srgb;
const LINEAR: ColorSpace = ColorSpace::Linear;

/// The angle of a cosine and a sine, if it is not zero.
fn angle(turn: Vec2) -> Option<Value> {
    (turn != Vec2::X).then(|| json!(libm::atan2f(turn.y, turn.x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec4;
    use crate::scene::{Scene, Volume};

    fn json_of(material: &Material) -> (Value, Vec<String>) {
        let (scene, mut left_out) = (Scene::default(), Vec::new());
        (write_material(material, &mut Images::new(&scene), &mut left_out), left_out)
    }

    #[test]
    fn the_default_material_needs_no_extension() {
        let (object, left_out) = json_of(&Material::default());
        assert!(object.get("extensions").is_none() && left_out.is_empty(), "{object}");
    }

    #[test]
    fn what_is_not_as_it_would_be_without_is_written() {
        let material = Material {
            name: "glass".to_owned(),
            base_color: Vec4::new(0.1, 0.2, 0.3, 0.4),
            emissive: Vec3::new(6.0, 3.0, 0.0),
            alpha_mode: AlphaMode::Mask(0.25),
            ior: 1.33,
            transmission: 0.75,
            volume: Some(Volume { attenuation_color: Vec3::X, attenuation_distance: 2.0 }),
            priority: 3,
            ..Material::default()
        };
        let (object, _) = json_of(&material);
        assert_eq!(object["name"], "glass");
        assert_eq!((&object["alphaMode"], &object["alphaCutoff"]), (&json!("MASK"), &json!(0.25)));
        assert_eq!(object["emissiveFactor"], json!([0.75, 0.375, 0.0]));
        let extensions = &object["extensions"];
        assert_eq!(extensions["KHR_materials_emissive_strength"]["emissiveStrength"], 8.0);
        assert_eq!(extensions["KHR_materials_volume"]["attenuationDistance"], 2.0);
        assert_eq!(extensions["KHR_materials_transmission"]["transmissionFactor"], 0.75);
        assert_eq!(object["extras"]["dapple_priority"], 3);
    }
}
