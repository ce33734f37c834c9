//! Extensions: which are honoured, which are required, and which are left out and said so.

use std::collections::BTreeSet;

use serde_json::Value;

use super::json::{Fault, Object, mismatch, pointer};
use super::notices::Notices;
use crate::scene::UsedExtension;

/// What this loader does all of.
const HONOURED: [&str; 27] = [
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// What changes nothing in a picture.
const INVISIBLE: [&str; 2] = ["KHR_xmp", "KHR_xmp_json_ld"];

fn is_supported(name: &str) -> bool {
    HONOURED.contains(&name) || INVISIBLE.contains(&name)
}

/// What leaving an extension out means for the picture.
fn consequence(name: &str) -> &'static str {
    match name {
        "EXT_texture_avif" => "the texture's other image is used",
        _ => "it is left out",
    }
}

/// The extensions that the file requires and that are not supported.
pub fn find_unsupported(root: &Object) -> Result<Vec<String>, Fault> {
    let mut names = strings(root, "extensionsRequired")?;
    names.retain(|name| !is_supported(name));
    names.dedup();
    Ok(names)
}

/// Notes every extension that is used and not honoured, and those used but not declared. All that
/// are used or declared, by their names.
pub fn note(
    document: &Value,
    root: &Object,
    notices: &mut Notices,
) -> Result<Vec<UsedExtension>, Fault> {
    let declared = strings(root, "extensionsUsed")?;
    let mut met = BTreeSet::new();
    each_extension(document, "", &mut |place, name| {
        met.insert(name.to_owned());
        if !is_supported(name) {
            let consequence = consequence(name);
            notices.add(place, format!("extension {name} is not supported: {consequence}"));
        } else if !declared.iter().any(|declared| declared == name) {
            notices.add(place, format!("extension {name} is used without being declared"));
        }
    })?;
    for (i, name) in declared.iter().enumerate() {
        if !is_supported(name) && !met.contains(name) {
            let message = format!("extension {name} is not supported");
            notices.add(format!("/extensionsUsed/{i}"), message);
        }
    }
    met.extend(declared);
    let used = met.into_iter().map(|name| UsedExtension { honoured: is_supported(&name), name });
    Ok(used.collect())
}

fn strings(root: &Object, key: &str) -> Result<Vec<String>, Fault> {
    let elements = root.array(key)?.iter().enumerate();
    let text = |(i, value): (usize, &Value)| match value {
        Value::String(text) => Ok(text.clone()),
        _ => Err(Fault::new(format!("{}/{i}", root.at(key)), "must be a string")),
    };
    elements.map(text).collect()
}

/// Calls `note` with the pointer to and the name of every extension object in the document. The
/// parser has limited the depth, so that recursion is safe.
fn each_extension(
    value: &Value,
    place: &str,
    note: &mut dyn FnMut(String, &str),
) -> Result<(), Fault> {
    match value {
        Value::Array(elements) => {
            for (i, element) in elements.iter().enumerate() {
                if element.is_object() || element.is_array() {
                    each_extension(element, &format!("{place}/{i}"), note)?;
                }
            }
        }
        Value::Object(members) => {
            for (key, member) in members {
                match (key.as_str(), member) {
                    ("extras", _) => {}
                    ("extensions", Value::Object(extensions)) => {
                        for (name, extension) in extensions {
                            let place = pointer(&format!("{place}/extensions"), name);
                            if !extension.is_object() {
                                return Err(mismatch(place, "an object", extension));
                            }
                            note(place.clone(), name);
                            each_extension(extension, &place, note)?;
                        }
                    }
                    ("extensions", other) => {
                        return Err(mismatch(pointer(place, key), "an object", other));
                    }
                    (_, Value::Object(_) | Value::Array(_)) => {
                        each_extension(member, &pointer(place, key), note)?;
                    }
                    _ => {}
                }
            }
        }
        _ => {}
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::json;
    use super::*;

    fn notices(text: &str) -> Vec<String> {
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        let mut notices = Notices::default();
        note(&value, &root, &mut notices).expect("valid");
        let all = notices.finish(Path::new("a"));
        all.into_iter().map(|notice| format!("{}: {}", notice.place, notice.message)).collect()
    }

    #[test]
    fn what_is_left_out_is_said_with_its_place() {
        let text = r#"{"extensionsUsed": ["KHR_materials_ior", "EXT_texture_avif", "X_y"],
            "textures": [{"extensions": {"EXT_texture_avif": {}, "KHR_materials_ior": {}}},
                         {"extensions": {"EXT_texture_avif": {}}}],
            "extras": {"extensions": {"none": {}}}}"#;
        assert_eq!(
            notices(text),
            [
                "a: /textures/0/extensions/EXT_texture_avif: extension EXT_texture_avif is not \
                 supported: the texture's other image is used (and at one other place)",
                "a: /extensionsUsed/2: extension X_y is not supported",
            ]
        );
    }

    #[test]
    fn an_undeclared_extension_is_told() {
        let text = r#"{"nodes": [{"extensions": {"KHR_lights_punctual": {"light": 0}}}]}"#;
        assert_eq!(
            notices(text),
            ["a: /nodes/0/extensions/KHR_lights_punctual: extension KHR_lights_punctual is used \
              without being declared"]
        );
    }

    #[test]
    fn only_what_is_not_supported_is_refused() {
        let value = json::parse(br#"{"extensionsRequired": ["KHR_texture_transform", "X_y"]}"#)
            .expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        assert_eq!(find_unsupported(&root), Ok(vec!["X_y".to_owned()]));
    }
}
