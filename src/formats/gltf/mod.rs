//! glTF 2.0, as .gltf with files or data URIs and as .glb.
//!
//! A file is read in three steps. The document is parsed and checked as a whole (`document`):
//! every index leads somewhere, every range of bytes lies within its buffer, nodes form trees.
//! Then what the chosen scene shows is brought into memory, and all that is missing is reported at
//! once (`resources`). Last, meshes are built and placed (`assemble`). The JSON is kept as it
//! is and not pressed into types, so that every complaint comes with a pointer to its place.
//!
//! What the file asks for and does not get becomes a notice of the scene.

mod accessor;
mod animatable;
mod animation;
mod assemble;
mod build;
mod camera;
mod compressed;
mod curve;
mod deform;
mod document;
mod draco;
mod element;
mod extensions;
mod glb;
mod image_light;
mod instancing;
mod json;
mod layers;
mod light;
mod material;
#[cfg(test)]
mod material_of;
mod mesh;
mod meshopt;
mod motion;
mod nodes;
mod notices;
mod palette;
mod planes;
mod pointers;
mod primitive;
mod read;
mod resources;
mod rows;
mod select;
mod shape;
mod skin;
mod specular_glossiness;
mod texture;
mod translucency;
mod variants;

use std::path::Path;

use self::document::{Document, Refusal};
use self::draco::{Declared, Unpacked};
use self::json::Fault;
use self::notices::Notices;
use super::{LoadError, LoadOptions, read_file};
use crate::scene::Scene;

/// Loads a file.
///
/// # Errors
/// As [`parse`], or if it cannot be read.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    parse(path, &read_file(path)?, options)
}

/// Whether a file looks like glTF: a container, or a JSON object.
pub fn is_gltf(bytes: &[u8]) -> bool {
    glb::is_glb(bytes) || bytes.trim_ascii_start().starts_with(b"{")
}

/// Reads a file's contents; `path` is for messages and for the folder of the files beside it.
///
/// # Errors
/// [`LoadError`], with a JSON pointer to the place.
pub fn parse(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Scene, LoadError> {
    let in_file = |fault: Fault| LoadError::invalid(path, fault.place, fault.message);
    let mut notices = Notices::default();
    let (json, binary) = if glb::is_glb(bytes) {
        let glb = glb::split(bytes).map_err(in_file)?;
        if glb.trailing > 0 {
            notices.add("", "goes on after the end that its header declares");
        }
        (glb.json, glb.binary)
    } else {
        (bytes, None)
    };
    let value = json::parse(json).map_err(in_file)?;
    let value = pointers::pose(value, binary, path, options, &mut notices)?;
    let wanted = options.variant.as_deref();
    let document =
        Document::read(&value, wanted, &mut notices).map_err(|refusal| match refusal {
            Refusal::Fault(fault) => in_file(fault),
            Refusal::Extensions(extensions) => {
                LoadError::Extensions { file: path.display().to_string(), extensions }
            }
            Refusal::Variant(names) => {
                let names = names.iter().map(String::as_str);
                LoadError::no_such(path, "variant", wanted.unwrap_or_default(), names)
            }
        })?;
    drop(value);
    let contents = document.contents();
    let mut scene = assemble::assemble(document, binary, path, options, &mut notices)?;
    scene.notices = notices.finish(path);
    scene.contents = contents;
    Ok(scene)
}

/// Unpacks a mesh packed by Draco, and reads each of its parts: for tests of hostile files.
///
/// # Errors
/// What is wrong with it.
pub fn check_draco(bytes: &[u8]) -> Result<(), LoadError> {
    let declared = Declared { triangles: 1 << 16, vertices: 1 << 16, vertex_bytes: 64 };
    let checked = Unpacked::decode(bytes, declared).and_then(|mesh| {
        mesh.corners()?;
        mesh.attributes().try_for_each(|id| mesh.attribute(id).map(drop))
    });
    checked.map_err(|message| LoadError::invalid(Path::new("fuzz.draco"), "", message))
}
