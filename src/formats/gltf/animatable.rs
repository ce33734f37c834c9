//! What of a document may be animated: the properties that the object model of glTF 2.0 calls
//! mutable, and those of the extensions that are read.

/// What a property holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// So many numbers; one is no list.
    Numbers(usize),
    /// A rotation: four numbers.
    Turn,
    /// True or false.
    Switch,
    /// The weights of all morph targets.
    Weights,
    /// The weight of one.
    Weight,
}

impl Kind {
    /// How many numbers it takes; none: any.
    pub fn numbers(self) -> Option<usize> {
        match self {
            Self::Numbers(count) => Some(count),
            Self::Turn => Some(4),
            Self::Switch | Self::Weight => Some(1),
            Self::Weights => None,
        }
    }
}

use Kind::{Numbers, Switch, Turn, Weight, Weights};

/// Numbers of a material that are no property of its textures, below `/materials/*`.
const OF_MATERIALS: [(&str, Kind); 36] = [
    ("alphaCutoff", Numbers(1)),
    ("emissiveFactor", Numbers(3)),
    ("normalTexture/scale", Numbers(1)),
    ("occlusionTexture/strength", Numbers(1)),
    ("pbrMetallicRoughness/baseColorFactor", Numbers(4)),
    ("pbrMetallicRoughness/metallicFactor", Numbers(1)),
    ("pbrMetallicRoughness/roughnessFactor", Numbers(1)),
    ("extensions/KHR_materials_anisotropy/anisotropyRotation", Numbers(1)),
    ("extensions/KHR_materials_anisotropy/anisotropyStrength", Numbers(1)),
    ("extensions/KHR_materials_clearcoat/clearcoatFactor", Numbers(1)),
    ("extensions/KHR_materials_clearcoat/clearcoatNormalTexture/scale", Numbers(1)),
    ("extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", Numbers(1)),
    ("extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorFactor", Numbers(3)),
    ("extensions/KHR_materials_diffuse_transmission/diffuseTransmissionFactor", Numbers(1)),
    ("extensions/KHR_materials_dispersion/dispersion", Numbers(1)),
    ("extensions/KHR_materials_emissive_strength/emissiveStrength", Numbers(1)),
    ("extensions/KHR_materials_ior/ior", Numbers(1)),
    ("extensions/KHR_materials_iridescence/iridescenceFactor", Numbers(1)),
    ("extensions/KHR_materials_iridescence/iridescenceIor", Numbers(1)),
    ("extensions/KHR_materials_iridescence/iridescenceThicknessMaximum", Numbers(1)),
    ("extensions/KHR_materials_iridescence/iridescenceThicknessMinimum", Numbers(1)),
    ("extensions/KHR_materials_pbrSpecularGlossiness/diffuseFactor", Numbers(4)),
    ("extensions/KHR_materials_pbrSpecularGlossiness/glossinessFactor", Numbers(1)),
    ("extensions/KHR_materials_pbrSpecularGlossiness/specularFactor", Numbers(3)),
    ("extensions/KHR_materials_sheen/sheenColorFactor", Numbers(3)),
    ("extensions/KHR_materials_sheen/sheenRoughnessFactor", Numbers(1)),
    ("extensions/KHR_materials_specular/specularColorFactor", Numbers(3)),
    ("extensions/KHR_materials_specular/specularFactor", Numbers(1)),
    ("extensions/KHR_materials_transmission/transmissionFactor", Numbers(1)),
    ("extensions/KHR_materials_volume/attenuationColor", Numbers(3)),
    ("extensions/KHR_materials_volume/attenuationDistance", Numbers(1)),
    ("extensions/KHR_materials_volume/thicknessFactor", Numbers(1)),
    ("extensions/KHR_materials_volume_scatter/multiscatterColor", Numbers(3)),
    ("extensions/KHR_materials_volume_scatter/multiscatterColorFactor", Numbers(3)),
    ("extensions/KHR_materials_volume_scatter/scatterAlbedo", Numbers(3)),
    ("extensions/KHR_materials_volume_scatter/scatterAnisotropy", Numbers(1)),
];

/// All others.
const OTHERS: [(&str, Kind); 23] = [
    ("/cameras/*/orthographic/xmag", Numbers(1)),
    ("/cameras/*/orthographic/ymag", Numbers(1)),
    ("/cameras/*/orthographic/zfar", Numbers(1)),
    ("/cameras/*/orthographic/znear", Numbers(1)),
    ("/cameras/*/perspective/aspectRatio", Numbers(1)),
    ("/cameras/*/perspective/yfov", Numbers(1)),
    ("/cameras/*/perspective/zfar", Numbers(1)),
    ("/cameras/*/perspective/znear", Numbers(1)),
    ("/extensions/EXT_lights_image_based/lights/*/intensity", Numbers(1)),
    ("/extensions/EXT_lights_image_based/lights/*/rotation", Turn),
    ("/extensions/KHR_lights_punctual/lights/*/color", Numbers(3)),
    ("/extensions/KHR_lights_punctual/lights/*/intensity", Numbers(1)),
    ("/extensions/KHR_lights_punctual/lights/*/range", Numbers(1)),
    ("/extensions/KHR_lights_punctual/lights/*/spot/innerConeAngle", Numbers(1)),
    ("/extensions/KHR_lights_punctual/lights/*/spot/outerConeAngle", Numbers(1)),
    ("/meshes/*/weights", Weights),
    ("/meshes/*/weights/*", Weight),
    ("/nodes/*/extensions/KHR_node_visibility/visible", Switch),
    ("/nodes/*/rotation", Turn),
    ("/nodes/*/scale", Numbers(3)),
    ("/nodes/*/translation", Numbers(3)),
    ("/nodes/*/weights", Weights),
    ("/nodes/*/weights/*", Weight),
];

