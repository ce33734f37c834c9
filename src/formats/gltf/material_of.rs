//! What tests of extensions read: a material that has them.

use super::json::{self, Fault, Object};
use super::material::read;
use super::notices::Notices;
use super::texture::Slots;
use crate::scene::Material;

/// A material of these extensions, in a file of four textures, and what is said of it.
pub fn material(extensions: &str) -> Result<(Material, Vec<String>), Fault> {
    let text = format!("{{\"materials\": [{{\"extensions\": {extensions}}}]}}");
    let value = json::parse(text.as_bytes()).expect("valid JSON");
    let root = Object::new(&value, String::new()).expect("an object");
    let (mut slots, mut notices) = (Slots::new(4), Notices::default());
    let material = read(&root, &mut slots, &mut notices)?.remove(0);
    let notices = notices.finish(std::path::Path::new("a"));
    Ok((material, notices.into_iter().map(|notice| notice.message).collect()))
}
