//! Materials of glTF.

use serde_json::{Value, json};

pub type Rgb = [f64; 3];

/// A Lambertian surface.
pub fn matte(color: Rgb) -> Value {
    let [r, g, b] = color;
    json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0,
        },
        "extensions": { "KHR_materials_specular": { "specularFactor": 0.0 } },
    })
}

/// A surface under a coat of index 1.5.
pub fn plastic(color: Rgb, roughness: f64) -> Value {
    let [r, g, b] = color;
    json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness,
    } })
}

/// Metal of a reflectance at normal incidence.
pub fn metal(color: Rgb, roughness: f64) -> Value {
    let [r, g, b] = color;
    json!({ "pbrMetallicRoughness": {
        "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 1.0, "roughnessFactor": roughness,
    } })
}

/// Radiates `radiance` and reflects nothing.
pub fn emitter(radiance: Rgb) -> Value {
    let strength = radiance.into_iter().fold(0.0, f64::max);
    let mut material = matte([0.0; 3]);
    material["emissiveFactor"] = json!(radiance.map(|value| value / strength));
    material["extensions"]["KHR_materials_emissive_strength"] =
        json!({ "emissiveStrength": strength });
    material
}

/// Glass of index 1.5 without an inside: light goes straight through.
pub fn thin_glass(color: Rgb, roughness: f64) -> Value {
    let mut material = plastic(color, roughness);
    material["extensions"] = json!({
        "KHR_materials_ior": { "ior": 1.5 },
        "KHR_materials_transmission": { "transmissionFactor": 1.0 },
    });
    material
}

/// A solid of glass, of whose white light `color` is left after `distance` metres.
pub fn solid_glass(color: Rgb, distance: f64, roughness: f64) -> Value {
    let mut material = thin_glass([1.0; 3], roughness);
    material["extensions"]["KHR_materials_volume"] = json!({
        "thicknessFactor": 1.0, "attenuationColor": color, "attenuationDistance": distance,
    });
    material
}

/// Any material under lacquer.
pub fn lacquered(mut below: Value, strength: f64, roughness: f64) -> Value {
    below["extensions"]["KHR_materials_clearcoat"] =
        json!({ "clearcoatFactor": strength, "clearcoatRoughnessFactor": roughness });
    below
}

/// Any material with fibres that stand off it.
pub fn cloth(mut below: Value, color: Rgb, roughness: f64) -> Value {
    below["extensions"]["KHR_materials_sheen"] =
        json!({ "sheenColorFactor": color, "sheenRoughnessFactor": roughness });
    below
}

/// Any material, its reflection stretched at an angle to the tangent.
pub fn brushed(mut below: Value, strength: f64, angle: f64) -> Value {
    below["extensions"]["KHR_materials_anisotropy"] =
        json!({ "anisotropyStrength": strength, "anisotropyRotation": angle });
    below
}

/// Any material under a film of some index, its least and greatest thickness in nanometres.
pub fn filmed(mut below: Value, ior: f64, [least, greatest]: [f64; 2]) -> Value {
    below["extensions"]["KHR_materials_iridescence"] = json!({
        "iridescenceFactor": 1.0, "iridescenceIor": ior,
        "iridescenceThicknessMinimum": least, "iridescenceThicknessMaximum": greatest,
    });
    below
}
