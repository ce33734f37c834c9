//! glTF's materials.

use serde_json::{Value, json};

/// Of one colour.
pub fn plain(name: &str, [r, g, b]: [f64; 3], metallic: f64, roughness: f64) -> Value {
    json!({
        "name": name,
        "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0],
            "metallicFactor": metallic, "roughnessFactor": roughness,
        },
    })
}

/// Black, and shines with so much radiance in a tint.
pub fn shining(name: &str, tint: [f64; 3], radiance: f64) -> Value {
    let mut material = plain(name, [0.0; 3], 0.0, 1.0);
    material["emissiveFactor"] = json!(tint);
    let strength = json!({ "emissiveStrength": radiance });
    material["extensions"] = json!({ "KHR_materials_emissive_strength": strength });
    material
}
