//! Animations of anything in the document (KHR_animation_pointer).
//!
//! What a channel points to is changed in the JSON before the document is read for good: whatever
//! the reader knows, an animation can change, and all its checks hold for what comes out.

use std::path::Path;

use serde_json::Value;

use super::accessor::Accessor;
use super::animatable::{self, Kind};
use super::animation::{Animation, Pointed, Property};
use super::document::Document;
use super::json::Fault;
use super::notices::Notices;
use super::read::Storage;
use super::resources;
use crate::formats::{LoadError, LoadOptions, find_by_name_or_number};

/// What is said of a pointer that is not followed.
const NOWHERE: &str = "leads to nothing that can be animated";

/// So many weights are made for nodes that have none of their own: a mesh may have many, and many
/// nodes may have it.
const MOST_WEIGHTS: usize = 1 << 20;

/// The document as the chosen animation's pointers have it at the time that `options` ask for;
/// `binary` is the container's second chunk. Where there is no such animation, or the document is
/// wrong, it is left as it is, for the reader to say so. Pointers that lead to nothing that can be
/// animated are not followed, which is among `notices`.
///
/// # Errors
/// Buffers that are missing, curves that are wrong.
pub fn pose(
    mut value: Value,
    binary: Option<&[u8]>,
    path: &Path,
    options: &LoadOptions,
    notices: &mut Notices,
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
    let mut room = MOST_WEIGHTS;
    for Pointed { place, pointer, numbers } in
        animation.pointed(f64::from(time), &storage).map_err(in_file)?
    {
        if let Err(message) = set(&mut value, pointer, &numbers, &mut room) {
            notices.add(place, format!("animates {pointer:?}, which {message}"));
        }
    }
    Ok(value)
}

