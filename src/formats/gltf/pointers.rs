//! Animations of anything in the document (KHR_animation_pointer).
//!
//! What a channel points to is changed in the JSON before the document is read for good: whatever
//! the reader knows, an animation can change, and all its checks hold for what comes out.

use std::path::Path;

use serde_json::{Map, Value};

use super::accessor::Accessor;
use super::animation::{Animation, Pointed};
use super::document::Document;
use super::json::{Fault, Object};
use super::notices::Notices;
use super::read::Storage;
use super::resources;
use crate::formats::{LoadError, LoadOptions, find_by_name_or_number};

/// The lists and objects that may be animated.
const ROOTS: [&str; 5] = ["cameras", "extensions", "materials", "meshes", "nodes"];

/// The most steps of a pointer: the longest that mean something have nine.
const MOST_STEPS: usize = 16;

/// The document as the chosen animation's pointers have it at the time that `options` ask for;
/// `binary` is the container's second chunk. Where there is no such animation, or the document is
/// wrong, it is left as it is, for the reader to say so.
///
/// # Errors
/// Buffers that are missing, curves that are wrong, pointers that lead nowhere.
pub fn pose(
    mut value: Value,
    binary: Option<&[u8]>,
    path: &Path,
    options: &LoadOptions,
) -> Result<Value, LoadError> {
    let Some(time) = options.time.filter(|_| may_point(&value)) else { return Ok(value) };
    let read = Document::read(&value, None, &mut Notices::default());
    let Ok(document) = read else { return Ok(value) };
    let names = document.animations.iter().map(|animation| animation.name.as_str());
    let wanted = options.animation.as_deref();
    let number = wanted.map_or(Some(0), |wanted| find_by_name_or_number(names, wanted));
    let Some(animation) = number.and_then(|number| document.animations.get(number)) else {
        return Ok(value);
    };
    let in_file = |fault: Fault| LoadError::invalid(path, fault.place, fault.message);
    let storage = storage(&document, animation, binary, path)?;
    for Pointed { place, pointer, numbers } in
        animation.pointed(f64::from(time), &storage).map_err(in_file)?
    {
        set(&mut value, pointer, &numbers).map_err(|message| {
            in_file(Fault::new(place, format!("animates {pointer:?}, which {message}")))
        })?;
    }
    Ok(value)
}

/// Whether the document says that it has such animations.
fn may_point(value: &Value) -> bool {
    let root = Object::new(value, String::new());
    let used = root.and_then(|root| root.array("extensionsUsed")).unwrap_or_default();
    used.iter().any(|name| name == "KHR_animation_pointer")
}

/// What an animation's curves are made of, in memory.
fn storage<'a>(
    document: &Document,
    animation: &Animation,
    binary: Option<&'a [u8]>,
    path: &Path,
) -> Result<Storage<'a>, LoadError> {
    let accessors = animation.accessors().map(|index| &document.accessors[index]);
    let mut views: Vec<usize> = accessors.flat_map(Accessor::views).collect();
    views.sort_unstable();
    views.dedup();
    let mut needed = vec![false; document.buffers.len()];
    for &view in &views {
        needed[document.views[view].source()] = true;
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut broken = Vec::new();
    let buffers = resources::load_buffers(&document.buffers, &needed, binary, folder, &mut broken);
    if !broken.is_empty() {
        return Err(LoadError::References { file: path.display().to_string(), broken });
    }
    let mut storage = Storage::new(buffers, document.views.clone(), document.accessors.clone());
    storage.unpack(&views).map_err(|fault| LoadError::invalid(path, fault.place, fault.message))?;
    Ok(storage)
}

