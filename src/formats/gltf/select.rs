//! What the chosen scene shows of a document, so that only that is brought into memory.

use std::path::Path;

use super::animation::Animation;
use super::document::Document;
use super::image_light::ImageLight;
use super::instancing::Instancing;
use super::mesh::Primitive;
use super::nodes::{self, Node, Placed};
use super::notices::Notices;
use super::palette::Palette;
use super::texture::ImageSource;
use crate::formats::{LoadError, LoadOptions, find_by_name_or_number};
use crate::scene::Notice;
use crate::texture::ColorSpace;

/// What the chosen scene shows.
pub(super) struct Selection {
    /// The nodes that it begins with.
    pub roots: Vec<usize>,
    /// Its nodes, at rest.
    pub placed: Vec<Placed>,
    /// The animation that is to pose them.
    pub animation: Option<Animation>,
    /// Its materials.
    pub palette: Palette,
    /// The textures that these need, each in a colour space.
    pub slots: Vec<(usize, ColorSpace)>,
    /// What shines from all around.
    pub light: Option<ImageLight>,
    /// The buffer views that all of that reads, in order.
    pub views: Vec<usize>,
}

/// Finds what the scene that `options` choose shows. The document's materials go to the selection.
///
/// # Errors
/// [`LoadError::NoSuch`] where there is no such scene or animation.
pub(super) fn select(
    document: &mut Document,
    path: &Path,
    options: &LoadOptions,
    notices: &mut Notices,
) -> Result<Selection, LoadError> {
    let Some(roots) = document.scene_roots(options.scene.as_deref()) else {
        let names = document.scenes.iter().map(|scene| scene.name.as_str());
        let wanted = options.scene.as_deref().unwrap_or_default();
        return Err(LoadError::no_such(path, "scene", wanted, names));
    };
    let roots = roots.to_vec();
    let placed = nodes::place(&document.nodes, &roots);
    let animation = choose_animation(document, options, path, notices)?;

    let materials = std::mem::take(&mut document.materials);
    let mut palette = Palette::new(materials, drawn_primitives(document, &placed).into_iter());
    for primitive in document.meshes.iter_mut().flat_map(|mesh| &mut mesh.primitives) {
        if let Some(sets) = palette.kept(primitive) {
            primitive.keep_sets(sets);
        }
    }
    let primitives = drawn_primitives(document, &placed);
    let slots = document.slots.retain(&mut palette.materials);
    let light = document.image_light(options.scene.as_deref());
    let views = views_in_use(document, &placed, &primitives, animation.as_ref(), &slots, light);
    let light = light.cloned();
    Ok(Selection { roots, placed, animation, palette, slots, light, views })
}

/// The primitives of all meshes that nodes place and that are seen, each once, in the document's
/// order.
fn drawn_primitives<'d>(document: &'d Document, placed: &[Placed]) -> Vec<&'d Primitive> {
    let seen = placed.iter().filter(|at| at.visible);
    let mut drawn: Vec<usize> = seen.filter_map(|at| document.nodes[at.node].mesh).collect();
    drawn.sort_unstable();
    drawn.dedup();
    drawn.iter().flat_map(|&mesh| &document.meshes[mesh].primitives).collect()
}

/// The buffer views of images and a light, of primitives, of copies and skins, and of the
/// animation.
fn views_in_use(
    document: &Document,
    placed: &[Placed],
    primitives: &[&Primitive],
    animation: Option<&Animation>,
    slots: &[(usize, ColorSpace)],
    light: Option<&ImageLight>,
) -> Vec<usize> {
    let images = slots.iter().filter_map(|&(texture, _)| document.textures[texture].images.first());
    let images = images.copied();
    let images = images.chain(light.iter().flat_map(|light| light.faces));
    let of_images = images.filter_map(|image| match document.images[image].source {
        ImageSource::View(view) => Some(view),
        ImageSource::Uri(_) => None,
    });
    let of_primitives = primitives.iter().flat_map(|primitive| primitive.accessors());
    let of_nodes = placed.iter().flat_map(|at| {
        let Node { copies, skin, .. } = &document.nodes[at.node];
        let matrices = skin.and_then(|skin| document.skins[skin].accessor());
        copies.iter().flat_map(Instancing::accessors).chain(matrices)
    });
    let accessors =
        of_primitives.chain(of_nodes).chain(animation.into_iter().flat_map(Animation::accessors));
    let of_accessors = accessors.flat_map(|index| document.accessors[index].views());
    let mut views: Vec<usize> = of_images.chain(of_accessors).collect();
    views.sort_unstable();
    views.dedup();
    views
}

/// The animation to pose, and what there is to say of those that are not.
fn choose_animation(
    document: &Document,
    options: &LoadOptions,
    path: &Path,
    notices: &mut Notices,
) -> Result<Option<Animation>, LoadError> {
    let names = || document.animations.iter().map(|animation| animation.name.as_str());
    let count = document.animations.len();
    let wanted = match options.animation.as_deref() {
        None => 0,
        Some(wanted) => find_by_name_or_number(names(), wanted)
            .ok_or_else(|| LoadError::no_such(path, "animation", wanted, names()))?,
    };
    match (options.time, count) {
        (None, 0) | (Some(_), 1) => {}
        (None, _) => {
            notices.add("/animations", Notice::REST_POSE);
        }
        (Some(_), 0) => notices.add("", "there is no animation: --time changes nothing"),
        (Some(_), _) if options.animation.is_none() => {
            let message = format!("the first of {count} animations is posed (--animation)");
            notices.add("/animations", message);
        }
        (Some(_), _) => {}
    }
    Ok(options.time.and(document.animations.get(wanted).cloned()))
}