/// Whether any animation goes by pointers, whatever extensions the document declares.
fn may_point(value: &Value) -> bool {
    let animations = value.get("animations").and_then(Value::as_array);
    let channels = animations.into_iter().flatten().filter_map(|it| it.get("channels")?.as_array());
    channels.flatten().any(|it| it.pointer("/target/extensions/KHR_animation_pointer").is_some())
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

/// Sets what a pointer leads to. Properties that are left out have a value and can be set, but
/// the object that they are of must be there. So many weights may be made that are left out as
/// there is `room` for.
fn set(root: &mut Value, pointer: &str, numbers: &[f64], room: &mut usize) -> Result<(), String> {
    let kind = animatable::kind(pointer).ok_or(NOWHERE)?;
    let (count, given) = (kind.numbers().unwrap_or(numbers.len()), numbers.len());
    if given != count {
        return Err(format!("takes {count} numbers and not {given}"));
    }
    if given == 0 || !numbers.iter().all(|number| number.is_finite()) {
        return Err("is given no finite value".to_owned());
    }
    let (way, last) = pointer.rsplit_once('/').ok_or(NOWHERE)?;
    if kind == Kind::Weight {
        make_weights(root, way, room).ok_or(NOWHERE)?;
    }
    let parent = root.pointer_mut(way).ok_or(NOWHERE)?;
    if Property::of_pointer(pointer).is_some() {
        // The nodes are posed once they are read.
        return if parent.is_object() { Ok(()) } else { Err(NOWHERE.to_owned()) };
    }
    let value = match kind {
        Kind::Switch => Value::Bool(numbers[0] != 0.0),
        Kind::Numbers(1) | Kind::Weight => numbers[0].into(),
        Kind::Numbers(_) | Kind::Turn | Kind::Weights => numbers.to_vec().into(),
    };
    match parent {
        Value::Object(members) => {
            members.insert(last.to_owned(), value);
        }
        Value::Array(list) => {
            *last.parse().ok().and_then(|at: usize| list.get_mut(at)).ok_or(NOWHERE)? = value;
        }
        _ => return Err(NOWHERE.to_owned()),
    }
    Ok(())
}

/// Gives a mesh the weights that it has where the document leaves them out, all 0, or a node those
/// of its mesh; `way` leads to them. None if there is nothing to be weighed, or no `room` for so
/// many weights.
fn make_weights(root: &mut Value, way: &str, room: &mut usize) -> Option<()> {
    let owner = way.strip_suffix("/weights")?;
    let object = root.pointer(owner)?;
    if object.get("weights").is_some() {
        return Some(());
    }
    let mesh = match object.get("mesh") {
        Some(mesh) if owner.starts_with("/nodes/") => {
            root.get("meshes")?.get(usize::try_from(mesh.as_u64()?).ok()?)?
        }
        _ => object,
    };
    let given = mesh.get("weights").and_then(Value::as_array);
    let targets = || mesh.pointer("/primitives/0/targets")?.as_array();
    *room = room.checked_sub(given.or_else(targets)?.len())?;
    let weights = match given {
        Some(weights) => weights.clone().into(),
        None => vec![0.0; targets()?.len()].into(),
    };
    root.pointer_mut(owner)?.as_object_mut()?.insert("weights".to_owned(), weights);
    Some(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn set(root: &mut Value, pointer: &str, numbers: &[f64]) -> Result<(), String> {
        super::set(root, pointer, numbers, &mut 100)
    }

    #[test]
    fn no_more_weights_are_made_than_there_is_room_for() {
        let mesh = json!({"primitives": [{"targets": [{}, {}, {}]}]});
        let mut root = json!({"meshes": [mesh], "nodes": [{"mesh": 0}, {"mesh": 0}, {"mesh": 0}]});
        let mut room = 6;
        let mut set = |node: u32| {
            super::set(&mut root, &format!("/nodes/{node}/weights/1"), &[0.5], &mut room)
        };
        assert_eq!([set(0), set(1), set(0)], [Ok(()), Ok(()), Ok(())]);
        assert_eq!(set(2), Err(NOWHERE.to_owned()));
        assert_eq!(root["nodes"][1]["weights"], json!([0.0, 0.5, 0.0]));
        assert!(root["nodes"][2].get("weights").is_none());
    }

    #[test]
    fn what_is_pointed_at_is_set() {
        let transform = json!({"index": 0, "extensions": {"KHR_texture_transform": {}}});
        let mut root = json!({
            "nodes": [{"extensions": {"KHR_node_visibility": {"visible": true}}}, {"mesh": 0}],
            "meshes": [{"primitives": [{"targets": [{}, {}]}]}],
            "materials": [{"emissiveFactor": [0, 0, 0], "normalTexture": transform}],
        });
        let visible = "/nodes/0/extensions/KHR_node_visibility/visible";
        let offset = "/materials/0/normalTexture/extensions/KHR_texture_transform/offset";
        assert_eq!(set(&mut root, visible, &[0.0]), Ok(()));
        assert_eq!(set(&mut root, "/materials/0/emissiveFactor", &[1.0, 0.5, 0.25]), Ok(()));
        assert_eq!(set(&mut root, "/materials/0/alphaCutoff", &[0.25]), Ok(()));
        assert_eq!(set(&mut root, "/meshes/0/weights/1", &[0.75]), Ok(()));
        assert_eq!(set(&mut root, "/nodes/1/weights/0", &[1.0]), Ok(()));
        assert_eq!(set(&mut root, offset, &[0.5, 0.5]), Ok(()));
        assert_eq!(root.pointer(visible), Some(&json!(false)));
        assert_eq!(root.pointer("/materials/0/emissiveFactor"), Some(&json!([1.0, 0.5, 0.25])));
        assert_eq!(root.pointer("/materials/0/alphaCutoff"), Some(&json!(0.25)));
        assert_eq!(root.pointer("/meshes/0/weights"), Some(&json!([0.0, 0.75])));
        assert_eq!(root.pointer("/nodes/1/weights"), Some(&json!([1.0, 0.75])));
        assert_eq!(root.pointer(offset), Some(&json!([0.5, 0.5])));
    }

    /// What is wrong with a document must not be said of what is not in it.
    #[test]
    fn no_object_is_made() {
        let before = json!({"nodes": [{"name": "a", "children": [1]}, {"mesh": 0}],
            "meshes": [{"primitives": [{}]}], "materials": [{}, {"extensions": {}}],
            "buffers": [{}]});
        let sheen = "extensions/KHR_materials_sheen/sheenRoughnessFactor";
        for pointer in [
            "",
            "/",
            "/buffers/0/byteLength",
            "/nodes/2/scale",
            "/nodes/0/name",
            "/nodes/0/children/0",
            "/nodes/0/extensions/KHR_node_visibility/visible",
            "/nodes/1/weights/0",
            "/meshes/0/weights/0",
            "/materials/0/pbrMetallicRoughness/metallicFactor",
            &format!("/materials/0/{sheen}"),
            &format!("/materials/1/{sheen}"),
            "/extensions/KHR_lights_punctual/lights/0/intensity",
            &format!("/nodes/0{}", "/a".repeat(1000)),
        ] {
            let mut root = before.clone();
            let numbers = if pointer.ends_with("scale") { &[1.0; 3][..] } else { &[1.0] };
            assert_eq!(set(&mut root, pointer, numbers), Err(NOWHERE.to_owned()), "{pointer}");
            assert_eq!(root, before, "{pointer}");
        }
    }

    #[test]
    fn as_many_numbers_are_needed_as_a_property_has() {
        let mut root = json!({"nodes": [{}], "materials": [{}]});
        for (pointer, numbers, said) in [
            ("/nodes/0/scale", &[1.0][..], "takes 3 numbers and not 1"),
            ("/materials/0/emissiveFactor", &[1.0; 4], "takes 3 numbers and not 4"),
            ("/materials/0/alphaCutoff", &[], "takes 1 numbers and not 0"),
            ("/materials/0/alphaCutoff", &[f64::NAN], "is given no finite value"),
            ("/nodes/0/weights", &[], "is given no finite value"),
        ] {
            assert_eq!(set(&mut root, pointer, numbers), Err(said.to_owned()), "{pointer}");
        }
    }
}