/// Sets what a pointer leads to. Objects on the way that are not there are made: all that is left
/// out has a value.
fn set(root: &mut Value, pointer: &str, numbers: &[f64]) -> Result<(), &'static str> {
    const NOWHERE: &str = "leads nowhere";
    let steps: Vec<String> =
        pointer.split('/').skip(1).map(|step| step.replace("~1", "/").replace("~0", "~")).collect();
    let Some((last, way)) = steps.split_last() else { return Err(NOWHERE) };
    if steps.len() > MOST_STEPS || !ROOTS.contains(&steps[0].as_str()) {
        return Err("is nothing that is animated");
    }
    let mut at = root;
    for step in way {
        at = match at {
            Value::Array(list) => {
                step.parse().ok().and_then(|i: usize| list.get_mut(i)).ok_or(NOWHERE)?
            }
            Value::Object(members) => {
                members.entry(step.as_str()).or_insert_with(|| Value::Object(Map::new()))
            }
            _ => return Err(NOWHERE),
        };
    }
    let all: Value = numbers.to_vec().into();
    let first = all.get(0).cloned().filter(Value::is_number).ok_or("has no finite value")?;
    match at {
        Value::Array(list) => {
            let element = last.parse().ok().and_then(|i: usize| list.get_mut(i)).ok_or(NOWHERE)?;
            if !element.is_number() {
                return Err("is no number");
            }
            *element = first;
        }
        Value::Object(members) => {
            let made = match members.get(last) {
                Some(Value::Bool(_)) => Value::Bool(numbers[0] != 0.0),
                None if last == "visible" => Value::Bool(numbers[0] != 0.0),
                Some(Value::Number(_)) if numbers.len() == 1 => first,
                None if numbers.len() == 1 && last != "weights" => first,
                Some(Value::Array(_)) | None => all,
                _ => return Err("is nothing that is animated"),
            };
            members.insert(last.clone(), made);
        }
        _ => return Err(NOWHERE),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn what_is_pointed_at_is_set_or_made() {
        let mut root = json!({"nodes": [{"extensions": {"KHR_node_visibility": {"visible": true}}}],
            "materials": [{"emissiveFactor": [0, 0, 0]}]});
        let visible = "/nodes/0/extensions/KHR_node_visibility/visible";
        assert_eq!(set(&mut root, visible, &[0.0]), Ok(()));
        assert_eq!(set(&mut root, "/materials/0/emissiveFactor", &[1.0, 0.5, 0.25]), Ok(()));
        assert_eq!(set(&mut root, "/materials/0/alphaCutoff", &[0.25]), Ok(()));
        assert_eq!(set(&mut root, "/nodes/0/weights", &[0.75]), Ok(()));
        assert_eq!(set(&mut root, "/nodes/0/weights/0", &[1.0]), Ok(()));
        let offset = "/materials/0/normalTexture/extensions/KHR_texture_transform/offset";
        assert_eq!(set(&mut root, offset, &[0.5, 0.5]), Ok(()));
        assert_eq!(root.pointer(visible), Some(&json!(false)));
        assert_eq!(root.pointer("/materials/0/emissiveFactor"), Some(&json!([1.0, 0.5, 0.25])));
        assert_eq!(root.pointer("/materials/0/alphaCutoff"), Some(&json!(0.25)));
        assert_eq!(root.pointer("/nodes/0/weights"), Some(&json!([1.0])));
        assert_eq!(root.pointer(offset), Some(&json!([0.5, 0.5])));
    }

    #[test]
    fn what_is_no_property_is_refused() {
        let mut root = json!({"nodes": [{"name": "a", "children": [{}]}], "buffers": [{}]});
        let long = format!("/nodes/0{}", "/a".repeat(1000));
        for pointer in ["", "/", "/buffers/0/byteLength", "/nodes/1/scale", "/nodes/0/name", &long]
        {
            assert!(set(&mut root, pointer, &[1.0]).is_err(), "{pointer}");
        }
        assert!(set(&mut root, "/nodes/0/extensions/a", &[]).is_err());
        assert!(set(&mut root, "/nodes/0/scale", &[f64::NAN]).is_err());
    }
}