/// The textures of a material.
const TEXTURES: [&str; 22] = [
    "emissiveTexture",
    "normalTexture",
    "occlusionTexture",
    "pbrMetallicRoughness/baseColorTexture",
    "pbrMetallicRoughness/metallicRoughnessTexture",
    "extensions/KHR_materials_anisotropy/anisotropyTexture",
    "extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
    "extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture",
    "extensions/KHR_materials_clearcoat/clearcoatTexture",
    "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionColorTexture",
    "extensions/KHR_materials_diffuse_transmission/diffuseTransmissionTexture",
    "extensions/KHR_materials_iridescence/iridescenceTexture",
    "extensions/KHR_materials_iridescence/iridescenceThicknessTexture",
    "extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
    "extensions/KHR_materials_pbrSpecularGlossiness/specularGlossinessTexture",
    "extensions/KHR_materials_sheen/sheenColorTexture",
    "extensions/KHR_materials_sheen/sheenRoughnessTexture",
    "extensions/KHR_materials_specular/specularColorTexture",
    "extensions/KHR_materials_specular/specularTexture",
    "extensions/KHR_materials_transmission/transmissionTexture",
    "extensions/KHR_materials_volume/thicknessTexture",
    "extensions/KHR_materials_volume_scatter/multiscatterColorTexture",
];

/// Of each of them, below `extensions/KHR_texture_transform`.
const OF_TEXTURES: [(&str, Kind); 3] =
    [("offset", Numbers(2)), ("rotation", Numbers(1)), ("scale", Numbers(2))];

/// What a pointer leads to, if that may be animated; whether the document has it is not asked.
pub fn kind(pointer: &str) -> Option<Kind> {
    if let Some(kind) = OTHERS.iter().find(|(form, _)| fits(pointer, form)).map(|it| it.1) {
        return Some(kind);
    }
    let (number, within) = pointer.strip_prefix("/materials/")?.split_once('/')?;
    if !is_number(number) {
        return None;
    }
    if let Some(kind) = OF_MATERIALS.iter().find(|(name, _)| *name == within).map(|it| it.1) {
        return Some(kind);
    }
    let (texture, name) = within.split_once("/extensions/KHR_texture_transform/")?;
    let is_texture = TEXTURES.contains(&texture);
    OF_TEXTURES.iter().find(|(known, _)| is_texture && *known == name).map(|it| it.1)
}

/// Whether a pointer has the steps of a form, in which a star stands for a number.
fn fits(pointer: &str, form: &str) -> bool {
    let (mut steps, mut wanted) = (pointer.split('/'), form.split('/'));
    loop {
        match (steps.next(), wanted.next()) {
            (None, None) => return true,
            (Some(step), Some("*")) if is_number(step) => {}
            (Some(step), Some(wanted)) if step == wanted => {}
            _ => return false,
        }
    }
}

/// Whether a step counts in a list, as RFC 6901 has it.
fn is_number(step: &str) -> bool {
    let digits = !step.is_empty() && step.bytes().all(|digit| digit.is_ascii_digit());
    digits && (step.len() == 1 || !step.starts_with('0'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_be_animated_is_told_from_what_may_not() {
        let sheen = "/materials/3/extensions/KHR_materials_sheen";
        for (pointer, expected) in [
            ("/nodes/12/rotation", Turn),
            ("/nodes/0/weights/7", Weight),
            ("/meshes/0/weights", Weights),
            ("/nodes/0/extensions/KHR_node_visibility/visible", Switch),
            ("/cameras/0/perspective/yfov", Numbers(1)),
            ("/materials/0/pbrMetallicRoughness/baseColorFactor", Numbers(4)),
            (&format!("{sheen}/sheenColorFactor"), Numbers(3)),
            (
                &format!("{sheen}/sheenColorTexture/extensions/KHR_texture_transform/rotation"),
                Numbers(1),
            ),
            ("/materials/0/normalTexture/extensions/KHR_texture_transform/scale", Numbers(2)),
            ("/extensions/EXT_lights_image_based/lights/1/rotation", Turn),
            ("/extensions/KHR_lights_punctual/lights/0/spot/innerConeAngle", Numbers(1)),
        ] {
            assert_eq!(kind(pointer), Some(expected), "{pointer}");
        }
        for pointer in [
            "",
            "/",
            "nodes/0/scale",
            "/nodes/00/scale",
            "/nodes/+1/scale",
            "/nodes//scale",
            "/nodes/0/scale/",
            "/nodes/0/foo",
            "/nodes/0/mesh",
            "/nodes/0/children/0",
            "/nodes/0/matrix",
            "/materials/0/alphaMode",
            "/materials/0/doubleSided",
            "/materials/x/alphaCutoff",
            "/materials/0/pbrMetallicRoughness/baseColourFactor",
            "/materials/0/pbrMetallicRoughness/baseColorTexture/index",
            "/materials/0/emissiveTexture/extensions/KHR_texture_transform/texCoord",
            "/materials/0/ownTexture/extensions/KHR_texture_transform/offset",
            "/materials/0/extensions/KHR_texture_transform/offset",
            "/materials/0/extensions/KHR_materials_unlit/foo",
            "/cameras/0/type",
            "/accessors/0/count",
        ] {
            assert_eq!(kind(pointer), None, "{pointer}");
        }
    }
}
